#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/io/observation_queue.h>

#include <map>
#include <memory>
#include <optional>
#include <string>

namespace headway::io {

/// What to read of a rawlog, and how.
struct RawlogSourceOptions {
  /// Label of the stereo camera, or "LEFT,RIGHT" for two cameras; empty: the only one there is.
  std::string sensor_label;
  std::size_t from_index = 0;           ///< first stereo frame handed out
  std::optional<std::size_t> to_index;  ///< last stereo frame handed out (included)
  bool use_odometry = true;             ///< hand wheel odometry on as motion prior
  bool use_imu = true;                  ///< hand gyroscope and gravity on as motion prior
  /// Frames read before one is handed out, so that what is recorded late finds its frame. A robot
  /// that cannot wait, and whose boxes come before their images, takes 0.
  std::size_t read_ahead = 2;
  double pair_tolerance_s = 0.01;  ///< between a left and a right `CObservationImage` [s]
};

using headway::RecordedFrame;

/// What the images themselves say of the calibration; small vertical disparity is good.
struct CalibrationReport {
  double baseline_m = 0.0;
  double focal_px = 0.0;
  double vertical_disparity_px = 0.0;  ///< median |v_left - v_right| of matches
  double median_disparity_px = 0.0;    ///< median u_left - u_right of matches
  std::size_t matches = 0;             ///< it rests on
  bool rectified_here = false;         ///< images were not rectified in the rawlog
};

/// Streams a rawlog as rectified stereo frames, whatever way they were recorded.
///
/// Observation-only and sensory-frame rawlogs, gz or plain, images embedded or beside
/// (`X_Images/`), `CObservationStereoImages` or two `CObservationImage` labels paired by time,
/// rectified or not. One observation is in memory at a time, and frames are read ahead so that
/// boxes and poses recorded after their images, even after the next one, still find them. Where
/// images are rectified here, 2D boxes of the recorded left image are turned into the rectified
/// one; 3D boxes stay in their sensor's frame. Labels `truth_*` never come out. What cannot be used
/// is skipped and counted.
///
///     RawlogSource source("street.rawlog", {});
///     while (auto frame = source.next()) slam.process(*frame->stereo);
class RawlogSource {
 public:
  /// Opens the rawlog and reads up to its first stereo pair (or pose).
  ///
  /// @throws InputError if the file is not a rawlog, holds neither stereo nor `pose`, has several
  ///         cameras and no label was chosen, or has a calibration that cannot be used
  RawlogSource(const std::string& path, const RawlogSourceOptions& options);

  /// Reads observations as sensors push them, as if from a file: waits where there are none, and
  /// ends once the queue is closed. The queue must outlive this.
  ///
  /// @throws InputError as above, once the observations tell; waits for the first stereo pair
  RawlogSource(ObservationQueue& queue, const RawlogSourceOptions& options);
  ~RawlogSource();
  RawlogSource(RawlogSource&&) noexcept;
  RawlogSource& operator=(RawlogSource&&) noexcept;

  /// The next frame, in time order; nullopt at the end (see truncation()).
  ///
  /// Frames whose image is missing or broken, or whose time does not increase, are skipped and
  /// counted in skipped() but keep their index.
  [[nodiscard]] std::optional<RecordedFrame> next();

  /// Right image of the frame last handed out, 8-bit BGR, rectified; empty if it was grey.
  [[nodiscard]] cv::Mat rightColour() const;

  /// Camera of all frames, rectified; null if the rawlog holds poses alone.
  [[nodiscard]] std::shared_ptr<const StereoCamera> camera() const;

  /// Measured on the first stereo pair; nullopt if the rawlog holds poses alone.
  [[nodiscard]] const std::optional<CalibrationReport>& calibration() const;

  /// Observations not used, by class name or reason ("CObservation2DRangeScan",
  /// "missing_image", "time_backwards", "unknown_class", ...).
  [[nodiscard]] const std::map<std::string, std::size_t>& skipped() const;

  /// Set once the end came too early: what is broken and where. What came before is good.
  [[nodiscard]] const std::optional<std::string>& truncation() const;

  /// Share of the file read so far, 0 to 1.
  [[nodiscard]] double progress() const;

 private:
  class Reader;
  std::unique_ptr<Reader> reader_;
};

/// What a rawlog says of the truth: labels `truth_pose` and `truth_objects`.
struct RecordedTruth {
  std::vector<Stamped<Pose>> poses;  ///< robot in map
  std::vector<Detections> objects;   ///< with ids, one entry a frame
};

/// Reads the truth of a rawlog, for evaluation alone.
[[nodiscard]] RecordedTruth readTruth(const std::string& path);

}  // namespace headway::io
