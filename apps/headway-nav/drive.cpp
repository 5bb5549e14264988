// SPDX-License-Identifier: BSD-3-Clause
// A drive: a robot in a simulated world finds its way by what it perceives there.
#include "drive.h"

#include <headway/map/track_geometry.h>
#include <mrpt/kinematics/CVehicleVelCmd_DiffDriven.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "guide.h"
#include "manoeuvre.h"
#include "trial_pictures.h"

namespace headway::app {
namespace {

using Eigen::Vector2d;
using mrpt::kinematics::CVehicleVelCmd;
using mrpt::kinematics::CVehicleVelCmd_DiffDriven;
using mrpt::maps::CSimplePointsMap;
using mrpt::math::TPose2D;
using mrpt::nav::CAbstractNavigator;

constexpr double kLongestStep_s = 0.02;  // of the world: a walker moves 3 cm in it
constexpr float kPointHeight_m = 0.4F;   // of the obstacle points, within the robot's height

/// Of a robot that is stopped by what it does not see.
struct Touch {
  double commanded_mps = 0.1;  ///< at least, and it moves by no more than a tenth of that
  double after_s = 0.4;        ///< it has had the time to start
  double remembered_s = 20.0;
  double depth_m = 0.3;  ///< of what is assumed to be there
  double spacing_m = 0.1;
};
constexpr Touch kTouch;

/// The robot's base: what its navigator asks and commands.
class DrivenBase : public Silent<mrpt::nav::CRobot2NavInterface> {
 public:
  DrivenBase(const RobotParams& params, double outline_spacing_m)
      : params_(params), outline_spacing_m_(outline_spacing_m) {}

  /// What is known from now on. Wheels measure how it moves.
  void know(Knowledge knowledge, const sim::DriveCommand& motion) {
    knowledge_ = std::move(knowledge);
    motion_ = motion;
  }
  /// Where something unseen stopped it, map frame.
  void feel(std::vector<Vector2d> places) { felt_ = std::move(places); }
  /// Takes the pose by odometry for known, of a robot that is lost and turns to see.
  void trustOdometry() { knowledge_.pose = knowledge_.expected; }
  void distrustOdometry() { knowledge_.pose.reset(); }
  [[nodiscard]] const Knowledge& knowledge() const { return knowledge_; }
  [[nodiscard]] const sim::DriveCommand& command() const { return command_; }

  bool getCurrentPoseAndSpeeds(TPose2D& pose, mrpt::math::TTwist2D& velocity,
                               mrpt::system::TTimeStamp& timestamp, TPose2D& odometry,
                               std::string& frame_id) override {
    if (!knowledge_.pose) return false;
    pose = odometry = *knowledge_.pose;
    velocity = {motion_.speed * std::cos(pose.phi), motion_.speed * std::sin(pose.phi),
                motion_.turn_rate};
    timestamp = mrpt::Clock::now();
    frame_id = "map";
    return true;
  }
  /// Everybody who is tracked, where they are now.
  bool senseObstacles(CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& timestamp) override;

  bool changeSpeeds(const CVehicleVelCmd& command) override {
    const auto& wheels = dynamic_cast<const CVehicleVelCmd_DiffDriven&>(command);
    command_ = {wheels.lin_vel, wheels.ang_vel};
    return true;
  }
  bool changeSpeedsNOP() override { return true; }
  bool stop(bool /*is_emergency*/) override {
    command_ = {};
    return true;
  }
  CVehicleVelCmd::Ptr getStopCmd() override {
    return std::make_shared<CVehicleVelCmd_DiffDriven>();
  }
  CVehicleVelCmd::Ptr getEmergencyStopCmd() override { return getStopCmd(); }

  // MRPT's own are of the machine's clock.
  double getNavigationTime() override { return mrpt::Clock::nowDouble() - navigates_since_s_; }
  void resetNavigationTimer() override { navigates_since_s_ = mrpt::Clock::nowDouble(); }

 private:
  void add(const Vector2d& place, CSimplePointsMap& obstacles) const;

