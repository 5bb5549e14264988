#pragma once

#include <headway/io/rawlog_source.h>
#include <headway/pipeline/frame_feed.h>
#include <headway/pipeline/perception.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "frame_writers.h"
#include "options.h"
#include "snapshots.h"
#include "summary.h"

namespace headway::replay {

/// Processes a rawlog and writes a folder of results.
///
/// The results computed so far are written however the run ends: end of the rawlog, Ctrl-C, a
/// truncated file or a full disk.
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

  /// Processes all frames. @throws InputError after writing the results computed so far
  void run();

  [[nodiscard]] const Summary& summary() const { return summary_; }
  [[nodiscard]] const std::vector<std::filesystem::path>& pictures() const {
    return snapshots_.written();
  }

 private:
  [[nodiscard]] std::unique_ptr<pipeline::FrameFeed> makeFeed();
  void processAll();
  void process(const RecordedFrame& frame, double progress);
  [[nodiscard]] pipeline::PerceptionUpdate processed(const RecordedFrame& frame);
  void applySideDetections(RecordedFrame& frame) const;
  void count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);
  /// Prints each warning once, when it occurs first.
  void collectWarnings(std::size_t frame, bool reader_has_stopped);
  void requireTrackedFrames() const;
  void countLostFrames(const std::vector<slam::FrameEstimate>& trajectory);
  void finish();
  void summarise(const std::vector<slam::FrameEstimate>& trajectory);
  void writeMap(const std::vector<slam::FrameEstimate>& trajectory);
  void warnIfNotRelocalised(const std::vector<slam::FrameEstimate>& trajectory) const;
  void warn(const std::string& text) const;

  Options options_;
  std::string configuration_;  ///< as .ini text
  io::RawlogSource source_;
  std::shared_ptr<const StereoCamera> camera_;
  std::unique_ptr<pipeline::Perception> perception_;
  std::map<std::size_t, Detections> side_detections_;
  std::filesystem::path folder_;
  FrameWriters writers_;
  Snapshots snapshots_;
  Summary summary_;
  std::size_t last_frame_ = 0;  ///< index of the newest frame
  std::atomic<double> progress_{0.0};
  std::map<TrackId, bool> seen_tracks_;  ///< confirmed tracks -> moving at some time
};

}  // namespace headway::replay
