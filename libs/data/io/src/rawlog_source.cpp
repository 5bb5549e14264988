// SPDX-License-Identifier: BSD-3-Clause
// Reading a rawlog, or live observations from a queue, as rectified stereo frames.
#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/core/exceptions.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "frame_collector.h"
#include "frame_decoder.h"
#include "image_files.h"
#include "observation_selection.h"
#include "observation_stream.h"

namespace headway::io {

ObservationQueue::ObservationQueue(std::size_t capacity) : capacity_(capacity) {
  ASSERTMSG_(capacity >= 1, "the queue capacity must be at least 1");
}

void ObservationQueue::push(const mrpt::obs::CObservation::Ptr& observation) {
  if (observation == nullptr) return;
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    if (waiting_.size() == capacity_) {
      waiting_.pop_front();
      ++dropped_;
    }
    waiting_.push_back(observation);
  }
  changed_.notify_one();
}

void ObservationQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

mrpt::obs::CObservation::Ptr ObservationQueue::pop() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
  if (waiting_.empty()) return nullptr;
  auto observation = waiting_.front();
  waiting_.pop_front();
  return observation;
}

std::size_t ObservationQueue::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

/// Reads, collects and decodes observations into frames.
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
      if (pending->index < options_.from_index) start_ = observations_.progress();
      if (pending->index < options_.from_index) {
        first_pair_.reset();
        collector_->discardMotionBefore(pending->time);
        (void)collector_->takeFixes(pending->time);
        continue;
      }
      last_index_ = pending->index;
      auto frame = complete(*pending);
      if (frame) return frame;
    }
    return std::nullopt;
  }

  cv::Mat rightColour() const { return decoder_.rightColour(last_pair_); }
  std::shared_ptr<const StereoCamera> camera() const { return decoder_.camera(); }
  const std::optional<CalibrationReport>& calibration() const { return decoder_.report(); }
  const std::map<std::string, std::size_t>& skipped() const { return skipped_; }
  Warnings warnings() const {
    Warnings all = collector_->warnings();
    all.insert(observations_.warnings().begin(), observations_.warnings().end());
    return all;
  }
  const std::optional<std::string>& truncation() const { return observations_.truncation(); }
  double progress() const {
    const double read = observations_.progress();
    const double by_bytes = start_ < 1.0 ? (read - start_) / (1.0 - start_) : 1.0;
    if (!options_.to_index || !last_index_) return std::clamp(by_bytes, 0.0, 1.0);
    const auto from = static_cast<double>(options_.from_index);
    const double by_frames = (static_cast<double>(*last_index_) + 1.0 - from) /
                             (static_cast<double>(*options_.to_index) + 1.0 - from);
    return std::clamp(std::max(by_bytes, by_frames), 0.0, 1.0);
  }

 private:
  /// Reads up to the first usable frame and sets the calibration.
  void open() {
    try {
      collector_.emplace(observations_.findCamera(), options_, skipped_);
      findFirstFrame();
      if (first_->pair) decoder_.calibrate(*first_->pair, *first_pair_);
    } catch (const InputError& error) {
      throw InputError(name_ + ": " + error.what());
    }
  }

  /// Reads frames until one has images or is a pose.
  void findFirstFrame() {
    std::optional<RecordedPair> broken;  // the calibration of a pair
    std::optional<DecodedPair> broken_images;
    while (auto pending = takePending()) {
      if (pending->pair && !(first_pair_ = decoder_.decode(*pending->pair))) continue;
      if (pending->pair && !hasFiniteCalibration(*pending->pair)) {
        ++skipped_["bad_calibration"];
        broken = std::move(pending->pair);
        broken_images = std::exchange(first_pair_, std::nullopt);
        continue;
      }
      first_ = std::move(pending);
      return;
    }
    if (broken) decoder_.calibrate(*broken, *broken_images);  // fails with the reason
    throw InputError("no usable frame" + skippedText() + causeOfNoFrame());
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

  /// The frame with its images; nullopt if they are unusable.
  std::optional<RecordedFrame> complete(PendingFrame& pending) {
    if (!pending.pair) {
      RecordedFrame frame = FrameDecoder::frameOf(std::move(pending));
      frame.gnss = collector_->takeFixes(frame.time);
      return frame;
    }
    auto images = std::exchange(first_pair_, std::nullopt);
    if (!images) images = decoder_.decode(*pending.pair);
    if (!images) return std::nullopt;
    last_pair_ = *images;
    try {
      decoder_.requireTwoCameras(*images);
      RecordedFrame frame = decoder_.frameOf(std::move(pending), *images);
      decoder_.requireMatching(*frame.stereo);
      return withMotion(std::move(frame));
    } catch (const InputError& error) {
      throw InputError(name_ + ": " + error.what());
    }
  }

  RecordedFrame withMotion(RecordedFrame frame) {
    frame.stereo->motion_prior = collector_->motionBetween(last_time_, frame.time);
    frame.stereo->motion_prior.previous_frame = std::exchange(last_frame_, frame.index);
    collector_->discardMotionBefore(frame.time);
    frame.gnss = collector_->takeFixes(frame.time);
    last_time_ = frame.time;
    return frame;
  }

  std::string causeOfNoFrame() const {
    if (skipped_.count("image_16_bit") > 0) {
      return ": the images have 16 bits per channel, of which headway reads 8; record or convert "
             "them with 8 bits";
    }
    const double nearest = 1e3 * collector_->nearestUnpaired();
    if (skipped_.count("unpaired_image") > 0 && std::isfinite(nearest)) {
      return ": the images of left and right are " + std::to_string(std::lround(nearest)) +
             " ms apart or more, allowed are " +
             std::to_string(std::lround(1e3 * options_.pair_tolerance_s)) +
             " ms: the cameras must be triggered together";
    }
    return "; external images are expected in " + decoder_.imageFolder();
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
  std::optional<PendingFrame> first_;      ///< read by findFirstFrame(), for next()
  std::optional<DecodedPair> first_pair_;  ///< its images
  DecodedPair last_pair_;                  ///< of the latest frame
  std::optional<Time> last_time_;          ///< of the latest frame
  std::optional<std::size_t> last_frame_;  ///< index of the same
  std::optional<std::size_t> last_index_;  ///< of the latest frame
  double start_ = 0.0;                     ///< ratio of the bytes before the first frame
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

Warnings RawlogSource::warnings() const { return reader_->warnings(); }

const std::optional<std::string>& RawlogSource::truncation() const { return reader_->truncation(); }

double RawlogSource::progress() const { return reader_->progress(); }

bool hasRawlogName(const std::string& path) {
  std::filesystem::path name(path);
  if (name.extension() == ".gz" || name.extension() == ".zst") name.replace_extension();
  return name.extension() == ".rawlog";
}

std::string rawlogStem(const std::string& path) {
  std::filesystem::path name(path);
  const bool is_compressed = name.extension() == ".gz" || name.extension() == ".zst";
  if (is_compressed && hasRawlogName(path)) name.replace_extension();
  return name.replace_extension().string();
}

std::optional<std::string> visitObservations(
    const std::string& path, std::map<std::string, std::size_t>& skipped,
    const std::function<void(const mrpt::obs::CObservation&)>& visit) {
  ObservationStream stream(path, skipped);
  while (const auto observation = stream.next()) visit(*observation);
  return stream.truncation();
}

RecordedTruth readTruth(const std::string& path) {
  RecordedTruth truth;
  std::map<std::string, std::size_t> skipped;
  ObservationStream stream(path, skipped);
  while (const auto observation = stream.next()) {
    const auto& label = observation->sensorLabel;
    const auto* pose = dynamic_cast<const mrpt::obs::CObservationRobotPose*>(observation.get());
    const auto* objects = dynamic_cast<const CObservationObjectDetections*>(observation.get());
    if (pose != nullptr && label == kTruthPoseLabel) {
      truth.poses.push_back({timeFrom(pose->timestamp), fromMrpt(pose->pose.mean)});
    } else if (objects != nullptr && label == kTruthObjectsLabel) {
      truth.objects.push_back(detectionsFrom(*objects, skipped));
    }
  }
  return truth;
}

}  // namespace headway::io
