// SPDX-License-Identifier: BSD-3-Clause
// A world in motion and the frames that a rig takes of it.
#include <headway/core/error.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "actor_mesh.h"
#include "environment.h"
#include "frame_finisher.h"
#include "image_formation.h"
#include "lens.h"
#include "robot_sensors.h"
#include "stereo_rig.h"
#include "street.h"

namespace headway::sim {
namespace {

enum SimulatorPurpose : std::uint64_t {
  kImageSeed = 304,
  kDetectorSeed,
  kClockSeed,
  kSensorSeed,
  kFlexSeed = 309,
  kLaserSeed,
  kGnssSeed
};

std::uint64_t seedFor(SimulatorPurpose purpose, const SimParams& params) {
  return seedOf({static_cast<std::uint64_t>(params.world.seed), purpose});
}

}  // namespace

/// Everything of one simulation, in the order in which a frame passes through it.
class Simulator::Impl {
 public:
  explicit Impl(const SimParams& params);

  [[nodiscard]] std::optional<SimFrame> next();
  [[nodiscard]] bool arrived() const { return environment_->arrived() && !finishing_.valid(); }
  [[nodiscard]] const Lens& lens() const { return lens_; }
  [[nodiscard]] double pathLength() const { return environment_->pathLength(); }

 private:
  /// Robot in the world.
  [[nodiscard]] Pose robotPose() const { return environment_->T_world_robot(); }
  void advance(double seconds);
  void observeMotion();
  /// Lets time pass until the camera takes a frame; false at the end of the path.
  [[nodiscard]] bool waitForTrigger();
  void passUndrawn();
  [[nodiscard]] double exposure() const;   ///< 0 without motion blur [s]
  [[nodiscard]] double blurPause() const;  ///< between the drawings of one exposure [s]
  /// The next frame; nullopt after the last.
  [[nodiscard]] std::optional<DrawnFrame> drawNext();
  void draw(DrawnFrame& drawn);
  [[nodiscard]] std::vector<Actor> actorsInView();  ///< with the parked ones
  [[nodiscard]] io::RecordedScan scanLaser();
  /// The right camera in the left one, for one frame.
  [[nodiscard]] Pose bentRig(std::size_t frame) const;
  /// Finishes a frame in a thread of its own, behind the drawing of the next.
  void finishBehind(std::optional<DrawnFrame> drawn);

