// SPDX-License-Identifier: BSD-3-Clause
#include "track_guided_detection.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "appearance.h"
#include "drive.h"

namespace headway::detect {
namespace {

constexpr int kGuidedReduce = 2;
constexpr double kWalkerDepth = 12.0;  // of the walker [m]
constexpr double kWalkerSpeed = 1.4;   // to the right [m/s]
constexpr double kGone = 0.3;          // since the walker was found last [s]
const cv::Size kGrid(620, 188);
const Eigen::Vector3d kStart(-2.0, 0.8, kWalkerDepth);  // where that was, middle of the segment

/// Image, on the grid, of a street with a walker whose middle is at a place.
struct Picture {
  cv::Mat image = cv::Mat(kGrid, CV_8U);
  cv::Rect walker;

  explicit Picture(const std::optional<Eigen::Vector3d>& place, const StereoCamera& camera) {
    fill(image, 1);
    if (!place) return;
    const auto pixel = *project(*place, camera);
    const int width = static_cast<int>(0.6 * camera.fx / place->z() / kGuidedReduce);
    const int height = static_cast<int>(1.6 * camera.fx / place->z() / kGuidedReduce);
    walker = {static_cast<int>(pixel.x() / kGuidedReduce) - width / 2,
              static_cast<int>(pixel.y() / kGuidedReduce) - height / 2, width, height};
    cv::Mat segment(walker.size(), CV_8U);
    fill(segment, 2);
    segment.copyTo(image(walker));
  }

  [[nodiscard]] std::vector<cv::Point> cells() const {
    std::vector<cv::Point> cells;
    for (int row = walker.y; row < walker.br().y; ++row) {
      for (int column = walker.x; column < walker.br().x; ++column) cells.emplace_back(column, row);
    }
    return cells;
  }

 private:
  static void fill(cv::Mat& part, unsigned seed) {
    std::mt19937 random(seed);
    for (int i = 0; i < static_cast<int>(part.total()); ++i) {
      part.data[i] = static_cast<unsigned char>(random() % 200 + 20);
    }
    cv::GaussianBlur(part, part, {5, 5}, 0.0);
  }
};

/// A walker detected some frames ago by a standing camera, and a frame that is searched for him.
struct GuidedScene {
  StereoCamera camera = test::testCamera();
  CameraPath path{camera, 0.5};
  stereo::DisparityImage disparity;
  std::optional<stereo::GroundPlane> ground = stereo::GroundPlane{{0.0, -1.0, 0.0}, 1.65};
  Eigen::Vector3d up{0.0, -1.0, 0.0};
  Picture now;
  ExpectedObject walker;

  /// @param place  of the walker now; nullopt: he is not to be seen
  explicit GuidedScene(const std::optional<Eigen::Vector3d>& place) : now(place, camera) {
    for (int i = 0; i < 4; ++i) path.advance(test::kFrameStep * i, Pose::Identity());
    disparity.reduce = kGuidedReduce;
    disparity.values = cv::Mat(kGrid, CV_32F, cv::Scalar(0));
    walker.track = TrackId{7};
    walker.object_class = ObjectClass::kPedestrian;
    walker.time = path.timeOf(path.newest()) - test::kFrameStep;
    walker.velocity.value = {kWalkerSpeed, 0.0, 0.0};
    walker.velocity.covariance = 0.04 * Eigen::Matrix3d::Identity();
    walker.position = kStart + (kGone - test::kFrameStep) * walker.velocity.value;
    walker.observations = 3;
    walker.last_observed = walker.last_motion = path.timeOf(path.newest()) - kGone;
    setTemplate();
  }

  void setTemplate() {
    const Picture then(kStart, camera);
    auto appearance = *templateOf(then.image, then.cells(), kGuidedReduce);
    appearance.time = walker.last_observed;
    appearance.box3d.centre = kStart;
    appearance.box3d.length = 0.7;
    appearance.box3d.width = 0.6;
    appearance.box3d.height = 1.6;
    appearance.box2d = {2.0 * then.walker.x, 2.0 * then.walker.y, 2.0 * then.walker.br().x,
                        2.0 * then.walker.br().y};
    appearance.surface = kStart;
    appearance.centre_covariance = 0.01 * Eigen::Matrix3d::Identity();
    appearance.support = 5;
    walker.appearance = std::make_shared<const AppearanceTemplate>(appearance);
  }

