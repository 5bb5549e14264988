#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <chrono>
#include <deque>
#include <utility>

#include "camera_choice.h"
#include "frame_assembler.h"
#include "frame_decoder.h"
#include "motion_prior.h"
#include "observation_stream.h"
#include "recorded_image.h"
#include "recorded_labels.h"
#include "stereo_pairing.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

/// The inertial sample in the robot frame.
InertialSample sampleFrom(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  const Eigen::Matrix3d R_robot_sensor = fromMrpt(imu.sensorPose).linear();
  const auto vector = [&](TIMUDataIndex x, TIMUDataIndex y,
                          TIMUDataIndex z) -> std::optional<Eigen::Vector3d> {
    if (!imu.has(x) || !imu.has(y) || !imu.has(z)) return std::nullopt;
    const Eigen::Vector3d value(imu.get(x), imu.get(y), imu.get(z));
    if (!value.allFinite()) return std::nullopt;
    return Eigen::Vector3d(R_robot_sensor * value);
  };
  return {timeFrom(imu.timestamp), vector(IMU_WX, IMU_WY, IMU_WZ),
          vector(IMU_X_ACC, IMU_Y_ACC, IMU_Z_ACC)};
}

template <typename Kind>
bool isKind(const CObservation& observation) {
  return dynamic_cast<const Kind*>(&observation) != nullptr;
}

bool isImage(const CObservation& observation) {
  return isKind<mrpt::obs::CObservationStereoImages>(observation) ||
         isKind<mrpt::obs::CObservationImage>(observation);
}

bool isMotion(const CObservation& observation) {
  return isKind<mrpt::obs::CObservationOdometry>(observation) ||
         isKind<mrpt::obs::CObservationIMU>(observation);
}

// Observations kept until the camera is known.
constexpr std::size_t kMostProbedImages = 16;
constexpr std::size_t kMostProbedMotions = 2000;

/// Observations that sensors push.
class LiveObservations : public ObservationReader {
 public:
  explicit LiveObservations(ObservationQueue& queue) : queue_(queue) {}
  CObservation::Ptr next() override { return queue_.pop(); }
  [[nodiscard]] const std::optional<std::string>& truncation() const override { return none_; }
  [[nodiscard]] double progress() const override { return 0.0; }

 private:
  ObservationQueue& queue_;
  std::optional<std::string> none_;
};

}  // namespace

/// Observations become frames here.
class RawlogSource::Reader {
 public:
  Reader(const std::string& path, const RawlogSourceOptions& options)
      : path_(path),
        options_(options),
        stream_(std::make_unique<ObservationStream>(path, skipped_)),
        assembler_(options.read_ahead, skipped_),
        decoder_(imageFolderOf(path), skipped_) {
    open();
  }

  Reader(ObservationQueue& queue, const RawlogSourceOptions& options)
      : path_("live observations"),
        options_(options),
        stream_(std::make_unique<LiveObservations>(queue)),
        assembler_(options.read_ahead, skipped_),
        decoder_("", skipped_) {
    open();
  }

