// SPDX-License-Identifier: BSD-3-Clause
// From observations to frames: images are paired, and boxes, poses and scans assigned to them by
// time.
#pragma once

#include <headway/core/detection.h>
#include <headway/core/log.h>
#include <headway/core/pose.h>
#include <headway/core/recorded_frame.h>
#include <headway/core/stereo_frame.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <array>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "motion_prior.h"
#include "observation_selection.h"
#include "recorded_depth.h"

namespace headway::io {

/// Recognises sensors whose times are of another clock than the images' times.
///
/// Observations arrive in the order of measurement, but for latencies. The newest time of each
/// sensor is compared with that of each image as it arrives; a sensor without new observations,
/// such as one that is unplugged, is not compared.
class ClockCheck {
 public:
  /// Takes an observation of another sensor than the left camera.
  void addSample(const std::string& label, Time time);
  /// Takes a left image. Adds "clocks_differ_SENSOR" for each sensor that has differed by more than
  /// a second in ten successive images.
  void addImage(std::size_t frame, Time time, Warnings& warnings);

 private:
  struct Sensor {
    std::optional<Time> newest;  ///< since the last image
    int images = 0;              ///< successive ones that it differs from
  };
  std::map<std::string, Sensor> sensors_;
};

/// A recorded stereo pair, or an intensity image with depth; external images are not loaded.
///
/// The intensity image of a depth camera is the left one, and the calibration that of a pair whose
/// baseline is equivalentBaseline().
struct RecordedPair {
  Time time = 0.0;  ///< of the left image [s]
  mrpt::img::CImage left;
  mrpt::img::CImage right;
  mrpt::img::TCamera left_camera;
  mrpt::img::TCamera right_camera;
  Pose T_robot_left = Pose::Identity();
  Pose T_left_right = Pose::Identity();
  std::optional<RecordedDepth> depth;  ///< instead of a right image
};

/// The pair's calibration.
[[nodiscard]] RawStereoCamera rawCameraOf(const RecordedPair& pair);

/// Whether all numbers of the calibration are finite.
[[nodiscard]] bool hasFiniteCalibration(const RecordedPair& pair);

/// Selects the observations of a stereo camera and pairs single images by time.
class StereoPairing {
 public:
  /// @param tolerance_s  maximum time difference of the two images [s]
  /// @param skipped      counts unpaired images ("unpaired_image", "no_right_image", "no_depth",
  ///                     "no_intensity_image")
  StereoPairing(CameraChoice choice, double tolerance_s,
                std::map<std::string, std::size_t>& skipped)
      : choice_(std::move(choice)), tolerance_s_(tolerance_s), skipped_(skipped) {}

  /// Whether the observation belongs to this camera and may be passed to add().
  [[nodiscard]] bool accepts(const mrpt::obs::CObservation& observation) const;

  /// @return the pair completed by this observation, if any
  [[nodiscard]] std::optional<RecordedPair> add(const mrpt::obs::CObservation::Ptr& observation);

  /// Least time between images of both sides that were too far apart [s]; infinite without any.
  [[nodiscard]] double nearest() const { return nearest_; }
  /// Counts the images that remain unpaired at the end.
  void finish();

 private:
  using Image = mrpt::obs::CObservationImage::Ptr;
  std::optional<RecordedPair> addSingle(const Image& image);
  std::optional<RecordedPair> addDepth(const mrpt::obs::CObservation3DRangeScan& scan);
  void countUnpaired(std::size_t images);

