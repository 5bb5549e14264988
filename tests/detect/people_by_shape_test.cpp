// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/detect/people_by_shape.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <vector>

#include "shape_patch.h"

namespace headway::detect {
namespace {

using Eigen::Vector3d;

constexpr double kRoomCamera = 0.6;
constexpr double kRoomEnd = 6.0;  // ahead [m]

/// A depth camera without noise, level above a floor before a wall, and what stands on the floor.
class Room {
 public:
  Room() {
    StereoCamera camera;
    camera.width = 640;
    camera.height = 480;
    camera.fx = camera.fy = 400.0;
    camera.cx = 320.0;
    camera.cy = 240.0;
    camera.baseline_m = 0.07;
    camera.depth_reach_m = 8.0;
    camera.T_robot_cam.translation().z() = kRoomCamera;
    camera_ = std::make_shared<StereoCamera>(camera);
  }

  /// @param middle  right, height and distance [m]
  void addEllipsoid(const Vector3d& middle, const Vector3d& half) {
    things_.push_back({inCamera(middle), half, false});
  }
  void addBox(const Vector3d& middle, const Vector3d& half) {
    things_.push_back({inCamera(middle), half, true});
  }
  void addPerson(double right, double ahead, double height) {
    const double k = height / 1.7;
    for (const double side : {-0.1, 0.1}) {
      addEllipsoid({right + side * k, 0.4 * k, ahead}, {0.08 * k, 0.48 * k, 0.08 * k});
      addEllipsoid({right + 2.3 * side * k, 1.1 * k, ahead}, {0.05 * k, 0.32 * k, 0.05 * k});
    }
    addEllipsoid({right, 1.1 * k, ahead}, {0.2 * k, 0.36 * k, 0.12 * k});
    addEllipsoid({right, 1.57 * k, ahead}, {0.08 * k, 0.13 * k, 0.1 * k});
  }

  [[nodiscard]] StereoFrame frame() const {
    StereoFrame frame;
    frame.camera = camera_;
    frame.left = cv::Mat(camera_->height, camera_->width, CV_8U, cv::Scalar(128));
    frame.disparity = cv::Mat(frame.left.size(), CV_32F);
    for (int row = 0; row < camera_->height; ++row) {
      for (int column = 0; column < camera_->width; ++column) {
        frame.disparity.at<float>(row, column) = static_cast<float>(
            camera_->fx * camera_->baseline_m / depthAt(ray({column, row}, *camera_)));
      }
    }
    return frame;
  }
  [[nodiscard]] const StereoCamera& camera() const { return *camera_; }

 private:
  struct Thing {
    Vector3d middle, half;
    bool is_box;
  };
  static Vector3d inCamera(const Vector3d& p) { return {p.x(), kRoomCamera - p.y(), p.z()}; }

  /// Depth along a ray of unit depth.
  [[nodiscard]] double depthAt(const Vector3d& ray) const {
    double nearest = ray.y() > 0.0 ? std::min(kRoomEnd, kRoomCamera / ray.y()) : kRoomEnd;
    for (const Thing& thing : things_) {
      const double depth = thing.is_box ? boxDepth(ray, thing) : ellipsoidDepth(ray, thing);
      if (depth > 0.0) nearest = std::min(nearest, depth);
    }
    return nearest;
  }
  static double ellipsoidDepth(const Vector3d& ray, const Thing& thing) {
    const Vector3d d = ray.cwiseQuotient(thing.half), c = thing.middle.cwiseQuotient(thing.half);
    const double b = d.dot(c), root = b * b - d.dot(d) * (c.dot(c) - 1.0);
    return root < 0.0 ? -1.0 : (b - std::sqrt(root)) / d.dot(d);
  }
  static double boxDepth(const Vector3d& ray, const Thing& thing) {
    double from = 0.0, to = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
      const double a = (thing.middle[i] - thing.half[i]) / ray[i];
      const double b = (thing.middle[i] + thing.half[i]) / ray[i];
      from = std::max(from, std::min(a, b));
      to = std::min(to, std::max(a, b));
    }
    return from < to ? from : -1.0;
  }

