// SPDX-License-Identifier: BSD-3-Clause
// Reading a rawlog, or live observations from a queue, as rectified stereo frames.
#pragma once

#include <headway/core/log.h>
#include <headway/core/recorded_frame.h>
#include <mrpt/obs/CObservation.h>

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace headway::io {

/// Queue of observations from sensor callbacks to the perception thread.
///
/// push() never blocks: if the queue is full, the oldest observation is dropped and counted. Any
/// number of threads may push; one thread pops.
///
///     ObservationQueue queue;
///     driver.onObservation([&](const auto& observation) { queue.push(observation); });
///     RawlogSource source(queue, {});  // in the perception thread
class ObservationQueue {
 public:
  /// @param capacity  maximum number of waiting observations, >= 1
  explicit ObservationQueue(std::size_t capacity = 200);

  /// Adds an observation; null pointers and calls after close() are ignored.
  void push(const mrpt::obs::CObservation::Ptr& observation);

  /// Ends the input: pop() returns the waiting observations, then null.
  void close();

  /// Waits for the next observation; null once the queue is closed and empty.
  [[nodiscard]] mrpt::obs::CObservation::Ptr pop();

  /// Number of observations dropped because the queue was full.
  [[nodiscard]] std::size_t dropped() const;

 private:
  std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<mrpt::obs::CObservation::Ptr> waiting_;  ///< guarded by mutex_, like the members below
  std::size_t dropped_ = 0;
  bool closed_ = false;
};

/// Selection and options of RawlogSource.
struct RawlogSourceOptions {
  /// Label of the stereo camera, or "LEFT,RIGHT" for two cameras; empty: the only one.
  std::string sensor_label;
  std::size_t from_index = 0;           ///< first stereo frame returned
  std::optional<std::size_t> to_index;  ///< last stereo frame returned (inclusive)
  bool use_odometry = true;             ///< use wheel odometry as motion prior
  bool use_imu = true;                  ///< use gyroscope and gravity as motion prior
  bool use_laser = false;               ///< return 2D laser scans with the frames
  /// Number of later frames read before a frame is returned, so that boxes and poses recorded late
  /// are assigned. 0 for live operation with boxes that arrive before their images.
  std::size_t read_ahead = 2;
  double pair_tolerance_s = 0.01;  ///< between a left and a right `CObservationImage` [s]
};

using headway::RecordedFrame;

/// Consistency of images and calibration; the vertical disparity should be near 0.
struct CalibrationReport {
  double baseline_m = 0.0;
  double focal_px = 0.0;
  double vertical_disparity_px = 0.0;  ///< median |v_left - v_right| of matches
  double median_disparity_px = 0.0;    ///< median u_left - u_right of matches
  double row_offset_px = 0.0;          ///< median v_left - v_right of matches
  std::size_t corners = 0;             ///< of the image that has fewer
  std::size_t matches = 0;             ///< number of matches used
  bool rectified_here = false;         ///< the recorded images were not rectified
  bool is_depth_camera = false;        ///< nothing is matched; the baseline is the equivalent one
  double depth_ratio = 0.0;            ///< of the first image's pixels, those with depth
};

/// Reads a rawlog as a stream of rectified stereo frames.
///
/// Supports observation-only and sensory-frame rawlogs, gz or plain, images embedded or external
/// (`X_Images/`), `CObservationStereoImages`, two `CObservationImage` labels paired by time, or
/// `CObservation3DRangeScan` with intensity and depth; rectified and registered or not. One
/// observation is in memory at a time; frames are read ahead so that boxes and poses recorded after
/// their images, even after the next image, are assigned to them. Of each 2D laser, the scan
/// nearest in time is assigned, at most half a frame interval away. With images that are rectified
/// here, 2D boxes of the left image are rectified too; 3D boxes remain in their sensor's frame.
/// Observations labelled `truth_*` are never returned. Unusable observations are skipped and
/// counted.
///
///     RawlogSource source("street.rawlog", {});
///     while (auto frame = source.next()) slam.process(*frame->stereo);
class RawlogSource {
 public:
  /// Opens the rawlog and reads it up to the first stereo pair (or pose).
  ///
  /// @throws InputError if the file is not a rawlog, contains neither stereo images nor `pose`,
  ///         contains several cameras without a selection, or has an invalid calibration
  RawlogSource(const std::string& path, const RawlogSourceOptions& options);

  /// Reads live observations from a queue, which must outlive this object. Waits for the first
  /// stereo pair; next() waits for observations and ends when the queue is closed.
  ///
  /// @throws InputError as above
  RawlogSource(ObservationQueue& queue, const RawlogSourceOptions& options);
  ~RawlogSource();
  RawlogSource(RawlogSource&&) noexcept;
  RawlogSource& operator=(RawlogSource&&) noexcept;

  /// The next frame; nullopt at the end (see truncation()) and after requestStop().
  ///
  /// Times increase, unless the clock was set back, which three frames in succession have to show.
  /// Frames whose image is missing or broken, or whose time does not increase, are skipped and
  /// counted in skipped() but keep their index.
  [[nodiscard]] std::optional<RecordedFrame> next();

  /// Right image of the latest frame, 8-bit BGR, rectified; empty if it is grey.
  [[nodiscard]] cv::Mat rightColour() const;

  /// Rectified camera of all frames; null if the rawlog contains only poses.
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const;

  /// Measured on the first stereo pair; nullopt if the rawlog contains only poses.
  [[nodiscard]] const std::optional<CalibrationReport>& calibration() const;

  /// Number of skipped observations by class name or reason ("CObservation2DRangeScan",
  /// "missing_image", "time_backwards", "unknown_class", "laser_no_ranges", ...).
  [[nodiscard]] const std::map<std::string, std::size_t>& skipped() const;

  /// Sensors whose times are of another clock than the images': "clocks_differ_LABEL".
  [[nodiscard]] Warnings warnings() const;

  /// Reason and position of a premature end; nullopt otherwise. Frames before it are valid.
  [[nodiscard]] const std::optional<std::string>& truncation() const;

  /// Ratio of the frames from the first to the last one that are read so far, 0 to 1: by their
  /// number if `to_index` is given, by the bytes of the rawlog otherwise.
  [[nodiscard]] double progress() const;

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

/// Whether a file is named as a rawlog: X.rawlog, X.rawlog.gz or X.rawlog.zst.
[[nodiscard]] bool hasRawlogName(const std::string& path);

/// The path without that ending: folders that belong to a rawlog are X_Images and X.truth.
[[nodiscard]] std::string rawlogStem(const std::string& path);

/// How corners of a pair are matched to measure its calibration.
struct CalibrationMatching {
  int corner_threshold = 20;              ///< of FAST [grey levels]
  int patch_radius_px = 5;                ///< of the compared patches
  int cells_across = 16, cells_down = 8;  ///< of the image, for evenly distributed corners
  std::size_t corners_per_cell = 8;       ///< at most
  double row_band_px = 4.0;               ///< between the rows of a match
  double max_disparity_ratio = 0.25;      ///< of the image's width
  float min_correlation = 0.9F;           ///< of a match
  float min_margin = 0.05F;               ///< to the correlation of the second best
  int neighbour_px = 3;                   ///< corners as near as that show the same point
};

/// Why pairs are refused that have nothing in common.
inline constexpr char kNothingMatches[] =
    "nothing matches: the cameras see different things, or are not synchronised";

/// Measures the consistency of a rectified image pair with its calibration.
///
/// Corners of both images are matched along rows in both directions, so that swapped images have a
/// negative median disparity. Takes a few milliseconds.
///
/// @param left, right  rectified, 8-bit grey
/// @return             medians are 0 without matches
[[nodiscard]] CalibrationReport measureCalibration(const cv::Mat& left, const cv::Mat& right,
                                                   const StereoCamera& camera,
                                                   const CalibrationMatching& params = {});

/// Reads the observations of a rawlog one by one, truth included, without decoding images that are
/// stored beside it.
///
/// @param skipped  counts objects that cannot be read
/// @return         the reason if the rawlog is truncated
/// @throws InputError if it is no rawlog
std::optional<std::string> visitObservations(
    const std::string& path, std::map<std::string, std::size_t>& skipped,
    const std::function<void(const mrpt::obs::CObservation&)>& visit);

/// The truth in a rawlog: labels `truth_pose` and `truth_objects`.
struct RecordedTruth {
  std::vector<Stamped<Pose>> poses;  ///< robot in map
  std::vector<Detections> objects;   ///< with ids, one entry per frame
};

/// Reads the truth of a rawlog, for evaluation only.
[[nodiscard]] RecordedTruth readTruth(const std::string& path);

}  // namespace headway::io
