#include <headway/core/error.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "escort.h"
#include "frame_finisher.h"
#include "lens.h"
#include "motion_sensors.h"
#include "pedestrians.h"
#include "person_mesh.h"
#include "robot_driver.h"
#include "stereo_rig.h"
#include "vehicles.h"
#include "world.h"

namespace headway::sim {
namespace {

enum Purpose : std::uint64_t {
  kVehicleSeed = 301,
  kPedestrianSeed,
  kRobotSeed,
  kImageSeed,
  kDetectorSeed,
  kClockSeed,
  kSensorSeed,
  kEscortSeed,
  kFlexSeed
};

constexpr double kStep = 0.05;     // longest step of the motion [s]
constexpr double kImuStep = 0.01;  // the same where an inertial sensor is recorded [s]

}  // namespace

int occlusionLevel(double visible) {
  if (visible >= 0.8) return 0;
  if (visible >= 0.4) return 1;
  return visible >= 0.1 ? 2 : 3;
}

cv::Mat dynamicMask(const SimFrame& frame) {
  cv::Mat mask = cv::Mat::zeros(frame.instances.size(), CV_8U);
  for (int v = 0; v < mask.rows; ++v) {
    const auto* labels = frame.instances.ptr<std::uint16_t>(v);
    auto* marks = mask.ptr<uchar>(v);
    for (int u = 0; u < mask.cols; ++u) {
      if (labels[u] != 0 && !frame.objects[labels[u] - 1U].parked) marks[u] = 255;
    }
  }
  return mask;
}

/// Everything of one simulation, in the order in which a frame passes through it.
class Simulator::Machine {
 public:
  explicit Machine(const SimParams& params);

  [[nodiscard]] std::optional<SimFrame> next();
  [[nodiscard]] bool arrived() const { return robot_.arrived() && !finishing_.valid(); }
  [[nodiscard]] const Lens& lens() const { return lens_; }
  [[nodiscard]] double pathLength() const { return route_.end_s - route_.start_s; }

 private:
  [[nodiscard]] std::uint64_t seed(Purpose purpose) const {
    return seedOf({static_cast<std::uint64_t>(params_.world.seed), purpose});
  }
  void advance(double seconds);
  void step(double dt);
  [[nodiscard]] std::vector<Mover> othersMoving() const;  ///< but for the escort
  [[nodiscard]] std::vector<Mover> moversInView();        ///< with the parked ones
  /// The right camera in the left one, for one frame.
  [[nodiscard]] Pose bentRig(std::size_t frame) const;
  /// Lets time pass until the camera takes a frame; false at the end of the path.
  [[nodiscard]] bool waitForTrigger();
  void passUndrawn();
  [[nodiscard]] double blurPause() const;  ///< between the drawings of one exposure [s]
  /// The next frame; nullopt after the last.
  [[nodiscard]] std::optional<DrawnFrame> drawNext();
  void draw(DrawnFrame& drawn);
  /// Finishes a frame in a thread of its own, behind the drawing of the next.
  void finishBehind(std::optional<DrawnFrame> drawn);