  SimParams params_;
  Lens lens_;
  std::unique_ptr<Environment> environment_;
  StereoRig rig_;
  FrameFinisher finisher_;
  MotionSensors sensors_;
  LaserScanner laser_;
  SatelliteReceiver receiver_;
  CameraClock clock_;
  std::size_t triggers_ = 0;         ///< frames taken so far, undrawn ones included
  std::size_t frames_ = 0;           ///< frames drawn for the caller
  double now_s_ = 0.0;               ///< since the first trigger [s]
  std::future<SimFrame> finishing_;  ///< the frame drawn last; uses the finisher
};

Simulator::Impl::Impl(const SimParams& params)
    : params_(params),
      lens_(params.camera, params.calibration_error),
      environment_(makeEnvironment(params, lens_.ideal())),
      rig_(lens_.drawn(), environment_->makeScene(lens_.drawn())),
      finisher_(params, lens_, seedFor(kImageSeed, params), seedFor(kDetectorSeed, params)),
      sensors_(seedFor(kSensorSeed, params), params.camera.wheel_slip_ratio),
      laser_(params.laser, seedFor(kLaserSeed, params)),
      receiver_(params.gnss, seedFor(kGnssSeed, params)),
      clock_(params.camera, seedFor(kClockSeed, params)) {
  observeMotion();
}

std::optional<SimFrame> Simulator::Impl::next() {
  if (!finishing_.valid()) finishBehind(drawNext());
  if (!finishing_.valid()) return std::nullopt;
  auto drawn = drawNext();
  SimFrame frame = finishing_.get();
  finishBehind(std::move(drawn));
  return frame;
}

std::optional<DrawnFrame> Simulator::Impl::drawNext() {
  if (frames_ >= static_cast<std::size_t>(params_.recording.frames)) return std::nullopt;
  const auto first = static_cast<std::size_t>(params_.recording.first_frame);
  while (triggers_ < first && waitForTrigger()) passUndrawn();
  if (!waitForTrigger()) {
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
  if (params_.laser.enabled) drawn.frame.laser = scanLaser();
  drawn.frame.gnss = receiver_.take();
  if (params_.gnss.enabled) {
    drawn.frame.place = receiver_.placeOf(drawn.frame.time, drawn.T_world_robot);
  }
  if (drawn.frame.index == 0) drawn.frame.drops = environment_->drops();
  return drawn;
}

bool Simulator::Impl::waitForTrigger() {
  while (!environment_->arrived()) {
    const CameraClock::Beat beat = clock_.next();
    advance(beat.time_s - 0.5 * exposure() - now_s_);
    if (beat.lost) continue;
    ++triggers_;
    environment_->observe();
    return true;
  }
  return false;
}

void Simulator::Impl::passUndrawn() {
  for (int i = 1; i < params_.camera.blur_samples; ++i) advance(blurPause());
  (void)sensors_.takeImu();
  (void)receiver_.take();
}

double Simulator::Impl::exposure() const {
  return params_.camera.blur_samples > 1 ? params_.camera.exposure_s : 0.0;
}

double Simulator::Impl::blurPause() const {
  return exposure() / std::max(1, params_.camera.blur_samples - 1);
}

void Simulator::Impl::advance(double seconds) {
  if (seconds <= 0.0) return;
  const double longest = params_.camera.imu ? 0.01 : 0.05;  // of a step of the motion [s]
  const int steps = static_cast<int>(std::ceil(seconds / longest - 1e-9));
  const double begin = now_s_;
  for (int i = 0; i < steps; ++i) {
    environment_->advance(seconds / steps);
    now_s_ = begin + seconds * (i + 1) / steps;
    observeMotion();
  }
}

void Simulator::Impl::observeMotion() {
  const Time now = params_.recording.start_time_s + now_s_;
  sensors_.observe(now, robotPose());
  receiver_.observe(now, robotPose());
}

void Simulator::Impl::draw(DrawnFrame& drawn) {
  const int samples = params_.camera.blur_samples;
  const Pose T_left_right = bentRig(triggers_);
  cv::Mat left_sum, right_sum;
  for (int i = 0; i < samples; ++i) {
    if (i > 0) advance(blurPause());
    const auto actors = actorsInView();
    const bool is_middle = i == samples / 2;
    const Pose T_world_robot = robotPose();
    auto meshes = actorMeshes(actors, T_world_robot.translation());
    StereoDrawing drawing = rig_.draw(T_world_robot, T_left_right, actors, meshes, is_middle);
    if (is_middle) {
      drawn.frame.time = params_.recording.start_time_s + now_s_;
      drawn.depth = drawing.depth;
      drawn.actors = actors;
      drawn.meshes = std::move(meshes);
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

std::vector<Actor> Simulator::Impl::actorsInView() {
  std::vector<Actor> actors = environment_->actors(params_.world.view_distance_m);
  // With 2 m for the shadow and the other camera's place.
  const ViewCone view = viewCone(lens_.drawn(), robotPose());
  actors.erase(std::remove_if(actors.begin(), actors.end(),
                              [&](const Actor& actor) {
                                return !view.touches(actor.position.head<2>(),
                                                     0.5 * actor.size.head<2>().norm() + 2.0);
                              }),
               actors.end());
  return actors;
}

io::RecordedScan Simulator::Impl::scanLaser() {
  const double reach = params_.laser.max_range_m;
  const auto meshes = actorMeshes(environment_->actors(reach), robotPose().translation());
  return laser_.scan(params_.recording.start_time_s + now_s_, robotPose(),
                     environment_->staticMeshes(reach), meshes);
}

Pose Simulator::Impl::bentRig(std::size_t frame) const {
  Random random(seedOf({seedFor(kFlexSeed, params_), frame}));
  const double sigma = params_.calibration_error.flex_deg * M_PI / 180.0;
  const double x = random.normal(), y = random.normal(), z = random.normal();
  Pose T_left_right = lens_.T_left_right();
  T_left_right.linear() *= expSo3(sigma * Eigen::Vector3d(x, y, z));
  return T_left_right;
}

void Simulator::Impl::finishBehind(std::optional<DrawnFrame> drawn) {
  if (!drawn) return;
  finishing_ = std::async(std::launch::async, [this, drawn = std::move(*drawn)]() mutable {
    return finisher_.finish(std::move(drawn));
  });
}

Simulator::Simulator(const SimParams& params) {
  params.validate();
  impl_ = std::make_unique<Impl>(params);
}

Simulator::~Simulator() = default;

std::optional<SimFrame> Simulator::next() { return impl_->next(); }

bool Simulator::arrived() const { return impl_->arrived(); }

const StereoCamera& Simulator::camera() const { return impl_->lens().ideal(); }

io::RawStereoCamera Simulator::recordedCamera() const { return impl_->lens().recorded(); }

double Simulator::pathLength() const { return impl_->pathLength(); }

}  // namespace headway::sim