  CameraChoice choice_;
  double tolerance_s_;
  std::map<std::string, std::size_t>& skipped_;
  std::array<std::deque<Image>, 2> waiting_;  ///< left, right
  double nearest_ = std::numeric_limits<double>::infinity();
};

/// A frame with undecoded images and its recorded boxes and pose.
struct PendingFrame {
  std::size_t index = 0;
  Time time = 0.0;
  double arrival_s = 0.0;            ///< when it was complete, by a live source's clock [s]
  std::optional<RecordedPair> pair;  ///< empty: the frame is a pose
  std::optional<Detections> detections;
  std::optional<Pose> T_map_robot;
  std::vector<LaserScan> laser_scans;
};

/// Assigns boxes, poses and laser scans to the nearest frame in time, at most half a frame interval
/// away.
///
/// Frames are numbered from 0 and returned in order, once `read_ahead` later frames are known, so
/// that boxes and poses recorded late, even after the next image, are assigned. Frames whose time
/// does not increase are dropped but keep their index, unless the third of them in succession shows
/// that the clock was set back; so is a frame whose time is more than 10 s
/// ahead, unless the next frame confirms it. Unassigned items are counted.
class FrameAssembler {
 public:
  /// @param read_ahead  number of later frames known before a frame is returned
  /// @param skipped     counts "time_backwards", "time_outlier", "unmatched_detections",
  ///                    "unmatched_pose", "laser_between_frames"
  FrameAssembler(std::size_t read_ahead, std::map<std::string, std::size_t>& skipped)
      : read_ahead_(read_ahead), skipped_(skipped) {}

  /// @param frame  without index and detections, and without pose if it has a pair
  /// @return       whether it shows that the clock was set back
  bool addFrame(PendingFrame frame);
  /// Index of the next frame that is added.
  [[nodiscard]] std::size_t nextIndex() const { return next_index_; }
  void addDetections(Detections detections) { detections_.push_back(std::move(detections)); }
  void addPose(Time time, const Pose& T_map_robot) { poses_.push_back({time, T_map_robot}); }

  /// @param scan  of each laser (label), the scan nearest to a frame is assigned to it
  void addLaserScan(LaserScan scan) { laser_scans_[scan.label].push_back(std::move(scan)); }

  /// Whether take() can return a frame before the end of the recording.
  [[nodiscard]] bool isReady() const { return ready() > 0; }
  /// Number of frames that take() can return before the end of the recording.
  [[nodiscard]] std::size_t ready() const {
    return frames_.size() > read_ahead_ ? frames_.size() - read_ahead_ : 0;
  }
  /// Number of frames stored, with those read ahead.
  [[nodiscard]] std::size_t frames() const { return frames_.size() + (ahead_ ? 1 : 0); }
  /// Number of boxes (by image), poses and laser scans stored.
  [[nodiscard]] std::size_t items() const;
  /// Removes and counts the oldest of the boxes, poses, and scans of a laser above this number.
  void limitItems(std::size_t max_count);

  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take();

  /// Counts the items that remain unassigned at the end.
  void finish();

 private:
  bool append(PendingFrame frame);
  [[nodiscard]] bool isSetBack(Time time);
  void removeItemsAfter(Time time);
  [[nodiscard]] double halfInterval(Time time) const;
  template <typename Item>
  std::optional<Item> takeNearest(std::deque<Item>& items, Time time, double half_interval,
                                  const char* unmatched);

  std::size_t read_ahead_;
  std::map<std::string, std::size_t>& skipped_;
  std::size_t next_index_ = 0;
  std::optional<Time> last_added_;
  std::optional<Time> last_taken_;
  std::optional<Time> last_backward_;  ///< of the newest frame, if its time did not increase
  int backward_frames_ = 0;            ///< that increased in succession, after the last one added
  std::deque<PendingFrame> frames_;
  std::optional<PendingFrame> ahead_;  ///< its time is not yet confirmed
  std::deque<Detections> detections_;
  std::deque<Stamped<Pose>> poses_;
  std::map<std::string, std::deque<LaserScan>> laser_scans_;  ///< by label
};

/// Assembles frames from observations: images, boxes, poses, and motion for the prior.
///
/// Without a camera, each pose is a frame.
class FrameCollector {
 public:
  /// @param skipped  counts "bad_odometry", "bad_imu", "bad_pose", "pose_jump",
  /// "bad_detections_pose",
  ///                 "laser_bad_pose", "laser_no_ranges", observations of other cameras by class
  ///                 name, those of fixFrom(), "gnss_between_frames", and the counts of
  ///                 StereoPairing and FrameAssembler
  FrameCollector(const CameraChoice& camera, const RawlogSourceOptions& options,
                 std::map<std::string, std::size_t>& skipped)
      : has_camera_(camera.kind != CameraChoice::Kind::kNone),
        left_label_(camera.labels[0]),
        skipped_(skipped),
        pairing_(camera, options.pair_tolerance_s, skipped),
        assembler_(options.read_ahead, skipped) {}

