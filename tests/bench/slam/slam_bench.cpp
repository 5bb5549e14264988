// Runs stereo SLAM over one sequence and prints its accuracy and what each stage costs, beside a
// yardstick that makes figures of different machines comparable.
//
//     bench_slam kitti-odometry DIR 06 [slam.key=value ...]
//     bench_slam euroc DIR [slam.key=value ...]

#include <headway/core/error.h>
#include <headway/slam/stereo_slam.h>
#include <headway_test/stereo_sequence.h>
#include <sys/resource.h>

#include <cstdio>
#include <opencv2/features2d.hpp>

namespace {

using headway::StageTimes;
using headway::test::StereoSequence;

double processorMs() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto ms = [](const timeval& t) {
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-3 * static_cast<double>(t.tv_usec);
  };
  return ms(usage.ru_utime) + ms(usage.ru_stime);
}

/// OpenCV's ORB with 2,000 features on both images, one thread.
void measureYardstick(const headway::StereoFrame& frame, StageTimes& times) {
  static const auto orb = cv::ORB::create(2000);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  {
    const auto watch = times.watch("yardstick");
    orb->detectAndCompute(frame.left, cv::noArray(), keypoints, descriptors);
    orb->detectAndCompute(frame.right, cv::noArray(), keypoints, descriptors);
  }
  cv::setNumThreads(threads);
}

void printTimes(const StageTimes& slam, const StageTimes& own) {
  StageTimes all = slam;
  all.merge(own);
  for (const auto& [stage, summary] : all.summary()) {
    std::printf("%-14s median %7.2f ms   p95 %7.2f ms   max %7.2f ms\n", stage.c_str(),
                summary.median_ms, summary.p95_ms, summary.max_ms);
  }
  const auto summary = all.summary();
  std::printf("slam_track / yardstick  %.2f\n",
              summary.at("slam_track").median_ms / summary.at("yardstick").median_ms);
}

void run(const StereoSequence& sequence, const headway::slam::SlamParams& params) {
  headway::slam::StereoSlam slam(sequence.camera, params);
  StageTimes times;
  double processor_ms = 0.0;
  int lost = 0;
  int keyframes = 0;
  double inliers = 0.0;
  std::vector<std::pair<headway::Time, Eigen::Vector3d>> online;
  for (std::size_t i = 0; i < sequence.times.size(); ++i) {
    const auto frame = sequence.frame(i);
    const double before = processorMs();
    {
      const auto watch = times.watch("frame");
      const auto update = slam.process(frame, {});
      lost += update.status == headway::slam::TrackingStatus::kLost ? 1 : 0;
      keyframes += update.is_keyframe ? 1 : 0;
      inliers += update.inliers;
      online.emplace_back(frame.time, update.T_map_robot.translation());
    }
    processor_ms += processorMs() - before;
    measureYardstick(frame, times);
  }
  std::vector<std::pair<headway::Time, Eigen::Vector3d>> final_path;
  for (const auto& estimate : slam.trajectory()) {
    final_path.emplace_back(estimate.time, estimate.T_map_robot.translation());
  }
  const double count = static_cast<double>(sequence.times.size());
  std::printf("frames %zu, lost %d, keyframes %d, inliers %.0f, landmarks %zu\n",
              sequence.times.size(), lost, keyframes, inliers / count, slam.map().landmarks.size());
  std::printf("ATE RMSE final %.4f m, online %.4f m\n",
              headway::test::absoluteTrajectoryError(final_path, sequence.truth),
              headway::test::absoluteTrajectoryError(online, sequence.truth));
  printTimes(slam.times(), times);
  std::printf("processor %.2f ms a frame\n", processor_ms / count);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool kitti = arguments.size() >= 3 && arguments[0] == "kitti-odometry";
  const bool euroc = arguments.size() >= 2 && arguments[0] == "euroc";
  if (!kitti && !euroc) {
    std::fprintf(
        stderr,
        "usage: bench_slam kitti-odometry DIR SEQUENCE | euroc DIR  [slam.key=value ...]\n");
    return 2;
  }
  try {
    headway::slam::SlamParams slam_params;
    headway::Params params;
    slam_params.describe(params.section("slam"));
    for (std::size_t i = kitti ? 3 : 2; i < arguments.size(); ++i) params.set(arguments[i]);
    run(kitti ? headway::test::kittiSequence(arguments[1], arguments[2])
              : headway::test::eurocSequence(arguments[1]),
        slam_params);
  } catch (const headway::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
  return 0;
}