  SimParams params_;
  Route route_;
  World world_;
  Lens lens_;
  StereoRig rig_;
  RobotDriver robot_;
  std::int64_t next_id_ = 0;
  Escort escort_;
  Vehicles vehicles_;
  Pedestrians pedestrians_;
  FrameFinisher finisher_;
  MotionSensors sensors_;
  Random clock_;
  std::size_t tick_ = 0;      ///< beats of the camera's clock so far, dropped frames included
  std::size_t triggers_ = 0;  ///< frames taken so far, undrawn ones included
  std::size_t frames_ = 0;    ///< frames drawn for the caller
  double now_s_ = 0.0;        ///< since the first trigger [s]
  std::future<SimFrame> finishing_;  ///< the frame drawn last; uses the finisher
};

Simulator::Machine::Machine(const SimParams& params)
    : params_(params),
      route_(makeRoute(params.route, params.world.hill_height_m)),
      world_(params.world, route_),
      lens_(params.camera, params.calibration_error),
      rig_(lens_.drawn(), world_),
      robot_(params.route, params.camera.ride_deg, params.traffic.image_share > 0.0, route_,
             seed(kRobotSeed)),
      escort_(params.traffic, route_, lens_.ideal(), seed(kEscortSeed), robot_.state(),
              robot_.T_world_robot(), next_id_),
      vehicles_(escort_.others(), route_, world_.network(), seed(kVehicleSeed)),
      pedestrians_(params.traffic, route_, world_.network(), seed(kPedestrianSeed)),
      finisher_(params, lens_, seed(kImageSeed), seed(kDetectorSeed)),
      sensors_(seed(kSensorSeed)),
      clock_(seed(kClockSeed)) {
  vehicles_.populate(robot_.state(), next_id_);
  pedestrians_.populate(robot_.state(), next_id_);
  escort_.populate(robot_.state(), robot_.T_world_robot(), othersMoving());
  sensors_.observe(params.recording.start_time_s, robot_.T_world_robot());
}

void Simulator::Machine::step(double dt) {
  const RobotState robot = robot_.state();
  std::vector<Obstacle> on_foot, on_wheels{robot.body};
  for (const Mover& mover : pedestrians_.movers()) on_foot.push_back(obstacleFrom(mover));
  for (const Mover& mover : vehicles_.movers()) on_wheels.push_back(obstacleFrom(mover));
  std::vector<Obstacle> for_vehicles = on_foot, for_robot = on_foot;
  for_vehicles.push_back(robot.body);
  for_robot.insert(for_robot.end(), on_wheels.begin() + 1, on_wheels.end());
  escort_.advance(dt, robot, for_robot);
  for (const Mover& mover : escort_.movers()) {
    const Obstacle escort = obstacleFrom(mover);
    for (auto* list : {&on_wheels, &for_vehicles, &for_robot}) list->push_back(escort);
  }
  pedestrians_.advance(dt, robot, on_wheels, next_id_);
  vehicles_.advance(dt, robot, for_vehicles, next_id_);
  robot_.advance(dt, for_robot);
}

void Simulator::Machine::advance(double seconds) {
  if (seconds <= 0.0) return;
  const double longest = params_.camera.imu ? kImuStep : kStep;
  const int steps = static_cast<int>(std::ceil(seconds / longest - 1e-9));
  const double begin = now_s_;
  for (int i = 0; i < steps; ++i) {
    step(seconds / steps);
    now_s_ = begin + seconds * (i + 1) / steps;
    sensors_.observe(params_.recording.start_time_s + now_s_, robot_.T_world_robot());
  }
}

std::vector<Mover> Simulator::Machine::othersMoving() const {
  std::vector<Mover> movers = vehicles_.movers();
  const auto& people = pedestrians_.movers();
  movers.insert(movers.end(), people.begin(), people.end());
  return movers;
}

std::vector<Mover> Simulator::Machine::moversInView() {
  std::vector<Mover> movers = othersMoving();
  movers.insert(movers.end(), escort_.movers().begin(), escort_.movers().end());
  const auto parked =
      world_.parkedNear(robot_.T_world_robot().translation(), params_.world.view_distance_m);
  movers.insert(movers.end(), parked.begin(), parked.end());
  // With the room that a shadow takes, and the other camera's place.
  constexpr double kMargin = 2.0;  // [m]
  const ViewCone view = viewCone(lens_.drawn(), robot_.T_world_robot());
  movers.erase(std::remove_if(movers.begin(), movers.end(),
                              [&](const Mover& mover) {
                                return !view.touches(mover.position.head<2>(),
                                                     0.5 * mover.size.head<2>().norm() + kMargin);
                              }),
               movers.end());
  return movers;
}

Pose Simulator::Machine::bentRig(std::size_t frame) const {
  Random random(seedOf({seed(kFlexSeed), frame}));
  const double sigma = params_.calibration_error.flex_deg * M_PI / 180.0;
  const double x = random.normal(), y = random.normal(), z = random.normal();
  Pose T_left_right = lens_.T_left_right();
  T_left_right.linear() *= expSo3(sigma * Eigen::Vector3d(x, y, z));
  return T_left_right;
}

void Simulator::Machine::draw(DrawnFrame& drawn) {
  const int samples = params_.camera.blur_samples;
  const Pose T_left_right = bentRig(triggers_);
  cv::Mat left_sum, right_sum;
  for (int i = 0; i < samples; ++i) {
    if (i > 0) advance(blurPause());
    const auto movers = moversInView();
    const bool is_middle = i == samples / 2;
    const Pose T_world_robot = robot_.T_world_robot();
    auto bodies = moverMeshes(movers, T_world_robot.translation());
    StereoDrawing drawing = rig_.draw(T_world_robot, T_left_right, movers, bodies, is_middle);
    if (is_middle) {
      drawn.frame.time = params_.recording.start_time_s + now_s_;
      drawn.depth = drawing.depth;
      drawn.movers = movers;
      drawn.bodies = std::move(bodies);
      drawn.T_world_robot = T_world_robot;
    }
    if (samples == 1) {
      drawn.left = drawing.left;
      drawn.right = drawing.right;
      return;
    }
    cv::Mat left, right;
    drawing.left.convertTo(left, CV_16UC3);
    drawing.right.convertTo(right, CV_16UC3);
    left_sum = left_sum.empty() ? left : cv::Mat(left_sum + left);
    right_sum = right_sum.empty() ? right : cv::Mat(right_sum + right);
  }
  left_sum.convertTo(drawn.left, CV_8UC3, 1.0 / samples);
  right_sum.convertTo(drawn.right, CV_8UC3, 1.0 / samples);
}

double Simulator::Machine::blurPause() const {
  const int samples = params_.camera.blur_samples;
  return samples > 1 ? params_.camera.exposure_s / (samples - 1) : 0.0;
}

bool Simulator::Machine::waitForTrigger() {
  for (;;) {
    if (robot_.arrived()) return false;
    const double exposure = params_.camera.blur_samples > 1 ? params_.camera.exposure_s : 0.0;
    const double jitter = std::clamp(params_.camera.jitter_s * clock_.normal(),
                                     -3.0 * params_.camera.jitter_s, 3.0 * params_.camera.jitter_s);
    const double trigger = static_cast<double>(tick_) / params_.camera.rate_hz + jitter;
    if (tick_ > 0) advance(trigger - 0.5 * exposure - now_s_);
    const bool dropped = tick_ > 0 && clock_.chance(params_.camera.drop_share);
    ++tick_;
    if (dropped) continue;
    ++triggers_;
    escort_.observe(robot_.T_world_robot(), othersMoving());
    return true;
  }
}

void Simulator::Machine::passUndrawn() {
  for (int i = 1; i < params_.camera.blur_samples; ++i) advance(blurPause());
  (void)sensors_.takeImu();
}

std::optional<DrawnFrame> Simulator::Machine::drawNext() {
  if (frames_ >= static_cast<std::size_t>(params_.recording.frames)) return std::nullopt;
  const auto first = static_cast<std::size_t>(params_.recording.first_frame);
  while (triggers_ < first && waitForTrigger()) passUndrawn();
  if (robot_.arrived() || !waitForTrigger()) {
    if (frames_ > 0) return std::nullopt;
    throw InputError("[recording] first_frame: " + std::to_string(first) +
                     ", but the path ends after " + std::to_string(triggers_) + " frames");
  }
  DrawnFrame drawn;
  drawn.frame.index = frames_++;
  draw(drawn);
  drawn.trigger = triggers_ - 1;
  if (params_.camera.imu) drawn.frame.imu = sensors_.takeImu();
  if (params_.camera.odometry) drawn.frame.odometry = sensors_.odometry();
  return drawn;
}

void Simulator::Machine::finishBehind(std::optional<DrawnFrame> drawn) {
  if (!drawn) return;
  finishing_ = std::async(std::launch::async, [this, drawn = std::move(*drawn)]() mutable {
    return finisher_.finish(std::move(drawn));
  });
}

std::optional<SimFrame> Simulator::Machine::next() {
  if (!finishing_.valid()) finishBehind(drawNext());
  if (!finishing_.valid()) return std::nullopt;
  auto drawn = drawNext();
  SimFrame frame = finishing_.get();
  finishBehind(std::move(drawn));
  return frame;
}

Simulator::Simulator(const SimParams& params) {
  params.validate();
  machine_ = std::make_unique<Machine>(params);
}

Simulator::~Simulator() = default;

std::optional<SimFrame> Simulator::next() { return machine_->next(); }

bool Simulator::arrived() const { return machine_->arrived(); }

const StereoCamera& Simulator::camera() const { return machine_->lens().ideal(); }

io::RawStereoCamera Simulator::recordedCamera() const { return machine_->lens().recorded(); }

double Simulator::pathLength() const { return machine_->pathLength(); }

}  // namespace headway::sim
