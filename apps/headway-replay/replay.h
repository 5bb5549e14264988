// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/pipeline/perception.h>
#include <headway/program/output_folder.h>
#include <headway/report/page_images.h>

#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "checkpoint.h"
#include "frame_input.h"
#include "frame_writers.h"
#include "gnss_log.h"
#include "options.h"
#include "snapshots.h"
#include "summary.h"

namespace headway::replay {

/// Processes a rawlog and writes a folder of results.
///
/// The results computed so far are written however the run ends: end of the rawlog, Ctrl-C, or a
/// truncated file. Old results in the folder remain until the new ones are complete, and after an
/// error such as a full disk.
///
///     Replay replay(options, perception_params, params);
///     replay.run();
class Replay {
 public:
  /// Opens the rawlog and the map to continue, then prepares the output folder.
  ///
  /// @param params  the same parameters by name, for replay.json and map.headway
  /// @throws InputError
  Replay(const Options& options, const pipeline::PerceptionParams& perception_params,
         const Params& params);

  /// The same for another input, such as live sensors; options.input is for replay.json alone.
  ///
  /// @param input  not null
  Replay(const Options& options, std::unique_ptr<FrameInput> input,
         const pipeline::PerceptionParams& perception_params, const Params& params);

  /// Calls back after each frame, when its results are written; instead of a progress line.
  using FrameCallback =
      std::function<void(const RecordedFrame&, const pipeline::PerceptionUpdate&)>;
  void onFrame(FrameCallback callback) { on_frame_ = std::move(callback); }

  /// Changes parameters before the next frame.
  void change(const pipeline::RuntimeParams& params) { perception_->change(params); }
  /// Prints a warning that is no part of the summary.
  void warn(const std::string& text) const;

  /// Processes all frames and writes the results.
  ///
  /// @throws InputError after writing the results computed so far
  void run() {
    process();
    complete();
  }

  /// The first half of run(): processes all frames. An error is kept for complete().
  void process();
  /// The second half: writes the results. @throws as run()
  void complete();
  /// Between both: the beginning of the run's map was moved (pipeline::joinMaps()), so that what
  /// was written frame by frame must be moved, too.
  void moveInto(const Pose& T_map_run);

  [[nodiscard]] const Summary& summary() const { return summary_; }
  [[nodiscard]] const pipeline::Perception& perception() const { return *perception_; }
  [[nodiscard]] pipeline::Perception& perception() { return *perception_; }
  [[nodiscard]] const GnssLog& gnss() const { return gnss_; }
  /// Pictures in the folder of results.
  [[nodiscard]] std::vector<std::filesystem::path> pictures() const;

 private:
  struct SeenTrack {
    Time last_seen = 0.0;
    bool was_moving = false;  ///< at some time
  };

  /// Folder where the results are in the end.
  [[nodiscard]] std::filesystem::path published() const {
    if (options_.published.empty()) return folder_.published();
    return options_.published;
  }
  void processAll();
  void processFrame(const RecordedFrame& frame, double progress);
  [[nodiscard]] pipeline::PerceptionUpdate processed(const RecordedFrame& frame);
  void applySideDetections(RecordedFrame& frame) const;
  [[nodiscard]] Pose robotFromCamera() const;
  void count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);
  /// Counts a frame, and those that are missing before it.
  void countFrame(std::size_t frame, slam::TrackingStatus status);
  /// Counts a confirmed track once, and discards those that have ended.
  void countTracks(const pipeline::PerceptionUpdate& update);
  /// Prints each warning once, when it occurs first.
  void collectWarnings(std::size_t frame, bool reader_has_stopped);
  void requireTrackedFrames() const;
  /// Writes replay.json, and says which network is used or how to get one.
  void writeRecord(const pipeline::DetectionParams& detection, const Params& params);
  void finish();
  [[nodiscard]] Summary summarised() const;
  void writeCheckpoint();
  [[nodiscard]] CheckpointContents checkpointContents();
  /// The map with the configuration and the satellite fixes.
  [[nodiscard]] map::StoredMap storedMap() const;
  void endCheckpoint();
  void writeTrajectory();
  /// Places the map on the earth by satellite fixes, if there are any.
  void writeGeoFiles();
  void writeMap();
  /// Writes report.html and replay.html from the other files.
  void writePages();
  void warnIfNotRelocalised() const;
  /// Prints a message of the pipeline; warnings are printed by collectWarnings().
  void log(LogLevel level, const std::string& text) const;
  /// Writes the image of the first frame in which the camera is lost.
  void keepLostImage(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);

  Options options_;
  std::string configuration_;  ///< as .ini text
  std::unique_ptr<FrameInput> source_;
  std::shared_ptr<const StereoCamera> camera_;
  GnssLog gnss_;
  std::unique_ptr<pipeline::Perception> perception_;
  std::map<std::size_t, Detections> side_detections_;
  program::OutputFolder folder_;
  FrameWriters writers_;
  Checkpoint checkpoint_;
  Snapshots snapshots_;
  report::PageImages images_;
  Summary summary_;
  std::size_t last_frame_ = 0;  ///< index of the newest frame
  bool has_lost_image_ = false;
  std::exception_ptr failure_;     ///< of process()
  std::optional<Pose> T_map_run_;  ///< see moveInto()
  FrameCallback on_frame_;
  double retrack_time_s_;
  std::optional<std::size_t> next_frame_;     ///< after the newest one
  std::map<TrackId, SeenTrack> seen_tracks_;  ///< confirmed ones that may not have ended
};

}  // namespace headway::replay
