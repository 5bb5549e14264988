// SPDX-License-Identifier: BSD-3-Clause
// Laws of whole frames: drawn, judged and detected together.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/sim/simulator.h>
#include <headway_test/input_error.h>

#include <cmath>
#include <functional>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace headway::sim {
namespace {

using ::testing::HasSubstr;

SimParams smallStreet() {
  SimParams params;
  params.camera.width = 480;
  params.camera.height = 180;
  params.camera.focal_px = 278;
  params.camera.noise_grey = 0.0;
  params.camera.gain_difference = 0.0;
  params.camera.vignetting = 0.0;
  params.traffic.vehicles = 7;
  params.traffic.pedestrians = 12;
  params.recording.frames = 12;
  return params;
}

std::vector<SimFrame> framesOf(const SimParams& params) {
  Simulator simulator(params);
  std::vector<SimFrame> frames;
  while (auto frame = simulator.next()) frames.push_back(std::move(*frame));
  return frames;
}

/// Frames drawn once for all tests that look at them.
const std::vector<SimFrame>& street() {
  static const std::vector<SimFrame> frames = framesOf(smallStreet());
  return frames;
}

StereoCamera cameraOf(const SimParams& params) { return Simulator(params).camera(); }

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

double overlap(const Box2d& a, const Box2d& b) {
  const double w = std::min(a.right, b.right) - std::max(a.left, b.left);
  const double h = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  if (w <= 0.0 || h <= 0.0) return 0.0;
  return w * h / (a.width() * a.height() + b.width() * b.height() - w * h);
}

/// Box in the image around the eight corners of a 3D box.
Box2d projected(const Box3d& box, const StereoCamera& camera) {
  Box2d result{1e9, 1e9, -1e9, -1e9};
  const Eigen::Vector3d front = frontOf(box), side(-front.z(), 0.0, front.x());
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at = box.centre + (corner & 1 ? 0.5 : -0.5) * box.length * front +
                               (corner & 2 ? 0.5 : -0.5) * box.width * side +
                               Eigen::Vector3d(0, (corner & 4 ? 0.5 : -0.5) * box.height, 0);
    const auto uvd = project(at, camera);
    if (!uvd) return {0, 0, 0, 0};
    result.left = std::min(result.left, uvd->x());
    result.right = std::max(result.right, uvd->x());
    result.top = std::min(result.top, uvd->y());
    result.bottom = std::max(result.bottom, uvd->y());
  }
  return result;
}

TEST(SimulatorTest, SameSeedSameFramesOtherSeedOtherWorld) {
  SimParams params = smallStreet();
  params.recording.frames = 3;
  const auto once = framesOf(params), again = framesOf(params);
  params.world.seed = 2;
  const auto other = framesOf(params);
  ASSERT_EQ(once.size(), 3U);
  for (std::size_t i = 0; i < once.size(); ++i) {
    EXPECT_TRUE(sameBytes(once[i].left, again[i].left));
    EXPECT_TRUE(sameBytes(once[i].right, again[i].right));
    EXPECT_TRUE(sameBytes(once[i].depth, again[i].depth));
    EXPECT_EQ(once[i].T_map_robot.matrix(), again[i].T_map_robot.matrix());
    ASSERT_EQ(once[i].detections.items.size(), again[i].detections.items.size());
    for (std::size_t k = 0; k < once[i].detections.items.size(); ++k) {
      EXPECT_EQ(once[i].detections.items[k].box3d->centre,
                again[i].detections.items[k].box3d->centre);
    }
    cv::Mat difference;
    cv::absdiff(once[i].left, other[i].left, difference);
    EXPECT_GT(cv::mean(difference)[0], 15.0);
  }
}

