#include "mover_recognition.h"

#include <gtest/gtest.h>

#include <opencv2/imgproc.hpp>
#include <random>

#include "drive.h"

namespace headway::detect {
namespace {

constexpr int kReduce = 2;
constexpr double kDepth = 12.0;  // of the walker [m]
constexpr double kSpeed = 1.4;   // to the right [m/s]
constexpr double kGone = 0.3;    // since the walker was found last [s]
const cv::Size kGrid(620, 188);
const Eigen::Vector3d kStart(-2.0, 0.8, kDepth);  // where that was, middle of the body

/// Image, on the grid, of a street with a walker whose middle is at a place.
struct Picture {
  cv::Mat image = cv::Mat(kGrid, CV_8U);
  cv::Rect walker;

  explicit Picture(const std::optional<Eigen::Vector3d>& place, const StereoCamera& camera) {
    fill(image, 1);
    if (!place) return;
    const auto pixel = *project(*place, camera);
    const int width = static_cast<int>(0.6 * camera.fx / place->z() / kReduce);
    const int height = static_cast<int>(1.6 * camera.fx / place->z() / kReduce);
    walker = {static_cast<int>(pixel.x() / kReduce) - width / 2,
              static_cast<int>(pixel.y() / kReduce) - height / 2, width, height};
    cv::Mat body(walker.size(), CV_8U);
    fill(body, 2);
    body.copyTo(image(walker));
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

/// A walker found some frames ago by a camera that stands, and a frame in which he is sought.
struct Scene {
  StereoCamera camera = test::testCamera();
  CameraPath path{camera, 0.5};
  stereo::DisparityImage disparity;
  std::optional<stereo::GroundPlane> ground = stereo::GroundPlane{{0.0, -1.0, 0.0}, 1.65};
  Eigen::Vector3d up{0.0, -1.0, 0.0};
  Picture now;
  ObjectIdentity walker;
  std::vector<BlobTrack> bodies;

  /// @param place  of the walker now; nullopt: he is not to be seen
  explicit Scene(const std::optional<Eigen::Vector3d>& place) : now(place, camera) {
    for (int i = 0; i < 4; ++i) path.advance(test::kFrameStep * i, Pose::Identity());
    disparity.reduce = kReduce;
    disparity.values = cv::Mat(kGrid, CV_32F, cv::Scalar(0));
    walker.id = 7;
    walker.sightings = 3;
    walker.time = path.timeOf(path.newest()) - kGone;
    walker.moved_time = walker.time;
    walker.place = kStart;
    walker.velocity.value = {kSpeed, 0.0, 0.0};
    walker.velocity.covariance = 0.04 * Eigen::Matrix3d::Identity();
    const Picture then(kStart, camera);
    MoverLook look;
    look.appearance = *appearanceOf(then.image, then.cells());
    look.extent.box.centre = kStart;
    look.extent.box.length = 0.7;
    look.extent.box.width = 0.6;
    look.extent.box.height = 1.6;
    look.extent.box2d = {2.0 * then.walker.x, 2.0 * then.walker.y, 2.0 * then.walker.br().x,
                         2.0 * then.walker.br().y};
    look.extent.surface = kStart;
    look.extent.centre_covariance = 0.01 * Eigen::Matrix3d::Identity();
    look.extent.object_class = ObjectClass::kPedestrian;
    look.extent.cells = then.cells();
    look.time = walker.time;
    look.points = 5;
    walker.look = look;
  }

  /// Adds a body that was first seen in this frame.
  void addBody(const Eigen::Vector3d& place, double speed_to_the_right) {
    BlobTrack body;
    body.blob.uvd = *project(place, camera);
    for (const auto& cell : Picture(place, camera).cells()) {
      const double u = disparity.pixelOf(cell.x);
      const double v = disparity.pixelOf(cell.y);
      const Eigen::Vector3d point = *triangulate({u, v, body.blob.uvd.z()}, camera);
      body.blob.cells.push_back({cell, point});
      disparity.values.at<float>(cell) = static_cast<float>(body.blob.uvd.z());
    }
    body.blob.across = AcrossSpeed{speed_to_the_right, 0.1, test::kFrameStep};
    body.across.push_back(*body.blob.across);
    body.last_frame = path.newest();
    body.last_place = place;
    bodies.push_back(body);
  }

  [[nodiscard]] LookedAt looked() const {
    return {path, now.image, disparity, ground, up, points_, verdicts_};
  }

  [[nodiscard]] std::vector<Mover> byBody(std::vector<Mover> movers = {}) {
    recogniseBodies(looked(), {walker}, bodies, camera, movers);
    return movers;
  }
  [[nodiscard]] std::vector<Mover> byLook(std::vector<Mover> movers = {}) const {
    recogniseLooks(looked(), {walker}, camera, movers);
    return movers;
  }

 private:
  std::vector<PointTrack> points_;
  std::vector<PointVerdict> verdicts_;
};

Eigen::Vector3d wentOn() { return kStart + Eigen::Vector3d(kGone * kSpeed, 0.0, 0.0); }

TEST(MoverRecognitionTest, ABodyThatFlowsAsTheWalkerMustIsHim) {
  Scene scene(wentOn());
  scene.addBody(wentOn(), kSpeed);
  const auto movers = scene.byBody();
  ASSERT_EQ(movers.size(), 1u);
  EXPECT_EQ(movers[0].known_as, 7);
  EXPECT_EQ(movers[0].evidence, MoverEvidence::kFlow);
  ASSERT_EQ(movers[0].bodies.size(), 1u);
  EXPECT_EQ(movers[0].bodies[0], &scene.bodies[0]);
  EXPECT_LT((movers[0].extent.box.centre - wentOn()).head<1>().norm(), 0.3);
}

TEST(MoverRecognitionTest, ABodyThatFlowsOtherwiseOrStandsIsNotHim) {
  for (const double speed : {-kSpeed, 0.0, 4.0 * kSpeed}) {
    Scene scene(wentOn());
    scene.addBody(wentOn(), speed);
    EXPECT_TRUE(scene.byBody().empty()) << speed;
  }
}

TEST(MoverRecognitionTest, ABodyElsewhereIsNotHim) {
  Scene scene(wentOn());
  scene.addBody(wentOn() + Eigen::Vector3d(2.0, 0.0, 0.0), kSpeed);
  EXPECT_TRUE(scene.byBody().empty());
}

TEST(MoverRecognitionTest, OfTwoBodiesTheNearerIsHim) {
  Scene scene(wentOn());
  scene.addBody(wentOn() + Eigen::Vector3d(0.9, 0.0, 0.0), kSpeed);
  scene.addBody(wentOn() + Eigen::Vector3d(-0.2, 0.0, 0.0), kSpeed);
  const auto movers = scene.byBody();
  ASSERT_EQ(movers.size(), 1u);
  EXPECT_EQ(movers[0].bodies[0], &scene.bodies[1]);
}

TEST(MoverRecognitionTest, WithoutStereoHeIsKnownByHisLook) {
  const Scene scene(wentOn());
  const auto movers = scene.byLook();
  ASSERT_EQ(movers.size(), 1u);
  const Mover& mover = movers[0];
  EXPECT_EQ(mover.known_as, 7);
  EXPECT_EQ(mover.evidence, MoverEvidence::kLook);
  EXPECT_EQ(mover.points, 5);
  EXPECT_LT((mover.extent.box.centre - wentOn()).norm(), 0.05);
  EXPECT_NEAR(mover.extent.box2d.left, 2.0 * scene.now.walker.x, 3.0);
  EXPECT_NEAR(mover.extent.box2d.right, 2.0 * scene.now.walker.br().x, 3.0);
  EXPECT_FALSE(mover.extent.cells.empty()) << "they are masked for the camera's localisation";
  EXPECT_GT(mover.extent.centre_covariance(2, 2), 0.01) << "his distance is only expected";
}

TEST(MoverRecognitionTest, HeIsFoundBesideTheExpectedPlaceToo) {
  const Eigen::Vector3d beside = wentOn() + Eigen::Vector3d(0.2, 0.0, 0.0);
  const auto movers = Scene(beside).byLook();
  ASSERT_EQ(movers.size(), 1u);
  EXPECT_LT((movers[0].extent.box.centre - beside).norm(), 0.05);
}

TEST(MoverRecognitionTest, WhoStoppedIsNotReportedAsMoving) {
  EXPECT_TRUE(Scene(kStart).byLook().empty());
}

TEST(MoverRecognitionTest, WhoIsHiddenIsNotFound) {
  EXPECT_TRUE(Scene(std::nullopt).byLook().empty());
}

TEST(MoverRecognitionTest, WhatWasFoundOnceIsNotSoughtByItsLook) {
  Scene scene(wentOn());
  scene.walker.sightings = 1;
  EXPECT_TRUE(scene.byLook().empty());
  scene.walker.sightings = 2;
  EXPECT_EQ(scene.byLook().size(), 1u);
  scene.walker.look.reset();
  EXPECT_TRUE(scene.byLook().empty());
}

TEST(MoverRecognitionTest, WhatIsThereAlreadyIsNotReportedTwice) {
  Scene scene(wentOn());
  const auto first = scene.byLook();
  ASSERT_EQ(first.size(), 1u);
  EXPECT_EQ(scene.byLook(first).size(), 1u);
  scene.addBody(wentOn(), kSpeed);
  EXPECT_EQ(scene.byBody(first).size(), 1u);
}

}  // namespace
}  // namespace headway::detect
