// SPDX-License-Identifier: BSD-3-Clause
// A world in motion whose robot is driven from outside, by what it sees.
#include <headway/core/pose.h>
#include <headway/sim/driven_world.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "environment.h"
#include "frame_drawer.h"
#include "robot.h"
#include "robot_sensors.h"

namespace headway::sim {
namespace {

using Eigen::Vector2d;

constexpr std::uint64_t kWheelsSeed = 510;  // beside those of a site
constexpr double kHalfShoulders_m = 0.25;   // of people seen from above

std::array<Vector2d, 4> cornersOf(const Footprint& box) {
  const Vector2d x = 0.5 * box.size.x() * Vector2d(std::cos(box.yaw), std::sin(box.yaw));
  const Vector2d y = 0.5 * box.size.y() * Vector2d(-std::sin(box.yaw), std::cos(box.yaw));
  return {box.centre + x + y, box.centre - x + y, box.centre - x - y, box.centre + x - y};
}

/// Distance of a point to a rectangle; 0 inside of it [m].
double distanceTo(const Footprint& box, const Vector2d& point) {
  const Vector2d local = Eigen::Rotation2Dd(-box.yaw) * (point - box.centre);
  return (local.cwiseAbs() - 0.5 * box.size).cwiseMax(0.0).norm();
}

/// Whom the robot meets is arranged on its course: nobody else seeks it, and they are fewer.
SimParams withoutPursuit(SimParams params) {
  params.traffic.encounter_ratio = 0.0;
  params.traffic.pedestrians = (params.traffic.pedestrians + 1) / 2;
  return params;
}

/// Whether a side of `a` separates both.
bool separates(const Footprint& a, const std::array<Vector2d, 4>& b) {
  Eigen::AlignedBox2d bounds;
  for (const Vector2d& corner : b) {
    bounds.extend(Vector2d(Eigen::Rotation2Dd(-a.yaw) * (corner - a.centre)));
  }
  return !bounds.intersects(Eigen::AlignedBox2d(-0.5 * a.size, 0.5 * a.size));
}

}  // namespace

double gapBetween(const Footprint& a, const Footprint& b) {
  const auto corners_a = cornersOf(a), corners_b = cornersOf(b);
  if (!separates(a, corners_b) && !separates(b, corners_a)) return 0.0;
  // Of two rectangles apart, a corner is one of the two nearest points.
  double gap = std::numeric_limits<double>::infinity();
  for (const Vector2d& corner : corners_b) gap = std::min(gap, distanceTo(a, corner));
  for (const Vector2d& corner : corners_a) gap = std::min(gap, distanceTo(b, corner));
  return gap;
}

class DrivenWorld::Impl {
 public:
  Impl(const SimParams& params, const Vector2d& robot_size)
      : drawer_(params),
        environment_(
            makeEnvironment(withoutPursuit(params), drawer_.lens().ideal(), Driver::kCaller)),
        robot_(*environment_->drivenRobot()),
        robot_size_(robot_size),
        wheels_(seedOf({static_cast<std::uint64_t>(params.world.seed), kWheelsSeed}),
                params.camera.wheel_slip_ratio),
        start_time_s_(params.recording.start_time_s),
        view_distance_m_(params.world.view_distance_m) {
    const Pose start = robot_.T_world_robot();
    wheels_.observe(now(), start);
    start_ = start.translation().head<2>();
    start_yaw_ = yawOf(start);
    for (const Footprint& thing : environment_->things()) things_.push_back(inMap(thing));
    const Path& way = *robot_.course();
    for (double s = 0.0; s < way.length(); s += 1.0) course_.push_back(inMap(placeOf(way, s)));
    course_.push_back(inMap(placeOf(way, way.length())));
  }

  void advance(double dt, const DriveCommand& command) {
    const double before = gapToThings(robot());
    robot_.steer(command);
    environment_->advance(dt);
    now_s_ += dt;
    const double after = gapToThings(robot());
    bumped_ = after <= 0.0 && after <= before;
    if (bumped_) robot_.undoStep();
    wheels_.observe(now(), robot_.T_world_robot());
  }

