// SPDX-License-Identifier: BSD-3-Clause
// Error of pose files in the camera's rotation from frame to frame, measured in the images.
//   bench_rotation_error RAWLOG POSES_KITTI.txt...
// Distant corners are tracked from each left image to the next by optical flow, with depth from the
// right image. The rotation fitted to their residuals against the poses' predictions is the poses'
// error, up to the noise of optical flow. Prints a row for each file: RMS over all pairs of frames,
// about the camera's axes x (pitch), y (yaw) and z (roll), and the mean difference of its motion to
// that of the first file, to the right, down and forward, relative to the path over kSpan frames.
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <stdexcept>

namespace {

using namespace headway;

constexpr int kCorners = 1500;
constexpr double kMinDepth_m = 25.0;    // nearer ones mainly depend on translation
constexpr double kMaxDepth_m = 150.0;  // farther ones have no depth
constexpr double kMaxRoundTrip_px = 0.3;   // difference of forward and backward flow
constexpr double kRowError = 1.0;    // [px] between left and right
constexpr std::size_t kMinCorners = 40;
constexpr std::size_t kSpan = 5;  // frames

struct Corner {
  Eigen::Vector3d place;  ///< left camera of the first frame [m]
  Eigen::Vector2d seen;   ///< in the second frame [px]
};

/// Points tracked forward and backward; nullopt where the two disagree.
std::vector<std::optional<cv::Point2f>> followed(const cv::Mat& from, const cv::Mat& to,
                                                 const std::vector<cv::Point2f>& points) {
  std::vector<cv::Point2f> there, back;
  std::vector<uchar> forth_ok, back_ok;
  cv::Mat error;
  const cv::Size window(15, 15);
  const cv::TermCriteria fine(cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.003);
  cv::calcOpticalFlowPyrLK(from, to, points, there, forth_ok, error, window, 4, fine);
  cv::calcOpticalFlowPyrLK(to, from, there, back, back_ok, error, window, 4, fine);
  std::vector<std::optional<cv::Point2f>> result(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const bool returned =
        forth_ok[i] != 0 && back_ok[i] != 0 && cv::norm(back[i] - points[i]) < kMaxRoundTrip_px;
    if (returned) result[i] = there[i];
  }
  return result;
}

std::vector<Corner> farCorners(const StereoFrame& now, const StereoFrame& next) {
  std::vector<cv::Point2f> points;
  cv::goodFeaturesToTrack(now.left, points, kCorners, 0.005, 8.0);
  if (points.empty()) return {};
  const auto right = followed(now.left, now.right, points);
  const auto later = followed(now.left, next.left, points);
  const StereoCamera& camera = *now.camera;
  std::vector<Corner> corners;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!right[i] || !later[i] || std::abs(right[i]->y - points[i].y) > kRowError) continue;
    const double disparity = points[i].x - right[i]->x;
    const double depth = disparity > 0.0 ? camera.fx * camera.baseline_m / disparity : 1e9;
    if (depth < kMinDepth_m || depth > kMaxDepth_m) continue;
    const Eigen::Vector3d ray((points[i].x - camera.cx) / camera.fx,
                              (points[i].y - camera.cy) / camera.fy, 1.0);
    corners.push_back({depth * ray, {later[i]->x, later[i]->y}});
  }
  return corners;
}

