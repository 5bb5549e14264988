// SPDX-License-Identifier: BSD-3-Clause
#include "mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "actor_mesh.h"
#include "drawn_objects.h"
#include "house.h"
#include "mesh_projection.h"
#include "textures.h"

namespace headway::sim {
namespace {

Eigen::AlignedBox3f extentOf(const Mesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const auto& corner : boxCorners(mesh)) box.extend(corner);
  return box;
}

void expectUvInTheTexture(const Mesh& mesh) {
  for (const auto& triangle : mesh.triangles) {
    for (const auto& vertex : triangle) {
      EXPECT_GE(vertex.uv.minCoeff(), -1e-4F);
      EXPECT_LE(vertex.uv.maxCoeff(), 1.0F + 1e-4F);
      EXPECT_TRUE(vertex.position.allFinite());
    }
  }
}

Actor actorOf(ActorKind kind, int look = 0) {
  Random random(3);
  Actor actor;
  actor.kind = kind;
  actor.look = look;
  actor.size = drawSize(kind, random);
  return actor;
}

Mesh unitSquare() {
  Mesh mesh;
  mesh.addQuad({0, 0, 1}, {0, -1, 1}, {0, -1, 0}, {0, 0, 0}, UvRect{});
  return mesh;
}

StereoCamera camera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 120;
  camera.fx = camera.fy = 200.0;
  camera.cx = 159.5;
  camera.cy = 59.5;
  camera.baseline_m = 0.5;
  camera.T_robot_cam = robotFromOptical();
  return camera;
}

/// A square of side 2 m across the viewing direction, in the camera's frame.
Mesh wallAt(float depth) {
  Mesh mesh;
  mesh.addQuad({-1, -1, depth}, {1, -1, depth}, {1, 1, depth}, {-1, 1, depth}, UvRect{});
  return mesh;
}

TEST(UvRectTest, PartsAreWithinTheRectangle) {
  const UvRect rect{0.2F, 0.4F, 0.6F, 0.8F};
  const UvRect part = rect.part(0.5F, 0.0F, 1.0F, 0.25F);
  EXPECT_FLOAT_EQ(part.u0, 0.4F);
  EXPECT_FLOAT_EQ(part.v0, 0.4F);
  EXPECT_FLOAT_EQ(part.u1, 0.6F);
  EXPECT_FLOAT_EQ(part.v1, 0.5F);
}

TEST(MeshTest, AQuadIsTwoTrianglesThatShareItsDiagonal) {
  const Mesh mesh = unitSquare();
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_EQ(mesh.triangles[0][0].position, mesh.triangles[1][0].position);
  EXPECT_EQ(mesh.triangles[0][2].position, mesh.triangles[1][1].position);
  EXPECT_EQ(mesh.triangles[0][0].uv, Eigen::Vector2f(0, 0));
  EXPECT_EQ(mesh.triangles[1][2].uv, Eigen::Vector2f(0, 1));
}

TEST(MeshTest, TurnedOverTwiceIsTheSame) {
  const Mesh mesh = unitSquare(), twice = turnedOver(turnedOver(mesh));
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(twice.triangles[i][k].position, mesh.triangles[i][k].position);
    }
  }
}

TEST(MeshTest, MovedTurnsBeforeItShifts) {
  const Eigen::Matrix3f turn =
      Eigen::AngleAxisf(static_cast<float>(M_PI / 2), Eigen::Vector3f::UnitZ()).toRotationMatrix();
  const Mesh mesh = moved(unitSquare(), turn, {10, 0, 0});
  const auto box = extentOf(mesh);
  EXPECT_TRUE(box.isApprox(
      Eigen::AlignedBox3f(Eigen::Vector3f(10, 0, 0), Eigen::Vector3f(11, 0, 1)), 1e-5F));
}

TEST(MeshTest, AnEmptyMeshHasNoBox) { EXPECT_TRUE(boxCorners(Mesh()).empty()); }