  RobotParams params_;
  double outline_spacing_m_;
  Knowledge knowledge_;
  sim::DriveCommand motion_, command_;
  std::vector<Vector2d> felt_;
  double navigates_since_s_ = 0.0;
};

bool DrivenBase::senseObstacles(CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& timestamp) {
  obstacles.clear();
  timestamp = mrpt::Clock::now();
  if (!knowledge_.pose) return false;
  std::vector<Vector2d> outline;
  for (const Track& track : knowledge_.map.movingObjects().tracks()) {
    if (!isShown(track)) continue;
    nav::appendOutline(map::footprintOf(track), track.position.head<2>(), track.yaw, {},
                       outline_spacing_m_, outline);
  }
  for (const Vector2d& place : outline) add(place, obstacles);
  for (const Vector2d& place : felt_) add(place, obstacles);
  return true;
}

void DrivenBase::add(const Vector2d& place, CSimplePointsMap& obstacles) const {
  const TPose2D& pose = *knowledge_.pose;
  const Vector2d local = Eigen::Rotation2Dd(-pose.phi) * (place - Vector2d(pose.x, pose.y));
  // Under the robot there is nothing that it could avoid.
  if (std::abs(local.x()) < 0.5 * params_.length_m && std::abs(local.y()) < 0.5 * params_.width_m) {
    return;
  }
  obstacles.insertPoint(static_cast<float>(local.x()), static_cast<float>(local.y()),
                        kPointHeight_m);
}

/// Without predictions obstacles are taken from a map without tracks: people are where the base
/// senses them, and what is blocked now counts as ever.
bool predicts(const nav::PredictiveObstaclesParams& params) {
  return params.policy != nav::ObstaclePolicy::kStatic;
}

nav::PredictiveObstaclesParams obstaclesOf(nav::PredictiveObstaclesParams params) {
  if (!predicts(params)) params.policy = nav::ObstaclePolicy::kTimeGated;
  return params;
}

map::PerceptionMap withoutTracks(map::PerceptionMap map) {
  map.update(map.movingObjects().time(), {}, map.odometryFrame());
  return map;
}

/// The obstacles of a drive, sensed once in each step.
class DriveObstacles : public WatchedObstacles {
 public:
  DriveObstacles(DrivenBase& base, const DriveSetup& setup, Clock clock)
      : WatchedObstacles(
            base,
            [&base, predicts = predicts(setup.nav)] {
              const map::PerceptionMap& map = base.knowledge().map;
              return predicts ? map : withoutTracks(map);
            },
            obstaclesOf(setup.nav), std::move(clock)),
        body_(0.5 * setup.robot.length_m, 0.5 * setup.robot.width_m),
        margin_m_(setup.robot.margin_m) {
    setMinLoggingLevel(mrpt::system::LVL_ERROR);
  }

  /// @return whether they are safe
  bool sense() { return is_safe_ = WatchedObstacles::senseObstacles(sensed_, timestamp_); }
  /// In the robot's frame.
  [[nodiscard]] const CSimplePointsMap& sensed() const { return sensed_; }

  /// What the navigator's margin reaches already is left to the speed governor, because a planner
  /// that starts inside an obstacle finds no path.
  bool senseObstacles(CSimplePointsMap& obstacles, mrpt::system::TTimeStamp& timestamp) override {
    obstacles.clear();
    timestamp = timestamp_;
    for (std::size_t i = 0; i < sensed_.size(); ++i) {
      float x = 0.0F, y = 0.0F, z = 0.0F;
      sensed_.getPoint(i, x, y, z);
      const Vector2d place(static_cast<double>(x), static_cast<double>(y));
      const Vector2d outside = (place.cwiseAbs() - body_).cwiseMax(0.0);
      if (outside.norm() > margin_m_) obstacles.insertPointFast(x, y, z);
    }
    obstacles.mark_as_modified();
    return is_safe_;
  }

 private:
  Vector2d body_;  ///< half of it
  double margin_m_;
  CSimplePointsMap sensed_;
  mrpt::system::TTimeStamp timestamp_;
  bool is_safe_ = false;
};

/// A running drive.
class Drive {
 public:
  Drive(const DriveSetup& setup, std::uint64_t seed)
      : setup_(setup),
        size_(setup.robot.length_m, setup.robot.width_m),
        world_(withSeed(setup.world, seed), size_),
        start_s_(world_.now()),
        clock_(start_s_),
        eye_(makeEye(setup.sense, setup.robot, setup.objects, setup.local_layer)),
        base_(setup.robot, setup.nav.outline_spacing_m),
        obstacles_(base_, setup, [this] { return world_.now(); }),
        navigator_(obstacles_, setup.robot),
        guide_(world_.course(), setup.robot.width_m),
        manoeuvre_(size_),
        contacts_(size_) {
    auto scene = std::make_shared<TrialScene>();
    scene->course = world_.course();
    scene->goal = scene->course.back();
    scene->things = world_.things();
    scene_ = scene;
    result_.seed = seed;
    for (std::size_t i = 1; i < scene->course.size(); ++i) {
      detail_.course_m += (scene->course[i] - scene->course[i - 1]).norm();
    }
  }

