#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>

#include <chrono>
#include <utility>

#include "frame_collector.h"
#include "frame_decoder.h"
#include "live_observations.h"
#include "observation_stream.h"
#include "recorded_image.h"
#include "useful_observations.h"

namespace headway::io {

/// Observations become frames here: read, collected, decoded.
class RawlogSource::Reader {
 public:
  Reader(const std::string& path, const RawlogSourceOptions& options)
      : name_(path),
        options_(options),
        observations_(std::make_unique<ObservationStream>(path, skipped_), options, skipped_),
        decoder_(imageFolderOf(path), skipped_) {
    open();
  }

  Reader(ObservationQueue& queue, const RawlogSourceOptions& options)
      : name_("live observations"),
        options_(options),
        observations_(std::make_unique<LiveObservations>(queue), options, skipped_),
        decoder_("", skipped_) {
    open();
  }

  std::optional<RecordedFrame> next() {
    while (auto pending = takePending()) {
      if (options_.to_index && pending->index > *options_.to_index) return std::nullopt;
      if (pending->index < options_.from_index) {
        first_pair_.reset();
        collector_->forgetMotionBefore(pending->time);
        continue;
      }
      auto frame = complete(*pending);
      if (frame) return frame;
    }
    return std::nullopt;
  }

  cv::Mat rightColour() const { return decoder_.rightColour(last_pair_); }
  std::shared_ptr<const StereoCamera> camera() const { return decoder_.camera(); }
  const std::optional<CalibrationReport>& calibration() const { return decoder_.report(); }
  const std::map<std::string, std::size_t>& skipped() const { return skipped_; }
  const std::optional<std::string>& truncation() const { return observations_.truncation(); }
  double progress() const { return observations_.progress(); }

 private:
  /// Goes as far as the first good frame, and learns the calibration from it.
  void open() {
    try {
      collector_.emplace(observations_.findCamera(), options_, skipped_);
      findFirstFrame();
      if (first_->pair) decoder_.calibrate(*first_->pair, *first_pair_);
    } catch (const InputError& error) {
      throw InputError(name_ + ": " + error.what());
    }
  }

  /// Takes frames until one has images, or is a pose.
  void findFirstFrame() {
    while (auto pending = takePending()) {
      if (!pending->pair || (first_pair_ = decoder_.decode(*pending->pair))) {
        first_ = std::move(pending);
        return;
      }
    }
    throw InputError("no frame can be used" + skippedText() +
                     "; images beside the rawlog are looked for in " + decoder_.imageFolder());
  }

  std::optional<PendingFrame> takePending() {
    if (first_) return std::exchange(first_, std::nullopt);
    while (!collector_->isReady()) {
      const auto observation = observations_.next();
      if (!observation) break;
      collector_->add(observation);
    }
    auto frame = collector_->take();
    if (!frame) collector_->finish();
    return frame;
  }

  /// The frame with its images; nullopt if they cannot be used.
  std::optional<RecordedFrame> complete(PendingFrame& pending) {
    RecordedFrame frame;
    frame.index = pending.index;
    frame.time = pending.time;
    frame.T_map_robot = pending.T_map_robot;
    frame.detections = std::move(pending.detections);
    if (!pending.pair) return frame;
    auto images = std::exchange(first_pair_, std::nullopt);
    if (!images) images = decoder_.decode(*pending.pair);
    if (!images) return std::nullopt;
    last_pair_ = *images;
    const auto start = std::chrono::steady_clock::now();
    frame.stereo = decoder_.stereoFrame(*images);
    frame.rectify_ms =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    frame.stereo->index = pending.index;
    frame.stereo->time = pending.time;
    frame.stereo->motion_prior = collector_->motionBetween(last_time_, pending.time);
    collector_->forgetMotionBefore(pending.time);
    last_time_ = pending.time;
    if (frame.detections) decoder_.rectifyBoxes(*frame.detections);
    return frame;
  }

  std::string skippedText() const {
    std::string text;
    for (const auto& [reason, count] : skipped_) {
      text += (text.empty() ? " (" : ", ") + reason + ": " + std::to_string(count);
    }
    return text.empty() ? text : text + ")";
  }

  std::string name_;  ///< for messages
  RawlogSourceOptions options_;
  std::map<std::string, std::size_t> skipped_;
  UsefulObservations observations_;
  std::optional<FrameCollector> collector_;  ///< from open() on
  FrameDecoder decoder_;
  std::optional<PendingFrame> first_;      ///< taken by findFirstFrame(), to come out
  std::optional<DecodedPair> first_pair_;  ///< its images
  DecodedPair last_pair_;                  ///< of the frame handed out last
  std::optional<Time> last_time_;          ///< likewise
};

RawlogSource::RawlogSource(const std::string& path, const RawlogSourceOptions& options)
    : reader_(std::make_unique<Reader>(path, options)) {}
RawlogSource::RawlogSource(ObservationQueue& queue, const RawlogSourceOptions& options)
    : reader_(std::make_unique<Reader>(queue, options)) {}
RawlogSource::~RawlogSource() = default;
RawlogSource::RawlogSource(RawlogSource&&) noexcept = default;
RawlogSource& RawlogSource::operator=(RawlogSource&&) noexcept = default;

std::optional<RecordedFrame> RawlogSource::next() { return reader_->next(); }

cv::Mat RawlogSource::rightColour() const { return reader_->rightColour(); }

std::shared_ptr<const StereoCamera> RawlogSource::camera() const { return reader_->camera(); }

const std::optional<CalibrationReport>& RawlogSource::calibration() const {
  return reader_->calibration();
}

const std::map<std::string, std::size_t>& RawlogSource::skipped() const {
  return reader_->skipped();
}

const std::optional<std::string>& RawlogSource::truncation() const { return reader_->truncation(); }

double RawlogSource::progress() const { return reader_->progress(); }

}  // namespace headway::io
