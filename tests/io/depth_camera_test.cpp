// SPDX-License-Identifier: BSD-3-Clause
// Recordings of depth cameras: intensity and depth as frames with given disparities.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/image_file.h>
#include <headway/io/live_source.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/raw_camera.h>
#include <headway_test/folders.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rectifier.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using Counts = std::map<std::string, std::size_t>;

/// A wall before the colour camera that recedes to the right and upwards: z = 2 m + slopes.
const Eigen::Vector3d kNormal(-0.2, 0.1, 1.0);
constexpr double kOffset = 2.0;

/// Range of the wall in units along a ray of a camera.
double rangeAlong(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  return (kOffset - kNormal.dot(origin)) / kNormal.dot(direction);
}

RawDepthCamera registeredCamera() {
  RawDepthCamera camera;
  const RawStereoCamera pair = rawFrom(test::smallCamera());
  camera.color = camera.depth = pair.left;
  camera.T_robot_color = pair.T_robot_left;
  camera.max_range_m = 8.0;
  return camera;
}

/// A depth image of the wall.
cv::Mat wallDepth(const RawDepthCamera& camera) {
  cv::Mat depth(camera.depth.height, camera.depth.width, CV_16U);
  for (int v = 0; v < depth.rows; ++v) {
    for (int u = 0; u < depth.cols; ++u) {
      const auto ray = raysOf({cv::Point2d(u, v)}, camera.depth).front();
      Eigen::Vector3d direction(ray.x, ray.y, 1.0);
      if (!camera.ranges_are_depths) direction.normalize();
      const double range =
          rangeAlong(camera.T_color_depth.translation(), camera.T_color_depth.linear() * direction);
      depth.at<std::uint16_t>(v, u) =
          static_cast<std::uint16_t>(std::lround(range / camera.metres_per_unit));
    }
  }
  return depth;
}

/// Compares the disparities of a frame with the wall's; returns the ratio of those that are known.
double compareWithWall(const StereoFrame& frame, double tolerance_px) {
  const StereoCamera& camera = *frame.camera;
  int known = 0;
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double d = static_cast<double>(frame.disparity.at<float>(v, u));
      if (d == 0.0) continue;
      ++known;
      const double z = rangeAlong(Eigen::Vector3d::Zero(), ray(Eigen::Vector2d(u, v), camera));
      EXPECT_NEAR(camera.fx * camera.baseline_m / z, d, tolerance_px) << u << ", " << v;
      if (::testing::Test::HasFailure()) return 0.0;
    }
  }
  return static_cast<double>(known) / (camera.width * camera.height);
}

class DepthCameraTest : public ::testing::Test {
 protected:
  /// Records frames; the first frame read is returned.
  RecordedFrame recorded(const RawDepthCamera& camera, const cv::Mat& depth, int frames = 3) {
    {
      RawlogSink sink(path_, ImageStorage::kEmbedded);
      for (int i = 0; i < frames; ++i) {
        sink.writeDepth(test::frameTime(static_cast<std::size_t>(i)), imageOf(camera, i), depth,
                        camera);
      }
    }
    auto read = framesOf();
    EXPECT_EQ(static_cast<std::size_t>(frames), read.size());
    return read.empty() ? RecordedFrame() : read.front();
  }

  static cv::Mat imageOf(const RawDepthCamera& camera, int number) {
    return test::wall(number, 8, {camera.color.width, camera.color.height}).left;
  }

  /// Records observations, and reads the frames and what was skipped.
  std::vector<RecordedFrame> read(const std::vector<mrpt::obs::CObservation::Ptr>& observations) {
    {
      RawlogSink sink(path_, ImageStorage::kEmbedded);
      for (const auto& one : observations) sink.write(*one);
    }
    return framesOf();
  }

  std::vector<RecordedFrame> framesOf(const std::string& label = "") {
    RawlogSourceOptions options;
    options.sensor_label = label;
    RawlogSource source(path_, options);
    auto frames = test::framesOf(source);
    skipped_ = source.skipped();
    report_ = source.calibration();
    return frames;
  }

