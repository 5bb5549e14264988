// SPDX-License-Identifier: BSD-3-Clause
#include "image_scale.h"

#include <gmock/gmock.h>
#include <headway/core/appearance.h>
#include <headway/pipeline/perception.h>
#include <headway_test/input_error.h>
#include <headway_test/textured_world.h>

namespace headway::pipeline {
namespace {

using ::testing::HasSubstr;

/// An odd size, so that both ratios differ from the scale and from each other.
StereoCamera oddCamera() {
  StereoCamera camera;
  camera.width = 641;
  camera.height = 363;
  camera.fx = camera.fy = 400.0;
  camera.cx = 325.0;
  camera.cy = 170.0;
  camera.baseline_m = 0.2;
  return camera;
}

Detection personIn(const Box2d& box) {
  Detection detection;
  detection.object_class = ObjectClass::kPedestrian;
  detection.box2d = box;
  return detection;
}

void expectNear(const Box2d& expected, const std::optional<Box2d>& box) {
  ASSERT_TRUE(box);
  EXPECT_NEAR(expected.left, box->left, 1e-9);
  EXPECT_NEAR(expected.top, box->top, 1e-9);
  EXPECT_NEAR(expected.right, box->right, 1e-9);
  EXPECT_NEAR(expected.bottom, box->bottom, 1e-9);
}

TEST(ImageScaleTest, ProjectionsByTheReducedCameraAreThoseOfTheReducedImage) {
  const auto given = std::make_shared<StereoCamera>(oddCamera());
  const ImageScale scale(given.get(), 0.5);
  const auto camera = scale.reduced(given);
  EXPECT_EQ(321, camera->width);
  EXPECT_EQ(182, camera->height);
  const Eigen::Vector3d point(0.7, -0.4, 3.0);
  const Eigen::Vector3d large = *project(point, *given), small = *project(point, *camera);
  // Of an image the left edge, -0.5, and the right one, width - 0.5, stay its edges.
  EXPECT_NEAR((large.x() + 0.5) / 641.0, (small.x() + 0.5) / 321.0, 1e-12);
  EXPECT_NEAR((large.y() + 0.5) / 363.0, (small.y() + 0.5) / 182.0, 1e-12);
  EXPECT_NEAR(3.0, triangulate(small, *camera)->z(), 1e-9);
}

TEST(ImageScaleTest, BoxesComeBackAsTheyWereGiven) {
  const StereoCamera given = oddCamera();
  const ImageScale scale(&given, 0.5);
  const Box2d box{12.0, 30.5, 99.25, 180.0};
  RecordedFrame frame;
  frame.detections = Detections();
  frame.detections->image_width = 641;
  frame.detections->items = {personIn(box)};
  const RecordedFrame inside = scale.reduced(frame);
  EXPECT_EQ(321, inside.detections->image_width);
  EXPECT_NEAR(0.5 * 87.25, inside.detections->items[0].box2d->width(), 0.1);
  const Detections back = scale.enlarged(*inside.detections);
  EXPECT_EQ(641, back.image_width);
  expectNear(box, back.items[0].box2d);
  Track track;
  track.box2d = inside.detections->items[0].box2d;
  expectNear(box, scale.enlarged(std::vector<Track>{track})[0].box2d);
}

TEST(ImageScaleTest, MasksCoverTheSamePartOfTheImage) {
  StereoCamera given = oddCamera();
  given.width = 640;
  given.height = 360;
  const ImageScale scale(&given, 0.5);
  auto mask = std::make_shared<ObjectMask>();
  mask->reduce = 4;
  mask->corner = {10, 20};
  mask->cells = cv::Mat::zeros(3, 5, CV_8U);
  mask->cells.at<uchar>(1, 4) = 1;
  RecordedFrame frame;
  frame.detections = Detections();
  frame.detections->items = {personIn({40, 80, 59, 91})};
  frame.detections->items[0].mask = mask;
  const auto inside = scale.reduced(frame).detections->items[0].mask;
  EXPECT_EQ(cv::Point(20, 40), inside->corner);
  EXPECT_EQ(cv::Size(10, 6), inside->cells.size());
  EXPECT_EQ(4, cv::countNonZero(inside->cells)) << "2 x 2 px are a cell of 4 x 4 px before";
  EXPECT_EQ(1, inside->cells.at<uchar>(2, 8));
}

TEST(ImageScaleTest, ADepthCameraKeepsItsDepthsButForEdges) {
  auto given = std::make_shared<StereoCamera>(oddCamera());
  given->width = 640;
  given->height = 360;
  given->depth_reach_m = 8.0;
  const ImageScale scale(given.get(), 0.5);
  RecordedFrame frame;
  frame.stereo.emplace();
  frame.stereo->left = cv::Mat(360, 640, CV_8U, cv::Scalar(90));
  cv::Mat& disparity = frame.stereo->disparity;
  disparity = cv::Mat(360, 640, CV_32F, cv::Scalar(20.0));
  disparity.colRange(0, 101) = 80.0F;          // its edge is within a pixel of the reduced image
  disparity.at<float>(200, 300) = 0.0F;        // a single hole is closed
  disparity(cv::Rect(400, 200, 2, 1)) = 0.0F;  // half of a pixel without depth is a hole
  const auto camera = scale.reduced(given);
  const StereoFrame inside = *scale.reduced(frame).stereo;
  EXPECT_EQ(cv::Size(320, 180), inside.left.size());
  const auto depthAt = [](const StereoCamera& of, float d) { return of.fx * of.baseline_m / d; };
  EXPECT_NEAR(depthAt(*given, 20.0F), depthAt(*camera, inside.disparity.at<float>(90, 160)), 1e-6);
  EXPECT_NEAR(depthAt(*given, 80.0F), depthAt(*camera, inside.disparity.at<float>(90, 49)), 1e-6);
  EXPECT_EQ(0.0F, inside.disparity.at<float>(90, 50));
  EXPECT_NEAR(20.0F, inside.disparity.at<float>(90, 51), 1e-4);
  EXPECT_NEAR(20.0F, inside.disparity.at<float>(100, 150), 1e-4);
  EXPECT_EQ(0.0F, inside.disparity.at<float>(100, 200));
}

/// A drive through a hall, with a box of a person where there is none.
class HalfTheSizeTest : public ::testing::Test {
 protected:
  HalfTheSizeTest() : hall_(test::smallCamera()) {
    hall_.addRoom(12.0, 8.0, 4.0);
    params_.slam.features = 250;
    params_.camera.scale = 0.5;
    params_.detection.detector = "recorded";
  }