  SimFrame look() {
    auto drawn = drawer_.draw(*environment_, ++frames_, [this](double) { return now(); });
    drawn.frame.index = frames_ - 1;
    drawn.frame.odometry = wheels_.odometry();
    (void)wheels_.takeImu();  // not carried by this robot
    return drawer_.finish(std::move(drawn));
  }

  [[nodiscard]] DrivenRobot robot() const {
    const Pose pose = robot_.T_world_robot();
    return {inMap(Vector2d(pose.translation().head<2>())), wrapAngle(yawOf(pose) - start_yaw_),
            robot_.motion(), bumped_};
  }

  [[nodiscard]] std::vector<Mover> movers() {
    std::vector<Mover> movers;
    for (const Actor& actor : environment_->actors(view_distance_m_)) {
      if (actor.parked) continue;
      Mover& mover = movers.emplace_back();
      mover.id = actor.id;
      mover.object_class = classOf(actor.kind);
      mover.shape = inMap(Footprint{actor.position.head<2>(), actor.size.head<2>(), actor.yaw});
      if (isPerson(actor.kind)) {
        mover.shape.size.setZero();
        mover.radius_m = kHalfShoulders_m;
      }
      mover.parts = partsOf(actor.kind, mover.shape);
      mover.height_m = actor.size.z();
      mover.velocity = Eigen::Rotation2Dd(-start_yaw_) * actor.velocity;
    }
    return movers;
  }

  [[nodiscard]] Time now() const { return start_time_s_ + now_s_; }
  [[nodiscard]] const std::vector<Vector2d>& course() const { return course_; }
  [[nodiscard]] const std::vector<Footprint>& things() const { return things_; }
  [[nodiscard]] const Lens& lens() const { return drawer_.lens(); }

 private:
  static Vector2d placeOf(const Path& way, double s) { return way.at(s).position.head<2>(); }
  [[nodiscard]] Vector2d inMap(const Vector2d& world) const {
    return Eigen::Rotation2Dd(-start_yaw_) * (world - start_);
  }
  [[nodiscard]] Footprint inMap(const Footprint& world) const {
    return {inMap(world.centre), world.size, wrapAngle(world.yaw - start_yaw_)};
  }
  [[nodiscard]] double gapToThings(const DrivenRobot& robot) const {
    const Footprint footprint{robot.position, robot_size_, robot.yaw};
    double gap = std::numeric_limits<double>::infinity();
    for (const Footprint& thing : things_) {
      const double reach = 0.5 * (thing.size.norm() + robot_size_.norm());
      if ((thing.centre - robot.position).norm() > reach) continue;
      gap = std::min(gap, gapBetween(footprint, thing));
    }
    return gap;
  }

  FrameDrawer drawer_;
  std::unique_ptr<Environment> environment_;
  WheeledRobot& robot_;
  Vector2d robot_size_;
  MotionSensors wheels_;
  double start_time_s_, view_distance_m_;
  Vector2d start_;          ///< world [m]
  double start_yaw_ = 0.0;  ///< [rad]
  std::vector<Footprint> things_;
  std::vector<Vector2d> course_;
  double now_s_ = 0.0;
  std::size_t frames_ = 0;
  bool bumped_ = false;
};

DrivenWorld::DrivenWorld(const SimParams& params, const Vector2d& robot_size) {
  params.validate();
  impl_ = std::make_unique<Impl>(params, robot_size);
}

DrivenWorld::~DrivenWorld() = default;

void DrivenWorld::advance(double dt, const DriveCommand& command) { impl_->advance(dt, command); }

SimFrame DrivenWorld::look() { return impl_->look(); }

DrivenRobot DrivenWorld::robot() const { return impl_->robot(); }

const std::vector<Vector2d>& DrivenWorld::course() const { return impl_->course(); }

std::vector<Mover> DrivenWorld::movers() const { return impl_->movers(); }

const std::vector<Footprint>& DrivenWorld::things() const { return impl_->things(); }

Time DrivenWorld::now() const { return impl_->now(); }

const StereoCamera& DrivenWorld::camera() const { return impl_->lens().ideal(); }

io::RawStereoCamera DrivenWorld::recordedCamera() const { return impl_->lens().recorded(); }

}  // namespace headway::sim
