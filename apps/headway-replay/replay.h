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

/// One run: a rawlog in, a folder of results out.
///
/// Whatever ends the run (the end of the rawlog, Ctrl-C, a broken file, a full disk), what was
/// computed until then is written.
///
///     Replay replay(options, perception_params, params);
///     replay.run();
class Replay {
 public:
  /// Opens the rawlog and the map to go on in, and then makes the folder ready.
  ///
  /// @param params  the same parameters as named values, for replay.json and map.headway
  /// @throws InputError
  Replay(const Options& options, const pipeline::PerceptionParams& perception_params,
         const Params& params);

  /// Runs to the end. @throws InputError after writing what was computed
  void run();

  [[nodiscard]] const Summary& summary() const { return summary_; }
  [[nodiscard]] const std::vector<std::filesystem::path>& pictures() const {
    return snapshots_.written();
  }

 private:
  [[nodiscard]] std::unique_ptr<pipeline::FrameFeed> makeFeed();
  void processAll();
  void process(const RecordedFrame& frame, double progress);
  void takeSideDetections(RecordedFrame& frame) const;
  void count(const RecordedFrame& frame, const pipeline::PerceptionUpdate& update);
  void countLostFrames(const std::vector<slam::FrameEstimate>& trajectory);
  void finish();
  void summarise(const std::vector<slam::FrameEstimate>& trajectory);
  void writeMap(const std::vector<slam::FrameEstimate>& trajectory);
  void warnIfNeverRecognised(const std::vector<slam::FrameEstimate>& trajectory) const;
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
  std::atomic<double> progress_{0.0};
  std::map<TrackId, bool> seen_tracks_;  ///< confirmed ones -> ever moving
};

}  // namespace headway::replay
