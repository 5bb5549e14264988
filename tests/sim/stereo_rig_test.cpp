// SPDX-License-Identifier: BSD-3-Clause
// Geometry of drawn stereo pairs: known points appear where the camera model says.
#include "stereo_rig.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "drawn_objects.h"

namespace headway::sim {
namespace {

const cv::Scalar kRed(0, 0, 255), kGreen(0, 255, 0), kBlue(255, 0, 0);

/// Plain coloured meshes in the world, and nothing else.
class PaintedScene : public Scene {
 public:
  void add(const Mesh& mesh, const cv::Scalar& colour) {
    auto object = std::make_shared<TexturedObject>(cv::Mat(8, 8, CV_8UC3, colour));
    object->setMesh(mesh);
    scene_.insert(object);
    objects_.push_back(object);
    scene_.getViewport()->setViewportClipDistances(0.3F, kFarPlane);
  }
  void arrange(const Pose& T_world_robot, const Pose& /*T_left_right*/,
               const std::vector<Actor>& /*actors*/, const std::vector<Mesh>& /*meshes*/) override {
    T_origin_robot_ = T_world_robot;
    T_origin_robot_.translation().setZero();
    double order = 100.0;
    for (const auto& object : objects_) {
      object->placeAt(-T_world_robot.translation(), T_origin_robot_.linear().col(0), order -= 1.0);
    }
  }

 private:
  std::vector<TexturedObject::Ptr> objects_;
};

StereoCamera testCamera(double pitch_down_deg = 0.0) {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 200;
  camera.fx = camera.fy = 250.0;
  camera.cx = 150.0;  // not in the middle
  camera.cy = 110.0;
  camera.baseline_m = 0.3;
  const Eigen::AngleAxisd down(pitch_down_deg * M_PI / 180.0, Eigen::Vector3d::UnitY());
  camera.T_robot_cam = down * robotFromOptical();
  camera.T_robot_cam.translation() = Eigen::Vector3d(0.2, 0.15, 1.2);
  return camera;
}

Pose rightCamera(const StereoCamera& camera) {
  Pose T_left_right = Pose::Identity();
  T_left_right.translation().x() = camera.baseline_m;
  return T_left_right;
}

/// An upright square that faces -x.
Mesh square(const Eigen::Vector3d& middle, double side) {
  const Eigen::Vector3f m = middle.cast<float>();
  const auto half = static_cast<float>(0.5 * side);
  Mesh mesh;
  mesh.addQuad(m + Eigen::Vector3f(0, half, half), m + Eigen::Vector3f(0, -half, half),
               m + Eigen::Vector3f(0, -half, -half), m + Eigen::Vector3f(0, half, -half), UvRect{});
  return mesh;
}

/// Centre of mass of what has a colour; its area is the number of pixels [px].
struct ImageSpot {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double area = 0.0;
};

ImageSpot spotOf(const cv::Mat& picture, const cv::Scalar& colour) {
  cv::Mat marks;
  cv::inRange(picture, colour - cv::Scalar::all(60), colour + cv::Scalar::all(60), marks);
  const cv::Moments moments = cv::moments(marks, true);
  return {{moments.m10 / moments.m00, moments.m01 / moments.m00}, moments.m00};
}

class StereoRigTest : public ::testing::TestWithParam<double> {
 protected:
  StereoCamera camera = testCamera(GetParam());
  std::unique_ptr<PaintedScene> scene = std::make_unique<PaintedScene>();