/// The small rotation by which a motion is off, fitted with Cauchy weights; radians.
std::optional<Eigen::Vector3d> rotationLeft(const std::vector<Corner>& corners,
                                            const StereoCamera& camera, const Pose& T_next_now) {
  Eigen::Vector3d off = Eigen::Vector3d::Zero();
  for (int round = 0; round < 15; ++round) {
    Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
    Eigen::Vector3d slope = Eigen::Vector3d::Zero();
    std::size_t used = 0;
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(off.norm(), off.norm() > 0 ? off.normalized() : Eigen::Vector3d::UnitX())
            .toRotationMatrix();
    for (const Corner& corner : corners) {
      const Eigen::Vector3d p = turn * (T_next_now * corner.place);
      const double x = p.x() / p.z(), y = p.y() / p.z();
      const Eigen::Vector2d residual(corner.seen.x() - camera.fx * x - camera.cx,
                                     corner.seen.y() - camera.fy * y - camera.cy);
      if (residual.norm() > 5.0) continue;
      ++used;
      Eigen::Matrix<double, 2, 3> jacobian;
      jacobian << -camera.fx * x * y, camera.fx * (1.0 + x * x), -camera.fx * y,  //
          -camera.fy * (1.0 + y * y), camera.fy * x * y, camera.fy * x;
      const double weight = 1.0 / (1.0 + residual.squaredNorm() / 0.09);
      information += weight * jacobian.transpose() * jacobian;
      slope += weight * jacobian.transpose() * residual;
    }
    if (used < kMinCorners) return std::nullopt;
    off += information.ldlt().solve(slope);
  }
  return off;
}

struct Sum {
  Eigen::Vector3d squares = Eigen::Vector3d::Zero();
  int pairs = 0;
};

/// Mean difference of the motions, in the camera's axes, relative to the path.
Eigen::Vector3d offCourse(const std::vector<Pose>& poses, const std::vector<Pose>& truth) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (std::size_t i = 0; i + kSpan < std::min(poses.size(), truth.size()); ++i) {
    const Eigen::Vector3d true_way = (truth[i].inverse() * truth[i + kSpan]).translation();
    if (true_way.norm() < 0.5) continue;
    const Eigen::Vector3d way = (poses[i].inverse() * poses[i + kSpan]).translation();
    sum += (way - true_way) / true_way.norm();
    count += 1.0;
  }
  return sum / std::max(count, 1.0);
}

void report(const std::string& rawlog, const std::vector<std::string>& files) {
  std::vector<std::vector<Pose>> poses;
  for (const auto& file : files) poses.push_back(io::readKittiPoses(file));
  std::vector<Sum> sums(files.size());
  io::RawlogSource source(rawlog, {});
  std::optional<StereoFrame> now;
  while (const auto frame = source.next()) {
    if (!frame->stereo) continue;
    const StereoFrame& next = *frame->stereo;
    const auto corners = now ? farCorners(*now, next) : std::vector<Corner>{};
    for (std::size_t i = 0; i < files.size() && now; ++i) {
      if (next.index >= poses[i].size()) continue;
      const Pose T_next_now = poses[i][next.index].inverse() * poses[i][now->index];
      const auto off = rotationLeft(corners, *next.camera, T_next_now);
      if (!off) continue;
      sums[i].squares += off->cwiseAbs2();
      ++sums[i].pairs;
    }
    now = next;
  }
  std::printf("| poses | pairs | pitch ° | yaw ° | roll ° | all ° | right, down, forward %% |\n");
  std::printf("| --- | ---: | ---: | ---: | ---: | ---: | --- |\n");
  for (std::size_t i = 0; i < files.size(); ++i) {
    if (sums[i].pairs == 0) {
      std::printf("| %s | 0 | | | | | |\n", files[i].c_str());
      continue;
    }
    const Eigen::Vector3d mean = sums[i].squares / sums[i].pairs;
    const Eigen::Vector3d rms = mean.cwiseSqrt() * 180.0 / M_PI;
    const Eigen::Vector3d off = 100.0 * offCourse(poses[i], poses[0]);
    std::printf("| %s | %d | %.4f | %.4f | %.4f | %.4f | %.2f, %.2f, %.2f |\n", files[i].c_str(),
                sums[i].pairs, rms.x(), rms.y(), rms.z(), std::sqrt(mean.sum()) * 180.0 / M_PI,
                off.x(), off.y(), off.z());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "bench_rotation_error RAWLOG POSES_KITTI.txt...\n");
    return 2;
  }
  try {
    report(argv[1], {argv + 2, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