  static mrpt::obs::CObservation3DRangeScan::Ptr scan(int number, const RawDepthCamera& camera,
                                                      const std::string& label = "rgbd") {
    auto result =
        depthObservation(mrpt::img::CImage(imageOf(camera, number), mrpt::img::SHALLOW_COPY),
                         wallDepth(camera), camera);
    result->timestamp = mrptTime(test::frameTime(static_cast<std::size_t>(number)));
    result->sensorLabel = label;
    return result;
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
  Counts skipped_;
  std::optional<CalibrationReport> report_;
};

TEST_F(DepthCameraTest, ARegisteredDepthImageBecomesDisparitiesPixelByPixel) {
  const RawDepthCamera camera = registeredCamera();
  const auto frame = recorded(camera, wallDepth(camera));
  ASSERT_TRUE(frame.stereo);
  EXPECT_TRUE(test::sameImage(imageOf(camera, 0), frame.stereo->left));
  EXPECT_TRUE(frame.stereo->right.empty());
  EXPECT_EQ(1.0, compareWithWall(*frame.stereo, 0.15));
  const StereoCamera& read = *frame.stereo->camera;
  EXPECT_EQ(8.0, read.depth_reach_m);
  EXPECT_EQ(100.0, read.fx);
  EXPECT_NEAR(0.4 / (0.0025 * 100.0), read.baseline_m, 1e-9);
  EXPECT_LT((read.T_robot_cam.matrix() - camera.T_robot_color.matrix()).norm(), 1e-9);
  ASSERT_TRUE(report_);
  EXPECT_TRUE(report_->is_depth_camera);
  EXPECT_EQ(1.0, report_->depth_ratio);
  EXPECT_TRUE(skipped_.empty());
}

TEST_F(DepthCameraTest, CamerasWithOwnLensesAndPosesAreRegistered) {
  RawDepthCamera camera = registeredCamera();
  camera.depth = {128, 96, 85.0, 84.0, 62.0, 50.0, {-0.1, 0.02, 0.001, -0.001, 0.0}, {}, false};
  camera.color.distortion = {0.05, -0.02, 0.0, 0.001, 0.0};
  camera.T_color_depth.translation() = Eigen::Vector3d(-0.05, 0.01, 0.004);
  camera.T_color_depth.linear() = expSo3({0.02, -0.03, 0.01});
  for (const bool ranges_are_depths : {true, false}) {
    camera.ranges_are_depths = ranges_are_depths;
    const auto frame = recorded(camera, wallDepth(camera));
    ASSERT_TRUE(frame.stereo);
    EXPECT_GT(compareWithWall(*frame.stereo, 0.25), 0.85);
    EXPECT_TRUE(report_->rectified_here);
  }
}

TEST_F(DepthCameraTest, ALowerResolutionFillsTheImageWithoutGaps) {
  RawDepthCamera camera = registeredCamera();
  camera.depth = {80, 60, 50.0, 50.0, 40.0, 29.875, {}, {}, false};
  const auto frame = recorded(camera, wallDepth(camera));
  EXPECT_GT(compareWithWall(*frame.stereo, 0.25), 0.95);
}

TEST_F(DepthCameraTest, PixelsThatALensMapsFarAwayAreLeftOut) {
  RawDepthCamera camera = registeredCamera();
  camera.depth.distortion = {-0.9, 0.5, 0.1, -0.1, -0.5};
  const auto frame = recorded(camera, cv::Mat(120, 160, CV_16U, cv::Scalar(2000)));
  ASSERT_TRUE(frame.stereo);
  EXPECT_TRUE(cv::checkRange(frame.stereo->disparity));
}

/// What covers a pixel does not depend on the range for cameras in one place, and is found once.
TEST_F(DepthCameraTest, CamerasInOnePlaceSeeAsThoseAHairApart) {
  RawDepthCamera camera = registeredCamera();
  camera.color.distortion = camera.depth.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0};
  camera.T_color_depth.linear() = expSo3({0.02, -0.03, 0.01});
  for (const bool ranges_are_depths : {true, false}) {
    camera.ranges_are_depths = ranges_are_depths;
    camera.T_color_depth.translation().x() = 0.0;
    cv::Mat ranges = wallDepth(camera);
    ranges(cv::Rect(60, 30, 10, 12)).setTo(1000);
    ranges(cv::Rect(90, 60, 10, 12)).setTo(0);
    ranges(cv::Rect(90, 90, 10, 12)).setTo(65535);
    ranges(cv::Rect(20, 90, 10, 12)).setTo(30);  // nearer than anything is
    const StereoCamera target = test::smallCamera();
    const cv::Mat at_once = DepthRegistration(camera, target).disparities(ranges);
    camera.T_color_depth.translation().x() = 1e-4;  // 0.005 px at 2 m
    const cv::Mat one_by_one = DepthRegistration(camera, target).disparities(ranges);
    cv::Mat difference;
    cv::absdiff(at_once, one_by_one, difference);
    EXPECT_LT(cv::countNonZero(difference > 0.02), 100) << "those at edges of surfaces";
    EXPECT_GT(cv::countNonZero(at_once > 0.0), 17000);
  }
}