  TrialResult run(const TrialObserver& observer);

 private:
  static sim::SimParams withSeed(sim::SimParams world, std::uint64_t seed) {
    world.world.seed = static_cast<int>(seed);
    return world;
  }
  [[nodiscard]] double time_s() const { return world_.now() - start_s_; }
  /// Remembers what stops the robot though it sees nothing there.
  void feel(const TPose2D& pose);
  void plan();
  /// Does what the navigator cannot. @return  whether something was to be done
  bool manoeuvres(const Vector2d& next);
  /// What a robot does that does not know where it is.
  void lookBack();
  void moveOn(double period_s);
  [[nodiscard]] TrialMoment moment() const;

  /// What stopped it, until a time.
  struct Felt {
    Vector2d place;
    double until_s;
  };

  const DriveSetup& setup_;
  Vector2d size_;
  sim::DrivenWorld world_;
  double start_s_;
  SimulatedClock clock_;
  std::unique_ptr<Eye> eye_;
  DrivenBase base_;
  DriveObstacles obstacles_;
  Navigator navigator_;
  Guide guide_;
  Manoeuvre manoeuvre_;
  ContactCounter contacts_;
  std::shared_ptr<const TrialScene> scene_;
  TPose2D known_;                   ///< last known pose
  double known_at_s_ = 0.0;         ///< its time
  std::optional<Vector2d> target_;  ///< of the navigator; nullopt: it does not navigate
  std::vector<Felt> felt_;
  double moved_at_s_ = 0.0;  ///< or was told to stand
  TrialResult result_;
  DriveResult detail_;
  bool touched_ = false;  ///< since the last planning step
};

TrialResult Drive::run(const TrialObserver& observer) {
  const double period_s =
      1.0 / std::min(setup_.world.camera.rate_hz, setup_.robot.planning_rate_hz);
  while (time_s() < setup_.robot.time_limit_s && !result_.goal_reached) {
    clock_.set(time_s());
    base_.know(eye_->perceive(world_), world_.robot().motion);
    plan();
    if (!base_.knowledge().pose) detail_.lost_s += period_s;
    if (observer) observer(moment());
    touched_ = false;
    moveOn(period_s);
  }
  result_.time_to_goal_s = time_s();
  detail_.contacts = contacts_.counts();
  detail_.goal_error_m = (world_.robot().position - scene_->goal).norm();
  result_.drive = detail_;
  result_.applyContacts();
  return result_;
}

void Drive::feel(const TPose2D& pose) {
  const auto is_over = [&](const Felt& felt) { return felt.until_s < time_s(); };
  felt_.erase(std::remove_if(felt_.begin(), felt_.end(), is_over), felt_.end());
  const double wanted = base_.command().speed;
  const bool pushes = std::abs(wanted) > kTouch.commanded_mps &&
                      std::abs(world_.robot().motion.speed) < 0.1 * kTouch.commanded_mps;
  if (!pushes) moved_at_s_ = time_s();
  if (time_s() - moved_at_s_ > kTouch.after_s) {
    for (double ahead = 0.5 * kTouch.spacing_m; ahead < kTouch.depth_m; ahead += kTouch.spacing_m) {
      for (double y = -0.5 * size_.y(); y <= 0.5 * size_.y(); y += kTouch.spacing_m) {
        const Vector2d local(std::copysign(0.5 * size_.x() + ahead, wanted), y);
        felt_.push_back({Vector2d(pose.x, pose.y) + Eigen::Rotation2Dd(pose.phi) * local,
                         time_s() + kTouch.remembered_s});
      }
    }
    moved_at_s_ = time_s();
  }
  std::vector<Vector2d> places;
  for (const Felt& felt : felt_) places.push_back(felt.place);
  base_.feel(std::move(places));
}

void Drive::plan() {
  constexpr double kArrived_m = 1.0;  // goal radius, and drift of 2 % of 30 m
  constexpr double kPassed_m = 0.1;   // of a bend on the way: nearer than the next one
  const auto& pose = base_.knowledge().pose;
  if (!pose) {  // MRPT's navigator would end
    target_.reset();
    ++result_.unsafe_steps;
    return lookBack();
  }
  known_at_s_ = time_s();
  known_ = *pose;
  feel(*pose);
  const double start = processorSeconds();
  const bool senses = obstacles_.sense();
  const Vector2d next = guide_.lead({pose->x, pose->y}, inMap(obstacles_.sensed(), *pose));
  const double radius_m = guide_.isLast() ? RobotParams::kGoalRadius_m : kPassed_m;
  if (!target_) {
    navigator_.startAfresh(next, radius_m);
  } else if (*target_ != next) {
    navigator_.driveTo(next, radius_m);
  }
  target_ = next;
  if (!senses || !manoeuvres(next)) navigator_.navigationStep();
  result_.step_us.push_back(1e6 * (processorSeconds() - start));
  result_.sense_us.push_back(obstacles_.senseTime_us());
  if (obstacles_.lastReport().status != nav::SenseStatus::kSafe) ++result_.unsafe_steps;
  const auto state = navigator_.getCurrentState();
  if (state == CAbstractNavigator::NAV_ERROR) target_.reset();
  if (state != CAbstractNavigator::IDLE) return;
  target_.reset();
  const double error_m = (world_.robot().position - scene_->goal).norm();
  if (guide_.isLast() && error_m < kArrived_m) result_.goal_reached = true;
}

bool Drive::manoeuvres(const Vector2d& next) {
  if (!manoeuvre_.isDue(time_s(), known_, next)) return false;
  const auto commandOf = [](const sim::DriveCommand& motion) {
    CVehicleVelCmd_DiffDriven command;
    command.lin_vel = motion.speed;
    command.ang_vel = motion.turn_rate;
    return command;
  };
  const auto motion = manoeuvre_.command(obstacles_.sensed(), [&](const auto& wanted) {
    return obstacles_.admissibleSpeedRatio(commandOf(wanted)) > 0.0;
  });
  if (!motion) return false;
  obstacles_.changeSpeeds(commandOf(*motion));
  return true;
}

void Drive::lookBack() {
  constexpr double kPatience_s = 2.0;  // at rest, in which people step out of view
  constexpr double kTurn_radps = 0.5;  // slow enough to be followed at 5 frames a second
  if (time_s() - known_at_s_ < kPatience_s) {
    base_.stop(true);
    return;
  }
  // Towards where it would go, away from what it has turned to.
  const Vector2d to = guide_.target() - Vector2d(known_.x, known_.y);
  const double turn = wrapAngle(std::atan2(to.y(), to.x()) - known_.phi);
  CVehicleVelCmd_DiffDriven command;
  command.ang_vel = turn < 0.0 ? -kTurn_radps : kTurn_radps;
  base_.trustOdometry();  // in which it is known what is blocked now
  obstacles_.changeSpeeds(command);
  base_.distrustOdometry();
}

void Drive::moveOn(double period_s) {
  const int steps = static_cast<int>(std::ceil(period_s / kLongestStep_s));
  for (int i = 0; i < steps; ++i) {
    world_.advance(period_s / steps, base_.command());
    contacts_.observe(world_.robot(), world_.movers(), period_s / steps);
    touched_ = touched_ || contacts_.touches();
  }
}

TrialMoment Drive::moment() const {
  constexpr int kImageWidth = 320;  // in a picture of trials [px]
  TrialMoment moment;
  moment.scene = scene_;
  moment.time_s = time_s();
  const sim::DrivenRobot robot = world_.robot();
  moment.robot = {robot.position.x(), robot.position.y(), robot.yaw};
  for (const sim::Mover& mover : world_.movers()) {
    sim::Person& person = moment.people.emplace_back();
    person.position = mover.shape.centre;
    person.heading = std::atan2(mover.velocity.y(), mover.velocity.x());
    person.speed = mover.velocity.norm();
    person.radius = mover.radius_m > 0.0 ? mover.radius_m : 0.5 * mover.shape.size.y();
  }
  moment.tracks = base_.knowledge().map.movingObjects().tracks();
  if (target_) moment.obstacles = inMap(obstacles_.sensed(), *base_.knowledge().pose);
  moment.contact = touched_;
  moment.ground =
      groundAbout(base_.knowledge().expected, base_.knowledge().map, setup_.nav.caution);
  const cv::Mat& image = base_.knowledge().image;
  if (!image.empty()) {
    const int height = kImageWidth * image.rows / image.cols;
    cv::resize(image, moment.image, {kImageWidth, height}, 0, 0, cv::INTER_AREA);
  }
  return moment;
}

}  // namespace

TrialResult DriveRunner::run(std::uint64_t seed, const TrialObserver& observer) {
  return Drive(setup_, seed).run(observer);
}

}  // namespace headway::app
