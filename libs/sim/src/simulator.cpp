#include <headway/sim/simulator.h>

#include <algorithm>
#include <cmath>

#include "detector_noise.h"
#include "escort.h"
#include "image_formation.h"
#include "lens.h"
#include "motion_sensors.h"
#include "pedestrians.h"
#include "robot_driver.h"
#include "stereo_rig.h"
#include "vehicles.h"
#include "visibility.h"
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

/// The sighting as the recorded image shows it: its box bent by the lens and cut anew.
///
/// @return false if nothing of it is inside the recorded image
bool recordBox(const Lens& lens, Sighting& sighting) {
  const Box2d whole = lens.record(sighting.whole);
  Box2d& box = sighting.box;
  box = {std::max(whole.left, 0.0), std::max(whole.top, 0.0),
         std::min(whole.right, lens.ideal().width - 1.0),
         std::min(whole.bottom, lens.ideal().height - 1.0)};
  if (box.width() <= 0.0 || box.height() <= 0.0) return false;
  sighting.truncation =
      std::clamp(1.0 - box.width() * box.height() / (whole.width() * whole.height()), 0.0, 1.0);
  return true;
}

TruthObject truthOf(const Mover& mover, const Sighting& sighting, const Pose& T_map_world) {
  TruthObject object;
  object.id = mover.id;
  object.object_class = classOf(mover.kind);
  object.parked = mover.parked;
  object.box3d = sighting.box3d;
  object.box2d = sighting.box;
  object.truncation = sighting.truncation;
  object.visible = sighting.visible;
  object.occlusion = occlusionLevel(sighting.visible);
  object.position = T_map_world * mover.centre();
  object.velocity =
      T_map_world.linear() * Eigen::Vector3d(mover.velocity.x(), mover.velocity.y(), 0.0);
  const Eigen::Vector3d front =
      T_map_world.linear() * Eigen::Vector3d(std::cos(mover.yaw), std::sin(mover.yaw), 0.0);
  object.yaw = std::atan2(front.y(), front.x());
  object.size = mover.size;
  return object;
}

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
  void draw(SimFrame& frame);
  void judge(SimFrame& frame, const std::vector<Mover>& movers);

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
  ImageFormation image_formation_;
  DetectorNoise detector_;
  MotionSensors sensors_;
  Random clock_;
  std::size_t tick_ = 0;      ///< beats of the camera's clock so far, dropped frames included
  std::size_t triggers_ = 0;  ///< frames taken so far, undrawn ones included
  std::size_t frames_ = 0;    ///< frames handed out
  double now_s_ = 0.0;        ///< since the first trigger [s]
  std::optional<Pose> T_map_world_;
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
      image_formation_(params.camera, params.camera.width, params.camera.height, seed(kImageSeed)),
      detector_(params.detector, lens_.ideal(), seed(kDetectorSeed)),
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

void Simulator::Machine::draw(SimFrame& frame) {
  const int samples = params_.camera.blur_samples;
  const Pose T_left_right = bentRig(triggers_);
  cv::Mat left_sum, right_sum;
  for (int i = 0; i < samples; ++i) {
    if (i > 0) advance(blurPause());
    const auto movers = moversInView();
    const bool is_middle = i == samples / 2;
    const Pose T_world_robot = robot_.T_world_robot();
    StereoDrawing drawing = rig_.draw(T_world_robot, T_left_right, movers, is_middle);
    if (is_middle) {
      frame.depth = drawing.depth;
      judge(frame, movers);
    }
    if (samples == 1) {
      frame.left = drawing.left;
      frame.right = drawing.right;
      return;
    }
    cv::Mat left, right;
    drawing.left.convertTo(left, CV_16UC3);
    drawing.right.convertTo(right, CV_16UC3);
    left_sum = left_sum.empty() ? left : cv::Mat(left_sum + left);
    right_sum = right_sum.empty() ? right : cv::Mat(right_sum + right);
  }
  left_sum.convertTo(frame.left, CV_8UC3, 1.0 / samples);
  right_sum.convertTo(frame.right, CV_8UC3, 1.0 / samples);
}

void Simulator::Machine::judge(SimFrame& frame, const std::vector<Mover>& movers) {
  const Pose T_world_robot = robot_.T_world_robot();
  if (!T_map_world_) T_map_world_ = T_world_robot.inverse();
  frame.time = params_.recording.start_time_s + now_s_;
  frame.T_map_robot = *T_map_world_ * T_world_robot;
  auto sightings =
      findSightings(T_world_robot, lens_.drawn(), movers, frame.depth, frame.instances);
  sightings.erase(std::remove_if(sightings.begin(), sightings.end(),
                                 [&](Sighting& sighting) { return !recordBox(lens_, sighting); }),
                  sightings.end());
  std::vector<std::uint16_t> numbers(movers.size() + 1, 0);
  for (const Sighting& sighting : sightings) {
    const Mover& mover = movers[sighting.mover];
    const bool hidden_for_good = mover.parked && sighting.visible_pixels == 0;
    if (hidden_for_good || sighting.box3d.centre.z() > params_.recording.truth_range_m) continue;
    frame.objects.push_back(truthOf(mover, sighting, *T_map_world_));
    numbers[sighting.mover + 1] = static_cast<std::uint16_t>(frame.objects.size());
  }
  for (auto& label : cv::Mat_<std::uint16_t>(frame.instances)) label = numbers[label];
  frame.depth = lens_.record(frame.depth, false);
  frame.instances = lens_.record(frame.instances, false);
  frame.detections = detector_.detect(frame.time, movers, sightings, frame.depth);
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

std::optional<SimFrame> Simulator::Machine::next() {
  if (frames_ >= static_cast<std::size_t>(params_.recording.frames)) return std::nullopt;
  while (triggers_ < static_cast<std::size_t>(params_.recording.first_frame)) {
    if (!waitForTrigger()) return std::nullopt;
    passUndrawn();
  }
  if (!waitForTrigger()) return std::nullopt;
  SimFrame frame;
  frame.index = frames_++;
  draw(frame);
  if (params_.camera.imu) frame.imu = sensors_.takeImu();
  if (params_.camera.odometry) frame.odometry = sensors_.odometry();
  using Side = ImageFormation::Side;
  const auto exposed = [&](const cv::Mat& drawing, Side side) {
    return image_formation_.expose(lens_.record(drawing, true), triggers_ - 1, side);
  };
  frame.left = exposed(frame.left, Side::kLeft);
  frame.right = exposed(frame.right, Side::kRight);
  return frame;
}

Simulator::Simulator(const SimParams& params) {
  params.validate();
  machine_ = std::make_unique<Machine>(params);
}

Simulator::~Simulator() = default;

std::optional<SimFrame> Simulator::next() { return machine_->next(); }

const StereoCamera& Simulator::camera() const { return machine_->lens().ideal(); }

io::RawStereoCamera Simulator::recordedCamera() const { return machine_->lens().recorded(); }

double Simulator::pathLength() const { return machine_->pathLength(); }

}  // namespace headway::sim