/// Whether pixels that cover each other are found once must not depend on it: one by one, a hole
/// costs the triangles beside it.
TEST_F(DepthCameraTest, HowFarTheCameraMeasuresChangesNothingNearer) {
  RawDepthCamera camera = registeredCamera();
  camera.color = camera.depth = {
      640, 480, 517.0, 516.0, 318.6, 255.3, {0.26, -0.95, -0.005, 0.003, 1.16}, {}, false};
  cv::Mat ranges(480, 640, CV_16U, cv::Scalar(2000));
  for (int place = 0; place < static_cast<int>(ranges.total()); place += 47) {
    ranges.at<std::uint16_t>(place / ranges.cols, place % ranges.cols) = 0;
  }
  StereoCamera target{640, 480, 517.0, 517.0, 319.5, 239.5, 0.08};
  const cv::Mat of_any_reach = DepthRegistration(camera, target).disparities(ranges);
  target.depth_reach_m = 5.0;
  const cv::Mat of_near_reach = DepthRegistration(camera, target).disparities(ranges);
  cv::Mat difference;
  cv::absdiff(of_any_reach, of_near_reach, difference);
  EXPECT_EQ(0, cv::countNonZero(difference > 1e-3));
  EXPECT_GT(cv::countNonZero(of_any_reach > 0.0), 200000);
}

TEST_F(DepthCameraTest, UnitsAndHolesAreKept) {
  RawDepthCamera camera = registeredCamera();
  camera.metres_per_unit = 0.0002;
  cv::Mat depth = wallDepth(camera);
  depth(cv::Rect(20, 30, 10, 12)).setTo(0);
  depth(cv::Rect(60, 30, 10, 12)).setTo(65535);  // as some drivers mark them
  const auto frame = recorded(camera, depth);
  EXPECT_NEAR(1.0 - 240.0 / (160.0 * 120.0), compareWithWall(*frame.stereo, 0.1), 1e-9);
  EXPECT_EQ(0, cv::countNonZero(frame.stereo->disparity(cv::Rect(20, 30, 10, 12))));
}

TEST_F(DepthCameraTest, WhatIsDeeperThanTheCameraMeasuresIsNoMeasurement) {
  for (const bool is_registered : {true, false}) {
    for (const double offset_m : {0.0, 0.05}) {
      RawDepthCamera camera = registeredCamera();
      if (!is_registered) camera.depth.fx = camera.depth.fy = 98.0;
      camera.T_color_depth.translation().x() = offset_m;
      camera.max_range_m = 4.0;
      cv::Mat depth(120, 160, CV_16U, cv::Scalar(4000));
      depth.colRange(80, 160).setTo(4100);
      const auto frame = recorded(camera, depth);
      const cv::Mat& seen = frame.stereo->disparity;
      EXPECT_EQ(0, cv::countNonZero(seen.colRange(90, 160))) << is_registered << offset_m;
      EXPECT_GT(cv::countNonZero(seen.colRange(10, 70)), 60 * 110) << is_registered << offset_m;
      camera.max_range_m = 0.0;  // unknown: nothing is left out
      EXPECT_GT(cv::countNonZero(recorded(camera, depth).stereo->disparity.colRange(90, 150)),
                60 * 110);
    }
  }
}

TEST_F(DepthCameraTest, TheNearerSurfaceHidesTheFartherAndNothingSpansBetween) {
  RawDepthCamera camera = registeredCamera();
  camera.T_color_depth.translation().x() = -0.1;  // the depth camera is on the left
  cv::Mat depth(120, 160, CV_16U, cv::Scalar(4000));
  depth.colRange(60, 90).setTo(1000);
  const auto frame = recorded(camera, depth);
  const auto fb = frame.stereo->camera->fx * frame.stereo->camera->baseline_m;
  std::set<long> depths;
  for (int u = 0; u < 160; ++u) {
    const auto d = static_cast<double>(frame.stereo->disparity.at<float>(60, u));
    depths.insert(d == 0.0 ? 0 : std::lround(1000.0 * fb / d));
  }
  EXPECT_EQ((std::set<long>{0, 1000, 4000}), depths);
}

TEST_F(DepthCameraTest, ADepthImageOfHalfTheSizeOfItsCalibrationIsTheSameView) {
  RawDepthCamera camera = registeredCamera();
  auto observation = scan(0, camera);
  RawDepthCamera half = camera;
  half.depth = {80, 60, 50.0, 50.0, 40.0, 29.875, {}, {}, false};
  const cv::Mat depth = wallDepth(half);
  observation->rangeImage_setSize(60, 80);
  for (int v = 0; v < 60; ++v) {
    for (int u = 0; u < 80; ++u) observation->rangeImage(v, u) = depth.at<std::uint16_t>(v, u);
  }
  const auto frames = read({observation});
  ASSERT_EQ(1u, frames.size());
  EXPECT_GT(compareWithWall(*frames[0].stereo, 0.25), 0.95);
}

