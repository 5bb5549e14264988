// SPDX-License-Identifier: BSD-3-Clause
// A place that is passed again looks the same: houses, trees and the ground are where they were.
#include <gtest/gtest.h>
#include <headway/sim/simulator.h>

#include <opencv2/imgproc.hpp>

namespace headway::sim {
namespace {

SimParams loop() {
  SimParams params;
  params.route.kind = RouteParams::Kind::kLoop;
  params.route.loop_length_m = 110.0;
  params.route.loop_width_m = 44.0;
  params.route.corner_radius_m = 12.0;
  params.route.laps = 2;
  params.route.speed_mps = 12.0;
  params.route.lateral_acceleration_mps2 = 4.0;
  params.world.view_distance_m = 30.0;  // the far side of the loop is removed and built again
  params.traffic.vehicles = 2;
  params.camera.width = 320;
  params.camera.height = 120;
  params.camera.focal_px = 185.0;
  params.camera.rate_hz = 5.0;
  params.camera.noise_grey = 0.0;
  params.recording.frames = 400;
  return params;
}

double angleBetween(const Pose& a, const Pose& b) {
  return Eigen::AngleAxisd((a.inverse() * b).linear()).angle();
}

/// The pixels of `other` that show what `frame` shows, and where they are known: still things with
/// a depth, inside both images.
struct Warped {
  cv::Mat picture, known;
};

Warped seenFrom(const SimFrame& frame, const SimFrame& other, const StereoCamera& camera) {
  const Pose T_other_frame =
      (other.T_map_robot * camera.T_robot_cam).inverse() * frame.T_map_robot * camera.T_robot_cam;
  cv::Mat map(frame.depth.size(), CV_32FC2, cv::Scalar::all(-1));
  Warped warped;
  warped.known = cv::Mat::zeros(frame.depth.size(), CV_8U);
  for (int v = 0; v < map.rows; ++v) {
    for (int u = 0; u < map.cols; ++u) {
      const double z = frame.depth.at<float>(v, u);
      if (z <= 0.0 || frame.instances.at<std::uint16_t>(v, u) != 0) continue;
      const Eigen::Vector3d ray((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1.0);
      const auto uvd = project(T_other_frame * (z * ray), camera);
      if (!uvd) continue;
      const cv::Point at(cvRound(uvd->x()), cvRound(uvd->y()));
      if (!cv::Rect({}, frame.depth.size()).contains(at)) continue;
      if (other.instances.at<std::uint16_t>(at) != 0) continue;
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(uvd->x()), static_cast<float>(uvd->y())};
      warped.known.at<uchar>(v, u) = 255;
    }
  }
  cv::remap(other.left, warped.picture, map, cv::noArray(), cv::INTER_LINEAR);
  return warped;
}

/// Share of the known pixels that look alike.
double likeness(const SimFrame& frame, const SimFrame& other, const StereoCamera& camera) {
  const Warped warped = seenFrom(frame, other, camera);
  cv::Mat difference, grey;
  cv::absdiff(frame.left, warped.picture, difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  const cv::Mat alike = (grey < 25) & (warped.known > 0);
  const int known = cv::countNonZero(warped.known);
  EXPECT_GT(known, frame.depth.rows * frame.depth.cols / 3);
  return cv::countNonZero(alike) / static_cast<double>(known);
}

TEST(SimulatorTest, APlaceThatIsPassedAgainLooksTheSameAwayFromActors) {
  Simulator simulator(loop());
  const double lap = 0.5 * simulator.pathLength();
  std::vector<SimFrame> first;  // the first metres, to be passed again
  double driven = 0.0, nearest = 1e9, best = 0.0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero();
  while (const auto frame = simulator.next()) {
    driven += (frame->T_map_robot.translation() - last).norm();
    last = frame->T_map_robot.translation();
    if (driven < 40.0) first.push_back(*frame);
    if (driven < 0.9 * lap) continue;
    if (driven > lap + 35.0) break;
    for (const SimFrame& before : first) {
      const double away = (before.T_map_robot.translation() - last).norm();
      if (away >= nearest || angleBetween(before.T_map_robot, frame->T_map_robot) > 0.05) continue;
      nearest = away;
      best = likeness(before, *frame, simulator.camera());
    }
  }
  ASSERT_LT(nearest, 1.0);
  EXPECT_GT(best, 0.85);  // the rest is hidden from one of the two places
}

}  // namespace
}  // namespace headway::sim
