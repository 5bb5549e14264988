// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace headway::test {

/// A stereo sequence in a folder, with truth: enough for tests to run on, no more.
struct StereoSequence {
  std::shared_ptr<const StereoCamera> camera;
  std::vector<Time> times;                              ///< [s]
  std::vector<std::string> left, right;                 ///< image files
  std::vector<std::pair<Time, Eigen::Vector3d>> truth;  ///< places of the robot [m]
  cv::Mat left_maps[2], right_maps[2];                  ///< rectification; empty where not needed

  [[nodiscard]] StereoFrame frame(std::size_t index) const {
    StereoFrame result;
    result.index = index;
    result.time = times.at(index);
    result.camera = camera;
    result.left = cv::imread(left.at(index), cv::IMREAD_GRAYSCALE);
    result.right = cv::imread(right.at(index), cv::IMREAD_GRAYSCALE);
    if (!left_maps[0].empty()) {
      cv::Mat l, r;
      cv::remap(result.left, l, left_maps[0], left_maps[1], cv::INTER_LINEAR);
      cv::remap(result.right, r, right_maps[0], right_maps[1], cv::INTER_LINEAR);
      result.left = l;
      result.right = r;
    }
    return result;
  }
};

/// A KITTI odometry sequence; the robot stands in camera 0, with turned axes.
inline StereoSequence kittiSequence(const std::filesystem::path& folder, const std::string& name) {
  StereoSequence sequence;
  const auto base = folder / "sequences" / name;
  auto camera = std::make_shared<StereoCamera>();
  std::ifstream calibration(base / "calib.txt");
  for (std::string line; std::getline(calibration, line);) {
    std::istringstream row(line);
    std::string label;
    double p[12];
    row >> label;
    for (double& value : p) row >> value;
    if (label == "P0:") {
      camera->fx = p[0];
      camera->fy = p[5];
      camera->cx = p[2];
      camera->cy = p[6];
    }
    if (label == "P1:") camera->baseline_m = -p[3] / p[0];
  }
  std::ifstream times(base / "times.txt");
  std::ifstream poses(folder / "poses" / (name + ".txt"));
  for (const auto& entry : std::filesystem::directory_iterator(base / "image_0")) {
    sequence.left.push_back(entry.path());
    sequence.right.push_back(base / "image_1" / entry.path().filename());
  }
  std::sort(sequence.left.begin(), sequence.left.end());
  std::sort(sequence.right.begin(), sequence.right.end());
  for (std::size_t i = 0; i < sequence.left.size(); ++i) {
    double time = 0.0;
    double p[12];
    times >> time;
    for (double& value : p) poses >> value;
    sequence.times.push_back(time);
    sequence.truth.emplace_back(time, Eigen::Vector3d(p[3], p[7], p[11]));
  }
  const cv::Mat first = cv::imread(sequence.left.at(0), cv::IMREAD_GRAYSCALE);
  camera->width = first.cols;
  camera->height = first.rows;
  sequence.camera = camera;
  return sequence;
}