TEST(VehicleMeshTest, FillsTheActorsSize) {
  for (const auto kind : {ActorKind::kCar, ActorKind::kVan, ActorKind::kTruck, ActorKind::kBus}) {
    for (int look = 0; look < 3; ++look) {
      const Actor actor = actorOf(kind, look);
      const Mesh mesh = vehicleMesh(actor);
      const auto box = extentOf(mesh);
      EXPECT_LT((box.sizes().cast<double>() - actor.size).cwiseAbs().maxCoeff(), 0.08);
      EXPECT_NEAR(box.min().z(), 0.0F, 0.03F) << "its wheels stand on the ground";
      expectUvInTheTexture(mesh);
    }
  }
}

TEST(VehicleShapeTest, OutlinesRunFromTheRearToTheFront) {
  for (const auto kind : {ActorKind::kCar, ActorKind::kVan, ActorKind::kTruck, ActorKind::kBus}) {
    for (int look = 0; look < 4; ++look) {
      const VehicleShape& shape = shapeOf(kind, look);
      ASSERT_GE(shape.outline.size(), 4u);
      EXPECT_EQ(shape.outline.front().x, 0.0);
      EXPECT_EQ(shape.outline.back().x, 1.0);
      double highest = 0.0;
      for (std::size_t i = 1; i < shape.outline.size(); ++i) {
        EXPECT_GE(shape.outline[i].x, shape.outline[i - 1].x);
        highest = std::max(highest, shape.outline[i].z);
      }
      EXPECT_EQ(highest, 1.0);
      EXPECT_LT(shape.rear_wheel, shape.front_wheel);
    }
  }
}

TEST(PersonMeshTest, StandsOnTheGroundAtAnyPhaseOfItsGait) {
  Actor person = actorOf(ActorKind::kPedestrian);
  person.speed = 1.4;
  for (double gait = 0.0; gait < 2.0 * M_PI; gait += 0.3) {
    person.gait = gait;
    const Mesh mesh = personMesh(person);
    const auto box = extentOf(mesh);
    EXPECT_NEAR(box.min().z(), 0.0F, 0.12F) << gait;
    EXPECT_LE(box.max().z(), person.size.z() + 0.02) << gait;
    EXPECT_GE(box.max().z(), 0.92 * person.size.z()) << "hips sink in a long step, " << gait;
    EXPECT_LT(box.sizes().x(), 1.3F) << gait;
    expectUvInTheTexture(mesh);
  }
}

TEST(PersonMeshTest, VariedBodiesAreOfAllHeightsAndStandOnTheGround) {
  Random random(5);
  double lowest = 3.0, highest = 0.0;
  int bent = 0, loaded = 0, wheelchairs = 0;
  for (int i = 0; i < 200; ++i) {
    Actor person = actorOf(i % 2 == 0 ? ActorKind::kPedestrian : ActorKind::kSeatedPerson);
    varyBody(random, person);
    const auto box = extentOf(actorMesh(person, Eigen::Vector3d::Zero()));
    const bool is_seated = person.kind == ActorKind::kSeatedPerson;
    EXPECT_NEAR(box.min().z(), 0.0F, is_seated ? 0.3F : 0.12F) << "all seats are of one height";
    EXPECT_LE(box.max().z(), std::max(1.0, person.size.z()) + 0.02);
    bent += person.body.bend_rad > 0.0 ? 1 : 0;
    loaded += person.body.load != PersonBody::Load::kNone ? 1 : 0;
    wheelchairs += person.body.wheelchair ? 1 : 0;
    if (person.kind != ActorKind::kPedestrian) continue;
    lowest = std::min(lowest, person.size.z());
    highest = std::max(highest, person.size.z());
  }
  EXPECT_LT(lowest, 1.2);
  EXPECT_GT(highest, 1.9);
  EXPECT_GT(bent, 5);
  EXPECT_GT(loaded, 10);
  EXPECT_GT(wheelchairs, 5);
}