TEST(SimulatorTest, TheMapBeginsAtTheRobotsFirstPose) {
  EXPECT_LT((street()[0].T_map_robot.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
  const double way = street()[11].T_map_robot.translation().x();
  EXPECT_GT(way, 3.0);
  EXPECT_LT(way, 1.1 * 0.1 * 11 * smallStreet().route.speed_mps);
  EXPECT_NEAR(street()[11].time - street()[0].time, 1.1, 1e-6);
}

TEST(SimulatorTest, MasksFillTheProjectedTruthBoxes) {
  const StereoCamera camera = cameraOf(smallStreet());
  int vehicles = 0, people = 0;
  for (const SimFrame& frame : street()) {
    for (std::size_t i = 0; i < frame.objects.size(); ++i) {
      const TruthObject& object = frame.objects[i];
      if (object.visible < 0.97 || object.truncation > 0.0 || object.box2d.height() < 20) continue;
      std::vector<cv::Point> pixels;
      cv::findNonZero(frame.instances == static_cast<int>(i) + 1, pixels);
      ASSERT_FALSE(pixels.empty());
      const cv::Rect mask = cv::boundingRect(pixels);
      const Box2d seen{mask.x - 0.5, mask.y - 0.5, mask.x + mask.width - 0.5,
                       mask.y + mask.height - 0.5};
      EXPECT_GT(overlap(seen, object.box2d), 0.75) << toString(object.object_class);
      const double with_truth_box = overlap(seen, projected(object.box3d, camera));
      if (isVehicle(object.object_class)) {
        EXPECT_GT(with_truth_box, 0.8);
        ++vehicles;
      } else {
        EXPECT_GT(with_truth_box, 0.4);  // limbs do not fill a walker's box
        ++people;
      }
    }
  }
  EXPECT_GT(vehicles, 10);
  EXPECT_GT(people, 3);
}

TEST(SimulatorTest, DepthOfTheRoadAgreesWithGeometry) {
  SimParams params = smallStreet();
  params.traffic.vehicles = params.traffic.cyclists = params.traffic.pedestrians = 0;
  params.world.parked_ratio = 0.0;
  params.camera.ride_deg = 0.0;
  params.recording.frames = 1;
  const StereoCamera camera = cameraOf(params);
  const SimFrame frame = framesOf(params).at(0);
  for (int v = 110; v < 180; v += 5) {  // below the horizon, in the lane
    const double z = params.camera.mount_height_m * camera.fy / (v - camera.cy);
    const int u = static_cast<int>(camera.cx);
    EXPECT_NEAR(frame.depth.at<float>(v, u), z, 3e-4 * z) << "row " << v;
  }
}

TEST(SimulatorTest, LeftAndRightAgreeWithTheDepth) {
  const StereoCamera camera = cameraOf(smallStreet());
  const SimFrame& frame = street()[5];
  cv::Mat map(frame.depth.size(), CV_32FC2), warped;
  for (int v = 0; v < map.rows; ++v) {
    for (int u = 0; u < map.cols; ++u) {
      const double z = frame.depth.at<float>(v, u);
      const double disparity = z > 0.0 ? camera.fx * camera.baseline_m / z : 0.0;
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(u - disparity), static_cast<float>(v)};
    }
  }
  cv::remap(frame.right, warped, map, cv::noArray(), cv::INTER_LINEAR);
  cv::Mat difference, grey;
  cv::absdiff(frame.left, warped, difference);
  cv::cvtColor(difference, grey, cv::COLOR_BGR2GRAY);
  const cv::Rect inner(100, 0, grey.cols - 100, grey.rows);
  const double agree = cv::countNonZero(grey(inner) < 20) / static_cast<double>(inner.area());
  EXPECT_GT(agree, 0.9);  // the rest is hidden from one of the two
}

TEST(SimulatorTest, MatchedDisparityAgreesWithTheDepth) {
  const StereoCamera camera = cameraOf(smallStreet());
  const auto matcher = cv::StereoSGBM::create(0, 64, 5, 200, 800, 1, 63, 10, 100, 2);
  std::size_t judged = 0, bad = 0;
  for (const std::size_t i : {2U, 9U}) {
    const SimFrame& frame = street()[i];
    cv::Mat left, right, disparity;
    cv::cvtColor(frame.left, left, cv::COLOR_BGR2GRAY);
    cv::cvtColor(frame.right, right, cv::COLOR_BGR2GRAY);
    matcher->compute(left, right, disparity);
    for (int v = 0; v < disparity.rows; ++v) {
      for (int u = 0; u < disparity.cols; ++u) {
        const double found = disparity.at<std::int16_t>(v, u) / 16.0,
                     z = frame.depth.at<float>(v, u);
        if (found <= 0.0 || z <= 0.0) continue;
        ++judged;
        bad += std::abs(found - camera.fx * camera.baseline_m / z) > 3.0 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(judged, 40000U);
  EXPECT_LT(static_cast<double>(bad) / static_cast<double>(judged), 0.08);
}

TEST(SimulatorTest, ParkedVehiclesStandStillInTheMap) {
  std::map<std::int64_t, Eigen::Vector3d> places;
  int seen_again = 0;
  for (const SimFrame& frame : street()) {
    for (const TruthObject& object : frame.objects) {
      if (!object.parked) continue;
      const auto known = places.emplace(object.id, object.position);
      if (known.second) continue;
      EXPECT_LT((known.first->second - object.position).norm(), 1e-9);
      ++seen_again;
    }
  }
  EXPECT_GT(seen_again, 10);
}

TEST(SimulatorTest, TruthBoxesAreTheMapsObjectsSeenFromTheCamera) {
  const StereoCamera camera = cameraOf(smallStreet());
  for (const SimFrame& frame : street()) {
    for (const TruthObject& object : frame.objects) {
      const Eigen::Vector3d centre = frame.T_map_robot * camera.T_robot_cam * object.box3d.centre;
      EXPECT_LT((centre - object.position).norm(), 1e-9);
      EXPECT_EQ(object.occlusion, occlusionLevel(object.visible));
    }
  }
}

TEST(SimulatorTest, FramesAreDroppedAndTimesWanderWhenAskedFor) {
  SimParams params = smallStreet();
  params.recording.frames = 12;
  params.camera.drop_ratio = 0.3;
  params.camera.jitter_s = 0.005;
  params.camera.imu = params.camera.odometry = true;
  const auto frames = framesOf(params);
  ASSERT_EQ(frames.size(), 12U);
  EXPECT_GT(frames.back().time - frames.front().time, 1.25);
  double off_beat = 0.0;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const double interval = frames[i].time - frames[i - 1].time;
    EXPECT_GT(interval, 0.05);
    off_beat += std::abs(std::remainder(interval, 0.1));
    EXPECT_EQ(frames[i].index, i);
    EXPECT_NEAR(static_cast<double>(frames[i].imu.size()), 100.0 * interval, 3.0);
    ASSERT_TRUE(frames[i].odometry);
    EXPECT_NEAR(frames[i].odometry->time, frames[i].time, 1e-6);
  }
  EXPECT_GT(off_beat, 0.01);
}

TEST(SimulatorTest, APieceOutOfTheMiddleIsThatPieceOfTheWhole) {
  SimParams params = smallStreet();
  params.recording.first_frame = 5;
  params.recording.frames = 2;
  const auto piece = framesOf(params);
  ASSERT_EQ(piece.size(), 2U);
  EXPECT_EQ(piece[1].index, 1U);
  EXPECT_DOUBLE_EQ(piece[1].time, street()[6].time);
  EXPECT_TRUE(sameBytes(piece[1].left, street()[6].left));
  EXPECT_TRUE(sameBytes(piece[1].instances, street()[6].instances));
  EXPECT_LT((piece[0].T_map_robot.matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-12);
}

TEST(SimulatorTest, ACalibrationErrorIsInTheImagesAndNotInTheTruth) {
  SimParams params = smallStreet();
  params.recording.frames = 1;
  params.calibration_error.right_pitch_deg = 0.5;
  const auto wrong = framesOf(params);
  const auto grey = [](const cv::Mat& picture) {
    cv::Mat result;
    cv::cvtColor(picture, result, cv::COLOR_BGR2GRAY);
    result.convertTo(result, CV_32F);
    return result;
  };
  const auto shift = cv::phaseCorrelate(grey(street()[0].right), grey(wrong[0].right));
  EXPECT_NEAR(shift.y, params.camera.focal_px * std::tan(0.5 * M_PI / 180.0), 0.3);
  EXPECT_TRUE(sameBytes(wrong[0].left, street()[0].left));
  EXPECT_TRUE(sameBytes(wrong[0].depth, street()[0].depth));
  params.calibration_error = {};
  params.calibration_error.flex_deg = 0.1;
  params.recording.frames = 2;
  const auto bent = framesOf(params);
  EXPECT_FALSE(sameBytes(bent[1].right, street()[1].right));
  EXPECT_TRUE(sameBytes(bent[1].left, street()[1].left));
}

TEST(SimulatorTest, MotionBlurSmearsAndGreyIsGrey) {
  SimParams params = smallStreet();
  params.recording.frames = 2;
  params.camera.colour = false;
  const auto sharpness = [](const SimFrame& frame) {
    cv::Mat edges;
    cv::Laplacian(frame.left, edges, CV_32F);
    return cv::norm(edges);
  };
  const auto sharp = framesOf(params);
  params.camera.blur_samples = 5;
  params.camera.exposure_s = 0.06;
  const auto blurred = framesOf(params);
  EXPECT_EQ(sharp[1].left.type(), CV_8UC1);
  EXPECT_LT(sharpness(blurred[1]), 0.8 * sharpness(sharp[1]));
}

TEST(SimulatorTest, AtTheEndOfThePathFramesEndAndItSaysSo) {
  SimParams params = smallStreet();
  params.route.shape = "straight 12";
  params.camera.width = 160;
  params.camera.height = 64;
  params.recording.frames = 500;
  Simulator simulator(params);
  std::size_t frames = 0;
  EXPECT_FALSE(simulator.arrived());
  while (simulator.next()) ++frames;
  EXPECT_TRUE(simulator.arrived());
  EXPECT_GT(frames, 15U);  // 12 m at 7 m/s, 10 frames a second
  EXPECT_LT(frames, 100U);
  params.recording.first_frame = static_cast<int>(frames);
  Simulator too_late(params);
  try {
    (void)too_late.next();
    ADD_FAILURE() << "a piece after the end of the path is none";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("[recording] first_frame"));
    EXPECT_THAT(error.what(), HasSubstr("ends after " + std::to_string(frames)));
  }
}

TEST(SimulatorTest, ImpossibleParametersNameTheirKey) {
  const auto errorOf = [](const std::function<void(SimParams&)>& spoil) -> std::string {
    SimParams params;
    spoil(params);
    try {
      const Simulator simulator(params);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_THAT(errorOf([](SimParams& p) { p.traffic.vehicles = 60; }),
              HasSubstr("[traffic] vehicles"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.traffic.cyclists = 50; }),
              HasSubstr("[traffic] cyclists"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.traffic.bus_ratio = 0.95; }), HasSubstr("bus_ratio"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.world.house_height_max_m = 3.5; }),
              HasSubstr("[world] house_height_max_m"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.route.shape = "zigzag 5"; }),
              HasSubstr("[route] shape"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.route.kind = RouteParams::Kind::kKittiPoses; }),
              HasSubstr("[route] file"));
  EXPECT_THAT(errorOf([](SimParams& p) {
                p.route.kind = RouteParams::Kind::kLoop;
                p.route.corner_radius_m = 90;
              }),
              HasSubstr("[route] corner_radius_m"));
  EXPECT_THAT(errorOf([](SimParams& p) { p.camera.jitter_s = 0.04; }),
              HasSubstr("[camera] jitter_s"));
}

TEST(SimulatorTest, RefusesParametersOutOfRange) {
  SimParams params;
  params.camera.baseline_m = 0.0;
  EXPECT_EQ("[camera] baseline_m: '0' is out of range [m, 0.01 .. 2]",
            test::inputErrorOf([&] { const Simulator simulator(params); }));
  params = {};
  params.recording.jpeg_quality = 0;
  EXPECT_EQ("[recording] jpeg_quality: '0' is out of range [10 .. 100]",
            test::inputErrorOf([&] { const Simulator simulator(params); }));
}

}  // namespace
}  // namespace headway::sim