TEST_F(DepthCameraTest, FramesWithoutDepthOrIntensityAreSkippedAndCounted) {
  const RawDepthCamera camera = registeredCamera();
  std::vector<mrpt::obs::CObservation::Ptr> observations;
  for (int i = 0; i < 10; ++i) observations.push_back(scan(i, camera));
  const auto at = [&](std::size_t i) {
    return std::dynamic_pointer_cast<mrpt::obs::CObservation3DRangeScan>(observations[i]);
  };
  at(2)->hasRangeImage = false;
  at(3)->hasIntensityImage = false;
  at(4)->rangeImage_setSize(60, 60);
  at(5)->rangeImage_setSize(0, 0);
  at(6)->intensityImage = mrpt::img::CImage(64, 64, mrpt::img::CH_GRAY);
  const auto frames = read(observations);
  EXPECT_EQ((Counts{{"no_depth", 1},
                    {"no_intensity_image", 1},
                    {"depth_size", 1},
                    {"broken_depth", 1},
                    {"image_size", 1}}),
            skipped_);
  ASSERT_EQ(5u, frames.size());
  EXPECT_EQ(test::frameTime(7), frames[2].time);
}

TEST_F(DepthCameraTest, ExternalImagesAreReadFromTheirFolder) {
  const RawDepthCamera camera = registeredCamera();
  fs::create_directories(folder_ / "x_Images");
  const std::string images = folder_ / "x_Images";
  std::vector<mrpt::obs::CObservation::Ptr> observations;
  for (int i = 0; i < 6; ++i) {
    auto one = scan(i, camera);
    const std::string name = "depth" + std::to_string(i);
    mrpt::obs::CObservation3DRangeScan::EXTERNALS_AS_TEXT(i == 1);
    one->rangeImage_convertToExternalStorage(i == 5 ? "../" + name : name, images + "/");
    observations.push_back(one);
  }
  mrpt::obs::CObservation3DRangeScan::EXTERNALS_AS_TEXT(false);
  fs::remove(folder_ / "x_Images/depth2.bin");
  test::writeContent(folder_ / "x_Images/depth3.bin", "rubbish");
  const std::string whole = test::contentOf(folder_ / "x_Images/depth4.bin");
  test::writeContent(folder_ / "x_Images/depth4.bin", whole.substr(0, whole.size() / 2));
  const auto frames = read(observations);
  EXPECT_EQ((Counts{{"missing_depth", 1}, {"broken_depth", 2}, {"depth_outside_folder", 1}}),
            skipped_);
  ASSERT_EQ(2u, frames.size());
  for (const auto& frame : frames) EXPECT_EQ(1.0, compareWithWall(*frame.stereo, 0.15));
}

TEST_F(DepthCameraTest, HugeAndOldExternalFilesAreHandled) {
  const RawDepthCamera camera = registeredCamera();
  auto one = scan(0, camera);
  auto two = scan(1, camera);
  fs::create_directories(folder_ / "x_Images");
  one->rangeImage_convertToExternalStorage("a", (folder_ / "x_Images").string() + "/");
  two->rangeImage_convertToExternalStorage("b", (folder_ / "x_Images").string() + "/");
  test::writeContent(folder_ / "x_Images/a.bin",
                     std::string("\xFF\xFF\xFF\x7F\xFF\xFF\xFF\x7F", 8));
  const auto frames = read({one, two});
  EXPECT_EQ((Counts{{"broken_depth", 1}}), skipped_);
  EXPECT_EQ(1u, frames.size());
}

TEST_F(DepthCameraTest, IsChosenByItsLabelOrWhereThereIsNoStereoCamera) {
  const RawDepthCamera camera = registeredCamera();
  const auto [left, right] = test::wall(1);
  {
    RawlogSink sink(path_, ImageStorage::kEmbedded);
    for (int i = 0; i < 3; ++i) {
      sink.write(*scan(i, camera));
      sink.writeStereo(test::frameTime(static_cast<std::size_t>(i)) + 0.01, left, right,
                       rawFrom(test::smallCamera()));
    }
  }
  EXPECT_FALSE(framesOf().at(0).stereo->right.empty());
  EXPECT_EQ((Counts{{"CObservation3DRangeScan", 3}}), skipped_);
  EXPECT_FALSE(framesOf("rgbd").at(0).stereo->disparity.empty());
  EXPECT_EQ((Counts{{"CObservationStereoImages", 3}}), skipped_);
  const auto two = [&] {
    (void)read({scan(0, camera, "a"), scan(0, camera, "b"), scan(1, camera, "a")});
  };
  EXPECT_THAT(test::errorOf(two), HasSubstr("several depth cameras; select one"));
  auto without = scan(0, camera);
  without->hasRangeImage = false;
  EXPECT_THAT(test::errorOf([&] { (void)read({without}); }), HasSubstr("nor images with depth"));
}