TEST(PersonMeshTest, StepsLengthenWithSpeed) {
  Actor person = actorOf(ActorKind::kPedestrian);
  const auto longestStep = [&](double speed) {
    person.speed = speed;
    float longest = 0.0F;
    for (double gait = 0.0; gait < 2.0 * M_PI; gait += 0.2) {
      person.gait = gait;
      longest = std::max(longest, extentOf(personMesh(person)).sizes().x());
    }
    return longest;
  };
  EXPECT_GT(longestStep(1.5), longestStep(0.0) + 0.2F);
}

TEST(ActorMeshTest, IsPlacedWithItsHeading) {
  Actor car = actorOf(ActorKind::kCar);
  car.position << 105.0, 20.0, 1.0;
  car.yaw = M_PI / 2;
  const auto box = extentOf(actorMesh(car, {100.0, 20.0, 0.0}));
  EXPECT_NEAR(box.center().x(), 5.0, 0.05);
  EXPECT_NEAR(box.center().y(), 0.0, 0.05);
  EXPECT_NEAR(box.min().z(), 1.0, 0.03);
  EXPECT_NEAR(box.sizes().y(), car.size.x(), 0.08) << "its length lies along y";
  EXPECT_EQ(actorMeshes({car, car}, {0, 0, 0}).size(), 2u);
}

TEST(HouseMeshTest, StandsBesideItsFrontAndReachesItsRidge) {
  HousePlan plan;
  plan.facade.width_m = 12.0;
  plan.facade.side_m = 9.0;
  plan.facade.height_m = 8.0;
  for (const double ridge : {0.0, 3.0}) {
    plan.ridge_m = ridge;
    const Mesh mesh = houseMesh(plan, {0, 0, 0}, 0.0F);
    const auto box = extentOf(mesh);
    EXPECT_NEAR(box.max().z(), 8.0 + ridge, 0.6);
    EXPECT_GE(box.sizes().x(), 12.0F - 1e-3F);
    EXPECT_GE(box.max().y(), 9.0F - 1e-3F) << "the house lies to the left of its front";
    expectUvInTheTexture(mesh);
  }
}

TEST(ShadowTest, IsDarkInItsMiddleAndFadesToItsEdge) {
  const cv::Mat spot = drawShadow();
  ASSERT_EQ(spot.type(), CV_8UC4);
  const int middle = spot.rows / 2;
  EXPECT_GT(spot.at<cv::Vec4b>(middle, middle)[3], 150);
  EXPECT_LT(spot.at<cv::Vec4b>(middle, 0)[3], 10);
  EXPECT_EQ(spot.at<cv::Vec4b>(0, 0)[3], 0);
}

TEST(ShadowTest, LiesUnderItsActorAndIsWider) {
  Actor car = actorOf(ActorKind::kCar);
  car.position << 3.0, 4.0, 0.5;
  const auto box = extentOf(shadowMesh(car, {0, 0, 0}));
  EXPECT_NEAR(box.center().x(), 3.0, 1e-3);
  EXPECT_NEAR(box.center().y(), 4.0, 1e-3);
  EXPECT_GT(box.min().z(), 0.5F);
  EXPECT_GT(box.sizes().x(), car.size.x());
  EXPECT_GT(box.sizes().y(), car.size.y());
}

TEST(SkyTest, SurroundsTheCamera) {
  const auto box = extentOf(skyMesh(100.0F));
  EXPECT_NEAR(box.max().x(), 100.0F, 2.0F);
  EXPECT_NEAR(box.min().x(), -100.0F, 2.0F);
  EXPECT_NEAR(box.max().y(), 100.0F, 2.0F);
  EXPECT_NEAR(box.min().y(), -100.0F, 2.0F);
}