  [[nodiscard]] StereoDrawing draw(const Pose& T_world_robot, const Pose& T_left_right) {
    StereoRig rig(camera, std::move(scene));
    return rig.draw(T_world_robot, T_left_right, {}, {}, true);
  }
};

TEST_P(StereoRigTest, KnownPointsProjectWhereTheCameraModelSaysInBothImages) {
  const std::array<cv::Scalar, 3> colours = {kRed, kGreen, kBlue};
  std::array<Eigen::Vector3d, 3> in_world;
  const Eigen::Vector3d start(1000.0, -500.0, 3.0);  // far from the origin
  for (std::size_t i = 0; i < 3; ++i) {
    const auto k = static_cast<double>(i);
    in_world[i] = start + Eigen::Vector3d(6.0 + 1.5 * k, 1.0 - 1.1 * k, 0.4 + 0.3 * k);
    scene->add(square(in_world[i], 0.2), colours[i]);
  }
  StereoRig rig(camera, std::move(scene));
  // A square's edges are drawn to whole pixels, which averages out over many views.
  Eigen::Vector2d left_mean = Eigen::Vector2d::Zero(), right_mean = left_mean;
  constexpr int kViews = 20;
  for (int view = 0; view < kViews; ++view) {
    Pose T_world_robot = Pose::Identity();
    T_world_robot.translation() = start + Eigen::Vector3d(0.061 * view, 0.043 * view, 0.0);
    T_world_robot.linear() = expSo3({0.0, 0.0, 0.007 * view - 0.07});
    const auto drawing = rig.draw(T_world_robot, rightCamera(camera), {}, {}, true);
    for (std::size_t i = 0; i < 3; ++i) {
      const Eigen::Vector3d in_cam =
          camera.T_robot_cam.inverse() * (T_world_robot.inverse() * in_world[i]);
      const Eigen::Vector3d uvd = *project(in_cam, camera);
      const Eigen::Vector2d left = spotOf(drawing.left, colours[i]).centre - uvd.head<2>();
      const Eigen::Vector2d right =
          spotOf(drawing.right, colours[i]).centre - uvd.head<2>() + Eigen::Vector2d(uvd.z(), 0.0);
      EXPECT_LT(left.norm(), 1.0);
      EXPECT_LT(right.norm(), 1.0);
      left_mean += left / (3.0 * kViews);
      right_mean += right / (3.0 * kViews);
      const cv::Point pixel(cvRound(uvd.x()), cvRound(uvd.y()));
      EXPECT_NEAR(drawing.depth.at<float>(pixel), in_cam.z(), 0.01 * in_cam.z());
    }
  }
  EXPECT_LT(left_mean.norm(), 0.12) << left_mean.transpose();
  EXPECT_LT(right_mean.norm(), 0.12) << right_mean.transpose();
}

TEST_P(StereoRigTest, DepthIsThatOfEachPixelsRayOnAFloor) {
  Mesh floor;
  floor.addQuad({-5, 50, 0}, {100, 50, 0}, {100, -50, 0}, {-5, -50, 0}, UvRect{});
  scene->add(floor, kGreen);
  const StereoDrawing drawing = draw(Pose::Identity(), rightCamera(camera));
  int judged = 0;
  for (int v = 0; v < camera.height; v += 3) {
    for (int u = 0; u < camera.width; u += 3) {
      const Eigen::Vector3d way = camera.T_robot_cam.linear() * ray(Eigen::Vector2d(u, v), camera);
      const double z = -camera.T_robot_cam.translation().z() / way.z();
      if (way.z() > -0.02 || z > 60.0) {
        if (way.z() > 0.01) {
          EXPECT_EQ(drawing.depth.at<float>(v, u), 0.0F) << "only sky";
        }
        continue;
      }
      EXPECT_NEAR(drawing.depth.at<float>(v, u), z, 1e-3 * z) << u << ' ' << v;
      ++judged;
    }
  }
  EXPECT_GT(judged, 2000);
}

TEST_P(StereoRigTest, WhatIsNearerHidesWhatIsBehind) {
  const Eigen::Vector3d viewpoint = camera.T_robot_cam.translation();
  const Eigen::Vector3d ahead = camera.T_robot_cam.linear().col(2);
  scene->add(square(viewpoint + 5.0 * ahead, 0.8), kRed);
  scene->add(square(viewpoint + 8.0 * ahead, 0.8), kBlue);
  const StereoDrawing drawing = draw(Pose::Identity(), rightCamera(camera));
  const auto pixel = drawing.left.at<cv::Vec3b>(110, 150);
  EXPECT_GT(pixel[2], 200);
  EXPECT_LT(pixel[0], 50);
  EXPECT_NEAR(drawing.depth.at<float>(110, 150), 5.0, 0.02);
}

TEST_P(StereoRigTest, ATurnedRightCameraSeesTheSameDirectionElsewhere) {
  const Eigen::Vector3d in_cam(0.4, -0.2, 7.0);
  scene->add(square(camera.T_robot_cam * in_cam, 0.15), kRed);
  Pose T_left_right = rightCamera(camera);
  T_left_right.linear() = expSo3({0.02, -0.03, 0.05});
  const StereoDrawing drawing = draw(Pose::Identity(), T_left_right);
  const Eigen::Vector3d in_right = T_left_right.inverse() * in_cam;
  const auto uvd = project(in_right, camera);
  ASSERT_TRUE(uvd);
  EXPECT_LT((spotOf(drawing.right, kRed).centre - uvd->head<2>()).norm(), 0.35);
}

INSTANTIATE_TEST_SUITE_P(Pitch, StereoRigTest, ::testing::Values(0.0, 10.0));

TEST(StereoRigSizeTest, AnyWidthIsDrawnWhole) {
  for (const int width : {317, 318, 319, 320}) {
    StereoCamera camera = testCamera();
    camera.width = width;
    auto scene = std::make_unique<PaintedScene>();
    const Eigen::Vector3d corner =
        camera.T_robot_cam * (5.0 * ray(Eigen::Vector2d(width - 4, 4), camera));
    scene->add(square(corner, 0.09), kRed);  // 4.5 px: five pixels' centres
    StereoRig rig(camera, std::move(scene));
    const auto drawing = rig.draw(Pose::Identity(), rightCamera(camera), {}, {}, false);
    EXPECT_EQ(drawing.left.size(), cv::Size(width, 200));
    EXPECT_EQ(drawing.right.size(), cv::Size(width, 200));
    EXPECT_TRUE(drawing.depth.empty());
    EXPECT_LT((spotOf(drawing.left, kRed).centre - Eigen::Vector2d(width - 4, 4)).norm(), 0.4);
  }
}

}  // namespace
}  // namespace headway::sim