  [[nodiscard]] RecordedFrame frameAt(std::size_t index) const {
    RecordedFrame frame;
    frame.index = index;
    frame.time = 0.1 * static_cast<double>(index);
    frame.stereo = hall_.frame(index, frame.time, truthAt(index));
    Detection detection = personIn(kBox);
    detection.box3d = Box3d{{0.0, 0.0, 4.0}, 0.6, 0.6, 1.7, 0.0};
    frame.detections = Detections();
    frame.detections->time = frame.time;
    frame.detections->T_robot_sensor = hall_.camera()->T_robot_cam;
    frame.detections->items = {detection};
    return frame;
  }

  static Pose truthAt(std::size_t index) {
    const auto step = static_cast<double>(index);
    Pose pose = Pose::Identity();
    pose.translation() << 0.05 * step, 0.3 * std::sin(0.05 * step), 0.0;
    pose.linear() = expSo3({0.0, 0.0, 0.4 * std::sin(0.1 * step)});
    return pose;
  }

  static constexpr Box2d kBox{100.0, 60.0, 140.0, 150.0};
  test::TexturedWorld hall_;
  PerceptionParams params_;
};

TEST_F(HalfTheSizeTest, EveryFrameIsTrackedAndResultsAreInPixelsOfTheInput) {
  Perception perception(hall_.camera(), params_);
  PerceptionUpdate update;
  for (std::size_t i = 0; i < 30; ++i) {
    update = perception.process(frameAt(i));
    EXPECT_EQ(slam::TrackingStatus::kTracked, update.camera.status) << i;
    EXPECT_LT((update.camera.T_map_robot.translation() - truthAt(i).translation()).norm(), 0.05);
  }
  EXPECT_EQ(hall_.camera()->width, perception.camera()->width);
  EXPECT_EQ(hall_.camera()->width, perception.stored().camera->width);
  ASSERT_EQ(1u, update.detections->items.size());
  expectNear(kBox, update.detections->items[0].box2d);
  ASSERT_EQ(1u, update.objects.tracks.size());
  expectNear(kBox, update.objects.tracks[0].box2d);
  expectNear(kBox, update.tracks_odom.at(0).box2d);
  expectNear(kBox, perception.map().movingObjects().tracks().at(0).box2d);
}

TEST_F(HalfTheSizeTest, FramesAreOfTheInputsSizeAndMapsOfOneScale) {
  Perception perception(hall_.camera(), params_);
  for (std::size_t i = 0; i < 5; ++i) (void)perception.process(frameAt(i));
  RecordedFrame small = frameAt(5);
  small.stereo->left = small.stereo->left.rowRange(0, small.stereo->left.rows / 2);
  EXPECT_THAT(test::inputErrorOf([&] { (void)perception.process(small); }),
              HasSubstr("must be 8-bit grey and"));
  auto stored = perception.stored();
  PerceptionParams whole = params_;
  whole.camera.scale = 1.0;
  Perception other(hall_.camera(), whole);
  EXPECT_THAT(test::inputErrorOf([&] { other.resume(stored); }), HasSubstr("another camera"));
  Perception same(hall_.camera(), params_);
  EXPECT_NO_THROW(same.resume(stored));
}

}  // namespace
}  // namespace headway::pipeline
