// SPDX-License-Identifier: BSD-3-Clause
// A run over a rawlog or live sensors, with its folder of results.
#pragma once

#include <headway/core/error.h>
#include <headway/pipeline/perception.h>
#include <headway/program/files.h>
#include <headway/program/progress.h>
#include <headway/report/replay_page.h>
#include <headway/run/session.h>

#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geo_files.h"
#include "result_files.h"
#include "snapshots.h"
#include "summary.h"

namespace headway::replay {

/// Checks the value of --detector. @throws program::UsageError
void checkDetector(const std::string& names);

/// The rawlog ends early; the part before was processed and its results are published.
class TruncatedInput : public InputError {
 public:
  using InputError::InputError;
};

/// Processes a rawlog, or live sensors, and writes a folder of results: a session with the sink of
/// all files.
///
/// The results computed so far are written however the run ends: end of the rawlog, Ctrl-C, or a
/// truncated file. Old results in the folder remain until the new ones are complete, and after an
/// error such as a full disk.
///
///     Replay replay(options, perception_params, params);
///     replay.run();
class Replay : private run::Sink {
 public:
  /// Opens the rawlog and the map to continue, then prepares the output folder.
  ///
  /// @param params  the same parameters by name, for replay.json and map.headway
  /// @throws InputError
  Replay(const Options& options, const pipeline::PerceptionParams& perception_params,
         const Params& params);

  /// The same for another input, such as live sensors; options.input is for replay.json alone.
  ///
  /// @param source  not null
  Replay(const Options& options, std::unique_ptr<run::Source> source,
         const pipeline::PerceptionParams& perception_params, const Params& params);

  /// Adds a sink, called when a frame's results are written.
  void add(run::Sink& sink) { session_.add(sink); }

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

  [[nodiscard]] const std::string& configuration() const { return configuration_; }
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
  void onFrame(const run::FrameResult& result, pipeline::Perception& perception) override;
  void onEnd(const std::optional<std::string>& failure) override;
  void onComplete(pipeline::Perception& perception) override;
  /// Measures the start-up, and replaces the boxes by those of a side file.
  void prepare(RecordedFrame& frame);
  [[nodiscard]] Pose robotFromCamera() const;
  /// The camera with its mounting so far.
  void writeCalibration() const;
  void count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);
  /// Counts a frame, and those that are missing before it.
  void countFrame(std::size_t frame, slam::TrackingStatus status);
  /// Counts a confirmed track once, and discards those that have ended.
  void countTracks(const pipeline::PerceptionUpdate& update);
  /// Prints each warning once, when it occurs first.
  void collectWarnings(std::size_t frame, const run::SourceReport& source);
  /// @throws InputError if the results are empty, or their times are none
  void requireTrackedFrames() const;
  /// Writes replay.json, and says which network is used or how to get one.
  void writeRecord(const pipeline::DetectionParams& detection, const Params& params);
  [[nodiscard]] Summary summarised() const;
  [[nodiscard]] CheckpointContents checkpointContents();
  /// The map with the configuration and the satellite fixes.
  [[nodiscard]] map::StoredMap storedMap() const;
  void writeTrajectory();
  /// Places the map on the earth by satellite fixes, if there are any.
  void writeGeoFiles();
  void writeMap();
  /// Writes report.html and replay.html from the other files.
  void writePages();
  void warnIfNotRelocalised() const;
  void warn(const std::string& text) const;
  /// Prints a message of the pipeline; warnings are printed by collectWarnings().
  void log(LogLevel level, const std::string& text) const;
  /// Writes the image of the first frame in which the camera is lost.
  void keepLostImage(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);

  Options options_;
  std::string configuration_;  ///< as .ini text
  std::unique_ptr<run::Source> source_;
  GnssLog gnss_;
  std::unique_ptr<pipeline::Perception> perception_;
  std::map<std::size_t, Detections> side_detections_;
  program::OutputFolder folder_;
  FrameWriters writers_;
  Checkpoint checkpoint_;
  Snapshots snapshots_;
  report::PageImages images_;
  Summary summary_;
  std::size_t last_frame_ = 0;     ///< index of the newest frame
  std::optional<Time> last_time_;  ///< of that frame
  bool has_advanced_ = false;      ///< some frame came after the one before
  bool has_lost_image_ = false;
  std::optional<Pose> T_map_run_;              ///< see moveInto()
  std::optional<program::Progress> progress_;  ///< while frames are processed
  double retrack_time_s_;
  std::optional<std::size_t> next_frame_;     ///< after the newest one
  std::map<TrackId, SeenTrack> seen_tracks_;  ///< confirmed ones that may not have ended
  run::Session session_;
};

}  // namespace headway::replay