  std::optional<RecordedFrame> next() {
    while (auto pending = takePending()) {
      if (options_.to_index && pending->index > *options_.to_index) return std::nullopt;
      if (pending->index < options_.from_index) {
        first_pair_.reset();
        prior_.forgetBefore(pending->time);
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
  const std::optional<std::string>& truncation() const { return stream_->truncation(); }
  double progress() const { return stream_->progress(); }

 private:
  /// Goes as far as the first good frame.
  void open() {
    const CameraChoice choice = probe();
    holds_images_ = choice.kind != CameraChoice::Kind::kNone;
    pairing_.emplace(choice, options_.pair_tolerance_s, skipped_);
    findFirstFrame();
  }

  /// Reads on until it is clear which camera is meant, keeping what will be needed.
  CameraChoice probe() {
    CameraProbe camera_probe(options_.sensor_label);
    while (!camera_probe.isDecided()) {
      auto observation = nextOfUse();
      if (!observation) break;
      camera_probe.add(*observation);
      probed_.push_back(std::move(observation));
      forgetProbed(kMostProbedImages, isImage);
      forgetProbed(kMostProbedMotions, isMotion);
    }
    try {
      return camera_probe.choose(skipped_);
    } catch (const InputError& error) {
      const auto& truncation = stream_->truncation();
      throw InputError(path_ + ": " + error.what() + (truncation ? "; " + *truncation : ""));
    }
  }

  /// Keeps the memory bounded where it takes long until the camera is known: of the observations of
  /// one kind only the last ones stay.
  void forgetProbed(std::size_t most, bool (*isOfKind)(const CObservation&)) {
    const auto matches = [&](const auto& observation) { return isOfKind(*observation); };
    if (!matches(probed_.back())) return;
    if (static_cast<std::size_t>(std::count_if(probed_.begin(), probed_.end(), matches)) <= most) {
      return;
    }
    const auto oldest = std::find_if(probed_.begin(), probed_.end(), matches);
    countClass(**oldest);
    probed_.erase(oldest);
  }

  /// Takes frames until one has images, and learns the calibration from it.
  void findFirstFrame() {
    while (auto pending = takePending()) {
      if (!pending->pair || (first_pair_ = decoder_.decode(*pending->pair))) {
        first_ = std::move(pending);
        break;
      }
    }
    if (!first_) {
      throw InputError(path_ + ": no frame can be used" + skippedText() +
                       "; images beside the rawlog are looked for in " + decoder_.imageFolder());
    }
    if (!first_->pair) return;
    try {
      decoder_.calibrate(*first_->pair, *first_pair_);
    } catch (const InputError& error) {
      throw InputError(path_ + ": " + error.what());
    }
  }

  std::optional<PendingFrame> takePending() {
    if (first_) return std::exchange(first_, std::nullopt);
    while (!assembler_.isReady()) {
      const auto observation = nextObservation();
      if (!observation) break;
      dispatch(observation);
    }
    auto frame = assembler_.take();
    if (!frame) {
      pairing_->finish();
      assembler_.finish();
    }
    return frame;
  }

  CObservation::Ptr nextObservation() {
    if (probed_.empty()) return nextOfUse();
    auto observation = probed_.front();
    probed_.pop_front();
    return observation;
  }

  /// The next observation that estimators may see and that can be of use.
  CObservation::Ptr nextOfUse() {
    while (auto observation = stream_->next()) {
      if (isTruth(observation->sensorLabel)) {
        ++skipped_["truth"];
      } else if (observation->timestamp == INVALID_TIMESTAMP) {
        ++skipped_["no_time"];
      } else if (isOfUse(*observation)) {
        return observation;
      } else {
        countClass(*observation);
      }
    }
    return nullptr;
  }

  bool isOfUse(const CObservation& observation) const {
    return isImage(observation) || isRecordedPose(observation) ||
           isRecordedDetections(observation) ||
           (options_.use_imu && isKind<mrpt::obs::CObservationIMU>(observation)) ||
           (options_.use_odometry && isKind<mrpt::obs::CObservationOdometry>(observation));
  }

  void dispatch(const CObservation::Ptr& observation) {
    const Time time = timeFrom(observation->timestamp);
    if (pairing_->accepts(*observation)) {
      if (auto pair = pairing_->add(observation)) addPair(std::move(*pair));
    } else if (isRecordedDetections(*observation)) {
      const auto& recorded = dynamic_cast<const CObservationObjectDetections&>(*observation);
      assembler_.addDetections(detectionsFrom(recorded, skipped_));
    } else if (isRecordedPose(*observation)) {
      const auto& recorded = dynamic_cast<const mrpt::obs::CObservationRobotPose&>(*observation);
      addPose(time, fromMrpt(recorded.pose.mean));
    } else if (isMotion(*observation) && holds_images_) {
      addMotion(time, *observation);
    } else {
      countClass(*observation);
    }
  }

  void addMotion(Time time, const CObservation& observation) {
    if (const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation)) {
      prior_.addInertial(sampleFrom(*imu));
      return;
    }
    const auto& odometry = dynamic_cast<const mrpt::obs::CObservationOdometry&>(observation);
    const Pose T_odom_robot = fromMrpt(mrpt::poses::CPose3D(odometry.odometry));
    if (T_odom_robot.matrix().allFinite()) {
      prior_.addOdometry(time, T_odom_robot);
    } else {
      ++skipped_["bad_odometry"];
    }
  }

  void addPair(RecordedPair pair) {
    PendingFrame frame;
    frame.time = pair.time;
    frame.pair = std::move(pair);
    assembler_.addFrame(std::move(frame));
  }

  void addPose(Time time, const Pose& T_map_robot) {
    if (!T_map_robot.matrix().allFinite()) {
      ++skipped_["bad_pose"];
    } else if (holds_images_) {
      assembler_.addPose(time, T_map_robot);
    } else {
      PendingFrame frame;
      frame.time = time;
      frame.T_map_robot = T_map_robot;
      assembler_.addFrame(std::move(frame));
    }
  }

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
    frame.stereo->motion_prior = prior_.between(last_time_, pending.time);
    prior_.forgetBefore(pending.time);
    last_time_ = pending.time;
    if (frame.detections) decoder_.rectifyBoxes(*frame.detections);
    return frame;
  }

  void countClass(const CObservation& observation) {
    ++skipped_[shortClassName(observation.GetRuntimeClass()->className)];
  }

  std::string skippedText() const {
    std::string text;
    for (const auto& [reason, count] : skipped_) {
      text += (text.empty() ? " (" : ", ") + reason + ": " + std::to_string(count);
    }
    return text.empty() ? text : text + ")";
  }

  std::string path_;
  RawlogSourceOptions options_;
  std::map<std::string, std::size_t> skipped_;
  std::unique_ptr<ObservationReader> stream_;
  std::deque<CObservation::Ptr> probed_;  ///< read by probe(), to be dispatched
  bool holds_images_ = false;
  std::optional<StereoPairing> pairing_;
  FrameAssembler assembler_;
  FrameDecoder decoder_;
  MotionPriorBuilder prior_;
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