  /// @param arrival_s  time of arrival by a live source's clock, for the frame it completes [s]
  void add(const mrpt::obs::CObservation::Ptr& observation, double arrival_s = 0.0);
  /// Counts unassigned observations at the end.
  void finish();

  /// Least time between images of two cameras that are no pair [s], see StereoPairing.
  [[nodiscard]] double nearestUnpaired() const { return pairing_.nearest(); }

  /// Whether take() can return a frame before the end of the recording.
  [[nodiscard]] bool isReady() const { return assembler_.isReady(); }
  /// Number of frames that take() can return before the end of the recording.
  [[nodiscard]] std::size_t ready() const { return assembler_.ready(); }
  /// Number of frames; of boxes, poses and scans; of motion samples that are stored.
  [[nodiscard]] std::size_t frames() const { return assembler_.frames(); }
  [[nodiscard]] std::size_t items() const { return assembler_.items(); }
  [[nodiscard]] std::size_t samples() const { return prior_.samples(); }
  /// Removes the oldest samples of each motion sensor, and boxes, poses and scans of each laser,
  /// above these numbers.
  void limit(std::size_t max_samples, std::size_t max_items) {
    prior_.limitSamples(max_samples);
    assembler_.limitItems(max_items);
    limitFixes(max_items);
  }
  /// The next frame; nullopt if there is none. Before isReady(), only at the recording's end.
  [[nodiscard]] std::optional<PendingFrame> take() { return assembler_.take(); }

  /// Removes and returns the fixes of satellite receivers up to a time, in order of arrival.
  [[nodiscard]] std::vector<GnssFix> takeFixes(Time until);
  /// Motion between two times according to odometry and inertial samples.
  [[nodiscard]] MotionPrior motionBetween(std::optional<Time> previous, Time current) const {
    return prior_.between(previous, current);
  }
  /// Prolongs the motion sensors' last samples to a time, see MotionPriorBuilder.
  void extrapolateMotion(Time to, double max_s) { prior_.extrapolate(to, max_s); }
  /// Sensors with clocks of their own, see ClockCheck.
  [[nodiscard]] const Warnings& warnings() const { return warnings_; }
  /// Removes samples that are not needed for motions starting at or after this time.
  void discardMotionBefore(Time time) { prior_.discardBefore(time); }

 private:
  void compareClocks(const mrpt::obs::CObservation& observation);
  void addPair(RecordedPair pair, double arrival_s);
  [[nodiscard]] bool isReachable(Time time, const Pose& T_map_robot);
  void addPose(Time time, const Pose& T_map_robot, double arrival_s);
  void addMotion(const mrpt::obs::CObservation& observation);
  void limitFixes(std::size_t max_count);
  void addLaser(const mrpt::obs::CObservation2DRangeScan& observation);

  bool has_camera_;
  std::string left_label_;
  std::map<std::string, std::size_t>& skipped_;
  StereoPairing pairing_;
  FrameAssembler assembler_;
  MotionPriorBuilder prior_;
  std::deque<GnssFix> fixes_;  ///< not yet taken
  ClockCheck clocks_;
  Warnings warnings_;
  std::optional<Stamped<Pose>> last_pose_;     ///< recorded and used
  std::optional<Stamped<Pose>> distant_pose_;  ///< the last one, if it was too far from the former
};

}  // namespace headway::io
