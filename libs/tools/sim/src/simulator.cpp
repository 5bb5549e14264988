// SPDX-License-Identifier: BSD-3-Clause
// A world in motion and the frames that a rig takes of it.
#include <headway/core/error.h>
#include <headway/sim/simulator.h>

#include <algorithm>
#include <cmath>
#include <future>

#include "actor_mesh.h"
#include "environment.h"
#include "frame_drawer.h"
#include "image_formation.h"
#include "robot_sensors.h"

namespace headway::sim {
namespace {

enum SimulatorPurpose : std::uint64_t {
  kClockSeed = 306,
  kSensorSeed,
  kLaserSeed = 310,
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
  [[nodiscard]] const Lens& lens() const { return drawer_.lens(); }
  [[nodiscard]] double pathLength() const { return environment_->pathLength(); }

 private:
  /// Robot in the world.
  [[nodiscard]] Pose robotPose() const { return environment_->T_world_robot(); }
  void advance(double seconds);
  void observeMotion();
  /// Lets time pass until the camera takes a frame; false at the end of the path.
  [[nodiscard]] bool waitForTrigger();
  void passUndrawn();
  [[nodiscard]] double exposure() const;  ///< 0 without motion blur [s]
  /// The next frame; nullopt after the last.
  [[nodiscard]] std::optional<DrawnFrame> drawNext();
  [[nodiscard]] io::RecordedScan scanLaser();
  /// Finishes a frame in a thread of its own, behind the drawing of the next.
  void finishBehind(std::optional<DrawnFrame> drawn);

  SimParams params_;
  FrameDrawer drawer_;
  std::unique_ptr<Environment> environment_;
  MotionSensors sensors_;
  LaserScanner laser_;
  SatelliteReceiver receiver_;
  CameraClock clock_;
  std::size_t triggers_ = 0;         ///< frames taken so far, undrawn ones included
  std::size_t frames_ = 0;           ///< frames drawn for the caller
  double now_s_ = 0.0;               ///< since the first trigger [s]
  std::future<SimFrame> finishing_;  ///< the frame drawn last; uses the drawer
};

Simulator::Impl::Impl(const SimParams& params)
    : params_(params),
      drawer_(params),
      environment_(makeEnvironment(params, drawer_.lens().ideal())),
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
  DrawnFrame drawn = drawer_.draw(*environment_, triggers_, [this](double pause_s) {
    advance(pause_s);
    return params_.recording.start_time_s + now_s_;
  });
  drawn.frame.index = frames_++;
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
  for (int i = 1; i < params_.camera.blur_samples; ++i) advance(drawer_.blurPause());
  (void)sensors_.takeImu();
  (void)receiver_.take();
}

double Simulator::Impl::exposure() const {
  return params_.camera.blur_samples > 1 ? params_.camera.exposure_s : 0.0;
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

io::RecordedScan Simulator::Impl::scanLaser() {
  const double reach = params_.laser.max_range_m;
  const auto meshes = actorMeshes(environment_->actors(reach), robotPose().translation());
  return laser_.scan(params_.recording.start_time_s + now_s_, robotPose(),
                     environment_->staticMeshes(reach), meshes);
}

void Simulator::Impl::finishBehind(std::optional<DrawnFrame> drawn) {
  if (!drawn) return;
  finishing_ = std::async(std::launch::async, [this, drawn = std::move(*drawn)]() mutable {
    return drawer_.finish(std::move(drawn));
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