TEST_F(DepthCameraTest, ImpossibleCalibrationsAreRefusedWithAHint) {
  const auto errorWith = [&](auto change) {
    RawDepthCamera camera = registeredCamera();
    const cv::Mat depth = wallDepth(camera);
    auto one = depthObservation(mrpt::img::CImage(imageOf(camera, 0), mrpt::img::SHALLOW_COPY),
                                depth, camera);
    change(*one);
    one->timestamp = mrptTime(5.0);
    return test::errorOf([&] { (void)read({one}); });
  };
  EXPECT_THAT(errorWith([](auto& scan) { scan.cameraParamsIntensity.fx(0.0); }),
              HasSubstr("intensity image (cameraParamsIntensity)"));
  EXPECT_THAT(errorWith([](auto& scan) { scan.cameraParams.fy(-1.0); }),
              HasSubstr("depth image (cameraParams)"));
  EXPECT_THAT(errorWith([](auto& scan) { scan.cameraParams.ncols = 170; }),
              HasSubstr("is for 170x120 px, but has 160x120"));
  EXPECT_THAT(errorWith([](auto& scan) { scan.rangeUnits = 1.0F; }), HasSubstr("rangeUnits"));
  EXPECT_THAT(errorWith([](auto& scan) { scan.relativePoseIntensityWRTDepth = {}; }),
              HasSubstr("optical axes"));
  EXPECT_THAT(errorWith([](auto& scan) { scan.relativePoseIntensityWRTDepth.x(50.0); }),
              HasSubstr("in metres?"));
  EXPECT_EQ("no error", errorWith([](auto& scan) { scan.maxRange = 0.0F; }));
  EXPECT_EQ("no error", errorWith([](auto& scan) { scan.maxRange = NAN; }));
}

TEST_F(DepthCameraTest, IsReadLive) {
  const RawDepthCamera camera = registeredCamera();
  LiveSource source;
  for (int i = 0; i < 4; ++i) source.push(scan(i, camera));
  source.close();
  const auto live = source.next();
  ASSERT_TRUE(live);
  EXPECT_EQ(1.0, compareWithWall(*live->frame.stereo, 0.15));
  EXPECT_TRUE(source.camera()->isDepthCamera());
}

TEST_F(DepthCameraTest, ColourAndBoxesArePassedOn) {
  RawDepthCamera camera = registeredCamera();
  camera.color.distortion = camera.depth.distortion = {-0.2, 0.05, 0.0, 0.0, 0.0};
  {
    RawlogSink sink(path_, ImageStorage::kEmbeddedRaw);
    Detections boxes;
    boxes.time = test::frameTime(0);
    boxes.image_width = 160;
    boxes.image_height = 120;
    Detection box;
    box.object_class = ObjectClass::kPedestrian;
    box.score = 0.9;
    box.box2d = Box2d{10.0, 10.0, 40.0, 60.0};
    boxes.items.push_back(box);
    sink.writeDepth(test::frameTime(0), test::colourWall(0).left, wallDepth(camera), camera);
    sink.writeDetections("detections", boxes);
  }
  const auto frames = framesOf();
  ASSERT_EQ(1u, frames.size());
  EXPECT_EQ(CV_8UC3, frames[0].stereo->left_colour.type());
  EXPECT_EQ(CV_8UC1, frames[0].stereo->left.type());
  ASSERT_TRUE(frames[0].detections);
  EXPECT_LT(frames[0].detections->items.at(0).box2d->left, 9.0) << "rectified";
}

TEST_F(DepthCameraTest, ImagesMayBeStoredOutside) {
  const RawDepthCamera camera = registeredCamera();
  {
    RawlogSink sink(path_, ImageStorage::kExternalPng);
    sink.writeDepth(test::frameTime(0), imageOf(camera, 0), wallDepth(camera), camera);
  }
  EXPECT_TRUE(fs::exists(folder_ / "x_Images/rgbd_left_000000.png"));
  EXPECT_EQ(1.0, compareWithWall(*framesOf().at(0).stereo, 0.15));
}

}  // namespace
}  // namespace headway::io