TEST(MeshProjectionTest, ProjectsCornersAndKeepsInverseDepth) {
  const auto triangles = projectMesh(wallAt(5.0F), Eigen::Isometry3f::Identity(), camera());
  ASSERT_EQ(triangles.size(), 2u);
  EXPECT_NEAR(triangles[0][0].x(), 159.5F - 40.0F, 1e-3F);
  EXPECT_NEAR(triangles[0][0].y(), 59.5F - 40.0F, 1e-3F);
  EXPECT_NEAR(triangles[0][0].z(), 0.2F, 1e-6F);
}

TEST(MeshProjectionTest, CutsAtTheNearPlane) {
  Mesh road;  // from behind the camera to 10 m ahead, 1 m below
  road.addQuad({-1, 1, 10}, {1, 1, 10}, {1, 1, -10}, {-1, 1, -10}, UvRect{});
  const auto triangles = projectMesh(road, Eigen::Isometry3f::Identity(), camera());
  ASSERT_GE(triangles.size(), 2u);
  for (const auto& triangle : triangles) {
    for (const auto& corner : triangle) {
      EXPECT_GT(corner.z(), 0.0F);
      EXPECT_LE(corner.z(), 1.0F / kNearPlane + 1e-4F);
    }
  }
  EXPECT_TRUE(projectMesh(wallAt(-2.0F), Eigen::Isometry3f::Identity(), camera()).empty());
}

TEST(MeshDepthTest, IsTheDepthOfTheNearestFaceAndNothingBeside) {
  MeshDepth depth({320, 120});
  Mesh body = wallAt(8.0F);
  body.append(wallAt(5.0F));
  const auto triangles = projectMesh(body, Eigen::Isometry3f::Identity(), camera());
  const cv::Mat picture = depth.draw(triangles, {100, 10, 120, 100});
  EXPECT_NEAR(picture.at<float>(50, 60), 5.0F, 1e-3F);
  EXPECT_EQ(picture.at<float>(50, 2), MeshDepth::kNothing);
}

TEST(MeshDepthTest, ATiltedFaceIsCorrectInPerspective) {
  Mesh road;
  road.addQuad({-50, 1, 40}, {50, 1, 40}, {50, 1, 2}, {-50, 1, 2}, UvRect{});
  MeshDepth depth({320, 120});
  const auto triangles = projectMesh(road, Eigen::Isometry3f::Identity(), camera());
  const cv::Mat picture = depth.draw(triangles, {0, 0, 320, 120});
  for (int v = 70; v < 118; v += 4) {
    EXPECT_NEAR(picture.at<float>(v, 160), 200.0 / (v - 59.5), 0.02 * 200.0 / (v - 59.5)) << v;
  }
}

TEST(CoveredRatioTest, OfACarAheadIsThatOfItsRear) {
  Actor car = actorOf(ActorKind::kCar);
  car.size << 4.0, 1.8, 1.5;
  car.position << 10.0, 0.0, -0.75;
  const double share = coveredRatio({car}, Pose::Identity(), camera());
  // Its rear at 8 m, a little less than a rectangle.
  const double rear = (200.0 / 8.0) * 1.8 * (200.0 / 8.0) * 1.5 / (320.0 * 120.0);
  EXPECT_LT(share, 1.1 * rear);
  EXPECT_GT(share, 0.6 * rear);
}

TEST(CoveredRatioTest, CountsOverlapOnceAndNothingBehind) {
  Actor car = actorOf(ActorKind::kCar);
  car.position << 12.0, 0.0, -1.0;
  const double one = coveredRatio({car}, Pose::Identity(), camera());
  EXPECT_EQ(coveredRatio({car, car}, Pose::Identity(), camera()), one);
  Actor behind = car;
  behind.position.x() = -12.0;
  EXPECT_EQ(coveredRatio({behind}, Pose::Identity(), camera()), 0.0);
  EXPECT_EQ(coveredRatio({}, Pose::Identity(), camera()), 0.0);
}

}  // namespace
}  // namespace headway::sim
