// SPDX-License-Identifier: BSD-3-Clause
// A world in motion and the frames that a rig takes of it.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/stereo_camera.h>
#include <headway/io/rawlog_sink.h>
#include <headway/sim/sim_params.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

namespace headway::sim {

/// What is true of one object at one frame.
struct TruthObject {
  std::int64_t id = -1;
  ObjectClass object_class = ObjectClass::kUnknown;
  bool parked = false;
  Box3d box3d;              ///< rectified left camera's optical frame
  Box2d box2d;              ///< around the drawn body, cut at the edges [px], image as recorded
  double truncation = 0.0;  ///< ratio of the uncut box outside the image
  double visible = 0.0;     ///< ratio of its pixels in the image that nothing hides
  int occlusion = 0;        ///< KITTI's: 0 visible, 1 partly, 2 largely hidden, 3 all but gone
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< box centre, map frame [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< map frame [m/s]
  double yaw = 0.0;                                    ///< of the front about map z [rad]
  Eigen::Vector3d size = Eigen::Vector3d::Zero();      ///< length, width, height [m]
};

/// One inertial sample, robot frame.
struct ImuSample {
  Time time = 0.0;
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  ///< [rad/s]
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();      ///< [m/s^2], gravity included
};

/// Wheel odometry: planar pose of the robot in a frame that drifts.
struct OdometrySample {
  Time time = 0.0;
  double x = 0.0, y = 0.0, yaw = 0.0;  ///< [m], [m], [rad]
};

/// Where the robot is on the earth (WGS 84).
struct TruePlace {
  Time time = 0.0;
  double latitude_deg = 0.0, longitude_deg = 0.0, altitude_m = 0.0;
  double heading_deg = 0.0;  ///< of the robot's x axis, clockwise from north
};

/// A rectangle on the ground, turned by yaw.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();  ///< [m]
  Eigen::Vector2d size = Eigen::Vector2d::Ones();    ///< along yaw and across it [m]
  double yaw = 0.0;                                  ///< [rad]
};

/// Ground that lies so much lower than its surroundings that a robot must not drive over its edge.
struct Drop {
  std::vector<Eigen::Vector2d> outline;  ///< convex, counterclockwise [m]
  double depth_m = 0.0;                  ///< below the surrounding ground
};

/// One simulated stereo frame with all that is true of it.
struct SimFrame {
  std::size_t index = 0;
  Time time = 0.0;
  cv::Mat left;       ///< 8-bit BGR or grey, as recorded
  cv::Mat right;      ///< same; empty: a depth camera
  cv::Mat ranges;     ///< of a depth camera, 16-bit [mm], 0 where nothing was measured
  cv::Mat depth;      ///< 32-bit, left camera [m]; 0 where there is only sky
  cv::Mat instances;  ///< 16-bit: number of the object in `objects` + 1; 0 elsewhere
  Pose T_map_robot = Pose::Identity();
  std::vector<TruthObject> objects;
  Detections detections;
  std::vector<ImuSample> imu;  ///< since the frame before, if recorded
  std::optional<OdometrySample> odometry;
  std::optional<io::RecordedScan> laser;  ///< at the frame's time
  std::vector<io::RecordedGnss> gnss;     ///< since the frame before, if recorded
  std::optional<TruePlace> place;         ///< if satellite fixes are recorded
  std::vector<Drop> drops;  ///< of the whole world, map frame; with the first frame alone
};

/// Pixels of the left image that show something that moves.
///
/// @return  8-bit: 255 where an actor (not a parked one) is seen, 0 elsewhere
[[nodiscard]] cv::Mat dynamicMask(const SimFrame& frame);

/// A world in motion, seen by a stereo rig on a robot that drives through it.
///
/// Same parameters, same frames, byte for byte, on one machine. Frames must be drawn in the
/// thread that made the simulator. It is one frame ahead of its caller: while a frame is finished
/// in a second thread, the next is drawn.
///
///     SimParams params;
///     Simulator simulator(params);
///     while (auto frame = simulator.next()) recording.write(*frame);
class Simulator {
 public:
  /// @throws InputError naming the key of parameters that cannot be
  explicit Simulator(const SimParams& params);
  ~Simulator();
  Simulator(const Simulator&) = delete;
  Simulator& operator=(const Simulator&) = delete;

  /// The next frame; nullopt after the last, or at the end of the path.
  ///
  /// @throws InputError if the path ends before the first frame that is wanted
  [[nodiscard]] std::optional<SimFrame> next();
  /// Whether the robot is at the end of its path, so that no more frames come.
  [[nodiscard]] bool arrived() const;

  /// The ideal, rectified pair that depth and 3D boxes refer to.
  [[nodiscard]] const StereoCamera& camera() const;
  /// The pair as recorded, with its distortion.
  [[nodiscard]] io::RawStereoCamera recordedCamera() const;
  /// Length of the path [m]; 0 if it never ends.
  [[nodiscard]] double pathLength() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

/// KITTI's occlusion level of a visible ratio.
[[nodiscard]] int occlusionLevel(double visible);

}  // namespace headway::sim