  std::shared_ptr<StereoCamera> camera_;
  std::vector<Thing> things_;
};

Detections peopleIn(const Room& room) {
  PeopleByShape people{ShapeParams()};
  return people.detect(room.frame());
}

TEST(ShapePatchTest, ShowsWhatStandsAtAPlace) {
  Room room;
  room.addBox({0.3, 0.5, 2.3}, {0.3, 0.5, 0.3});
  const stereo::FrameContext context(room.frame());
  ASSERT_TRUE(context.ground());
  const auto places = standingPlaces(context.disparity(), room.camera(), *context.ground(), 4.0);
  ASSERT_FALSE(places.empty());
  const Vector3d& place = places.front();
  EXPECT_NEAR(place.z(), 2.0, 0.1) << "its front";
  EXPECT_NEAR(place.y(), kRoomCamera, 0.03) << "on the floor";
  const Vector3d middle(0.3, kRoomCamera, 2.0);
  const cv::Mat patch = shapePatch(middle, context.disparity(), room.camera(), *context.ground());
  const auto at = [&](int channel, double right, double up) {
    const int column = kShapePatch.columns / 2 + cvFloor(right / kShapePatch.cell_m);
    const int row = kShapePatch.rows - 1 - cvFloor(up / kShapePatch.cell_m);
    return patch.at<unsigned char>(channel * kShapePatch.rows + row, column);
  };
  EXPECT_EQ(patch.rows * patch.cols, kShapePatch.values());
  EXPECT_GT(at(1, 0.04, 0.7), 250) << "the box";
  EXPECT_NEAR(at(0, 0.04, 0.7), 128, 12) << "at the place's depth";
  EXPECT_GT(at(3, 0.55, 0.7), 250) << "the wall beside it";
  EXPECT_GT(at(3, 0.04, 1.3), 250) << "and above it";
  EXPECT_GT(at(4, 0.04, 2.0), 250) << "what the image cuts";
  EXPECT_LT(at(2, 0.04, 0.7), 5);
}

TEST(ShapePatchTest, NothingStandsOnAnEmptyFloor) {
  const stereo::FrameContext context(Room().frame());
  ASSERT_TRUE(context.ground());
  EXPECT_TRUE(standingPlaces(context.disparity(), context.camera(), *context.ground(), 5.0).empty())
      << "the wall is farther";
}

TEST(PeopleByShapeTest, FindsOneWhoStands) {
  for (const double height : {1.55, 1.75, 1.9}) {
    Room room;
    room.addPerson(0.4, 3.0, height);
    const Detections found = peopleIn(room);
    ASSERT_EQ(found.items.size(), 1u) << height;
    const Detection& person = found.items[0];
    EXPECT_EQ(person.object_class, ObjectClass::kPedestrian);
    EXPECT_TRUE(person.evidence.classifier);
    EXPECT_FALSE(person.evidence.motion) << "says nothing of motion";
    EXPECT_FALSE(person.velocity);
    EXPECT_NEAR(person.box3d->centre.x(), 0.4, 0.15);
    EXPECT_NEAR(person.box3d->centre.z(), 3.0, 0.2);
    EXPECT_NEAR(person.box3d->height, height, 0.25);
    EXPECT_TRUE(isCovariance(*person.centre_covariance));
    const auto centre = *project(person.box3d->centre, room.camera());
    EXPECT_TRUE(person.box2d->contains(centre.x(), centre.y()));
  }
}

TEST(PeopleByShapeTest, FindsTwoSideBySide) {
  Room room;
  room.addPerson(-0.5, 2.5, 1.75);
  room.addPerson(0.5, 3.0, 1.65);
  EXPECT_EQ(peopleIn(room).items.size(), 2u);
}

TEST(PeopleByShapeTest, TakesNoFurnitureForPeople) {
  EXPECT_TRUE(peopleIn(Room()).items.empty());
  for (const Vector3d& half : {Vector3d(0.5, 0.9, 0.2), Vector3d(0.25, 0.5, 0.25),
                               Vector3d(0.04, 0.9, 0.04), Vector3d(0.8, 0.36, 0.4)}) {
    Room room;
    room.addBox({0.2, half.y(), 3.0}, half);
    EXPECT_TRUE(peopleIn(room).items.empty()) << half.transpose();
  }
}

TEST(PeopleByShapeTest, RefusesParametersOutOfRange) {
  ShapeParams params;
  params.min_score = 1.5;
  EXPECT_THROW(PeopleByShape{params}, InputError);
}

}  // namespace
}  // namespace headway::detect