/// The EuRoC clip, rectified by OpenCV; the robot stands in the IMU, x along the view.
inline StereoSequence eurocSequence(const std::filesystem::path& folder) {
  StereoSequence sequence;
  const cv::Matx33d K0(458.654, 0, 367.215, 0, 457.296, 248.375, 0, 0, 1);
  const cv::Matx33d K1(457.587, 0, 379.999, 0, 456.134, 255.238, 0, 0, 1);
  const cv::Vec4d D0(-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05);
  const cv::Vec4d D1(-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05);
  Eigen::Matrix4d T_body_0, T_body_1;
  T_body_0 << 0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975,  //
      0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768,              //
      -0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949, 0, 0, 0, 1;
  T_body_1 << 0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556,  //
      0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024,            //
      -0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038, 0, 0, 0, 1;
  const Eigen::Matrix4d T_1_0 = T_body_1.inverse() * T_body_0;
  cv::Matx33d R;
  cv::Vec3d t;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) R(r, c) = T_1_0(r, c);
    t[r] = T_1_0(r, 3);
  }
  const cv::Size size(752, 480);
  cv::Mat R0, R1, P0, P1, Q;
  cv::stereoRectify(K0, D0, K1, D1, size, R, t, R0, R1, P0, P1, Q, cv::CALIB_ZERO_DISPARITY, 0,
                    size);
  cv::initUndistortRectifyMap(K0, D0, R0, P0, size, CV_16SC2, sequence.left_maps[0],
                              sequence.left_maps[1]);
  cv::initUndistortRectifyMap(K1, D1, R1, P1, size, CV_16SC2, sequence.right_maps[0],
                              sequence.right_maps[1]);
  auto camera = std::make_shared<StereoCamera>();
  camera->width = size.width;
  camera->height = size.height;
  camera->fx = P0.at<double>(0, 0);
  camera->fy = P0.at<double>(1, 1);
  camera->cx = P0.at<double>(0, 2);
  camera->cy = P0.at<double>(1, 2);
  camera->baseline_m = -P1.at<double>(0, 3) / P1.at<double>(0, 0);
  Pose T_cam_rectified = Pose::Identity();
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) T_cam_rectified.linear()(r, c) = R0.at<double>(c, r);
  }
  Pose T_robot_cam = Pose(T_body_0) * T_cam_rectified;
  Pose T_robot_body = Pose::Identity();
  T_robot_body.linear() =
      (T_robot_cam.linear() * robotFromOptical().linear().transpose()).transpose();
  camera->T_robot_cam = T_robot_body * T_robot_cam;
  sequence.camera = camera;
  const auto base = folder / "mav0";
  std::ifstream index(base / "cam0" / "data.csv");
  for (std::string line; std::getline(index, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::string stamp = line.substr(0, line.find(','));
    const auto name = stamp + ".png";
    if (!std::filesystem::exists(base / "cam0" / "data" / name)) continue;
    sequence.times.push_back(std::stod(stamp) * 1e-9);
    sequence.left.push_back(base / "cam0" / "data" / name);
    sequence.right.push_back(base / "cam1" / "data" / name);
  }
  std::ifstream truth(folder / "groundtruth.tum");
  for (std::string line; std::getline(truth, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream row(line);
    double time = 0.0;
    Eigen::Vector3d place;
    row >> time >> place.x() >> place.y() >> place.z();
    sequence.truth.emplace_back(time, place);
  }
  return sequence;
}

/// Root mean square distance of paired places after the best rigid motion between them [m].
///
/// @see Umeyama 1991
inline double alignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                          const std::vector<Eigen::Vector3d>& truth) {
  Eigen::Matrix3Xd a(3, estimate.size());
  Eigen::Matrix3Xd b(3, truth.size());
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    a.col(static_cast<Eigen::Index>(i)) = estimate[i];
    b.col(static_cast<Eigen::Index>(i)) = truth[i];
  }
  const Eigen::Matrix4d T = Eigen::umeyama(a, b, false);
  const Eigen::Matrix3Xd moved = (T.topLeftCorner<3, 3>() * a).colwise() + T.topRightCorner<3, 1>();
  return std::sqrt((moved - b).colwise().squaredNorm().mean());
}

/// The truth nearest in time to each of the estimates, where one lies within 20 ms.
inline double absoluteTrajectoryError(const std::vector<std::pair<Time, Eigen::Vector3d>>& estimate,
                                      const std::vector<std::pair<Time, Eigen::Vector3d>>& truth) {
  std::vector<Eigen::Vector3d> a, b;
  for (const auto& [time, place] : estimate) {
    const auto nearest = std::min_element(truth.begin(), truth.end(), [t = time](auto& x, auto& y) {
      return std::abs(x.first - t) < std::abs(y.first - t);
    });
    if (nearest == truth.end() || std::abs(nearest->first - time) > 0.02) continue;
    a.push_back(place);
    b.push_back(nearest->second);
  }
  return a.size() < 3 ? 1e9 : alignedRmse(a, b);
}

}  // namespace headway::test