  [[nodiscard]] MotionFrame frame() const {
    return {path, now.image, disparity, ground, up, points_, classes_};
  }

  [[nodiscard]] std::vector<SearchedObject> searched() const {
    return searchedObjects({walker}, path, Pose::Identity());
  }
  [[nodiscard]] std::vector<MovingObject> byAppearance(
      std::vector<MovingObject> objects = {}) const {
    detectByAppearance(frame(), searched(), 0.0, camera, objects);
    return objects;
  }

 private:
  std::vector<PointTrack> points_;
  std::vector<PointClass> classes_;
};

Eigen::Vector3d wentOn() { return kStart + Eigen::Vector3d(kGone * kWalkerSpeed, 0.0, 0.0); }

TEST(TrackGuidedDetectionTest, WithoutDisparitiesTheTemplateIsFound) {
  const GuidedScene scene(wentOn());
  const auto objects = scene.byAppearance();
  ASSERT_EQ(objects.size(), 1u);
  const MovingObject& object = objects[0];
  EXPECT_EQ(object.searched_track, TrackId{7});
  EXPECT_EQ(object.group, -1);
  EXPECT_TRUE(object.evidence.appearance);
  EXPECT_FALSE(object.evidence.motion);
  EXPECT_EQ(object.points, 5);
  EXPECT_LT((object.extent.box.centre - wentOn()).norm(), 0.05);
  EXPECT_NEAR(object.extent.box2d.left, 2.0 * scene.now.walker.x, 3.0);
  EXPECT_NEAR(object.extent.box2d.right, 2.0 * scene.now.walker.br().x, 3.0);
  EXPECT_FALSE(object.extent.cells.empty()) << "they are masked for the camera's localisation";
  EXPECT_GT(object.extent.centre_covariance(2, 2), 0.01) << "his distance is only expected";
}

TEST(TrackGuidedDetectionTest, TheTemplateIsFoundBesideTheExpectedPlace) {
  const Eigen::Vector3d beside = wentOn() + Eigen::Vector3d(0.2, 0.0, 0.0);
  const auto objects = GuidedScene(beside).byAppearance();
  ASSERT_EQ(objects.size(), 1u);
  EXPECT_LT((objects[0].extent.box.centre - beside).norm(), 0.05);
}

TEST(TrackGuidedDetectionTest, AnObjectThatStoppedIsNotDetected) {
  EXPECT_TRUE(GuidedScene(kStart).byAppearance().empty());
}

TEST(TrackGuidedDetectionTest, AHiddenObjectIsNotDetected) {
  EXPECT_TRUE(GuidedScene(std::nullopt).byAppearance().empty());
}

TEST(TrackGuidedDetectionTest, ATemplateWhereStereoSeesSomethingFartherIsNotDetected) {
  for (const double depth_ratio : {0.7, 1.0, 1.3}) {
    GuidedScene scene(wentOn());
    const double d = project(depth_ratio * wentOn(), scene.camera)->z();
    for (const auto& cell : scene.now.cells()) {
      scene.disparity.values.at<float>(cell) = static_cast<float>(d);
    }
    EXPECT_EQ(scene.byAppearance().size(), depth_ratio > 1.0 ? 0u : 1u)
        << depth_ratio << ": what is nearer may hide a part of him";
  }
}

TEST(TrackGuidedDetectionTest, AnObjectObservedOnceIsNotSearchedByItsTemplate) {
  GuidedScene scene(wentOn());
  scene.walker.observations = 1;
  EXPECT_TRUE(scene.byAppearance().empty());
  scene.walker.observations = 2;
  EXPECT_EQ(scene.byAppearance().size(), 1u);
  scene.walker.appearance.reset();
  EXPECT_TRUE(scene.byAppearance().empty());
}

TEST(TrackGuidedDetectionTest, NothingIsDetectedTwice) {
  GuidedScene scene(wentOn());
  const auto first = scene.byAppearance();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(scene.byAppearance(first).size(), 1u);
}

TEST(TrackGuidedDetectionTest, SearchesForASecondAfterTheLastEvidenceOfMotion) {
  GuidedScene scene(wentOn());
  scene.walker.last_motion = scene.path.timeOf(scene.path.newest()) - 0.9;
  EXPECT_EQ(scene.searched().size(), 1u);
  scene.walker.last_motion -= 0.2;
  EXPECT_TRUE(scene.searched().empty());
}

TEST(TrackGuidedDetectionTest, ExpectedObjectsComeFromTheMapToThePathsWorld) {
  GuidedScene scene(wentOn());
  Pose T_map_cam = Pose::Identity();
  T_map_cam.linear() = expSo3({0.1, 0.5, -0.2});
  T_map_cam.translation() = Eigen::Vector3d(3.0, -1.0, 2.0);
  ExpectedObject in_map = scene.walker;
  in_map.position = T_map_cam * in_map.position;
  in_map.velocity = rotated(in_map.velocity, T_map_cam.linear());
  auto appearance = *in_map.appearance;
  appearance.T_map_camera = T_map_cam;
  in_map.appearance = std::make_shared<const AppearanceTemplate>(appearance);
  const auto searched = searchedObjects({in_map}, scene.path, T_map_cam);
  ASSERT_EQ(searched.size(), 1u);
  EXPECT_LT((searched[0].position - wentOn()).norm(), 1e-9);
  EXPECT_LT((searched[0].velocity.value - scene.walker.velocity.value).norm(), 1e-9);
  EXPECT_TRUE(searched[0].T_cam_then.isApprox(Pose::Identity(), 1e-9));
}

TEST(TrackGuidedDetectionTest, WhatMotionExplainsIsNotSearched) {
  GuidedScene scene(wentOn());
  MovingObject found;
  found.extent.box.centre = wentOn() + Eigen::Vector3d(0.5, 0.0, 0.0);
  EXPECT_TRUE(withoutFound(scene.searched(), {found}, scene.path).empty());
  found.extent.box.centre.x() += 2.0;
  EXPECT_EQ(withoutFound(scene.searched(), {found}, scene.path).size(), 1u);
  EXPECT_EQ(withoutFound(scene.searched(), {}, scene.path).size(), 1u);
}

TEST(TrackGuidedDetectionTest, WhatHasTheSamePartsIsNotSearchedThoughItsPlaceIsOff) {
  GuidedScene scene(wentOn());
  scene.walker.detector_id = 3;
  MovingObject found;
  found.extent.box.centre = wentOn() + Eigen::Vector3d(0.0, 0.0, 4.0);  // an error of stereo
  found.group = 3;
  EXPECT_TRUE(withoutFound(scene.searched(), {found}, scene.path).empty());
  found.group = 4;
  EXPECT_EQ(withoutFound(scene.searched(), {found}, scene.path).size(), 1u);
}

TEST(TrackGuidedDetectionTest, OneDetectionExplainsOneExpectedObject) {
  GuidedScene scene(wentOn());
  auto both = scene.searched();
  both.push_back(both.front());
  both.back().track = TrackId{8};
  both.back().position.x() += 0.3;
  MovingObject found;
  found.extent.box.centre = wentOn() + Eigen::Vector3d(0.3, 0.0, 0.0);
  const auto missing = withoutFound(both, {found}, scene.path);
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0].track, TrackId{7});
}

TEST(TrackGuidedDetectionTest, WhatIsBehindTheCameraIsNotDetected) {
  GuidedScene scene(wentOn());
  auto behind = *scene.walker.appearance;
  behind.T_map_camera.translation().z() = -kWalkerDepth - 5.0;
  scene.walker.appearance = std::make_shared<const AppearanceTemplate>(behind);
  EXPECT_TRUE(scene.byAppearance().empty());
}

}  // namespace
}  // namespace headway::detect
