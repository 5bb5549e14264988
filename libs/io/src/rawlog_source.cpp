#include <headway/core/error.h>
#include <headway/io/detection_observation.h>
#include <headway/io/mrpt_conversions.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationRobotPose.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <deque>
#include <utility>

#include "calibration_report.h"
#include "camera_choice.h"
#include "frame_assembler.h"
#include "motion_prior.h"
#include "observation_stream.h"
#include "recorded_image.h"
#include "recorded_labels.h"
#include "rectifier.h"
#include "stereo_pairing.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;

/// The inertial sample in the robot frame.
InertialSample sampleFrom(const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  const Eigen::Matrix3d R_robot_sensor = poseFrom(imu.sensorPose).linear();
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

bool isImage(const CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr;
}

struct DecodedPair {
  cv::Mat left;
  cv::Mat right;
};

bool isMotion(const CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation) != nullptr;
}

// Observations kept until the camera is known.
constexpr std::size_t kMostProbedImages = 16;
constexpr std::size_t kMostProbedMotions = 2000;

}  // namespace

/// Observations become frames here; the constructor goes as far as the first good one.
class RawlogSource::Reader {
 public:
  Reader(const std::string& path, const RawlogSourceOptions& options)
      : path_(path),
        options_(options),
        image_folder_(imageFolderOf(path)),
        stream_(path, skipped_),
        assembler_(skipped_) {
    const CameraChoice choice = probe();
    holds_images_ = choice.kind != CameraChoice::Kind::kNone;
    pairing_.emplace(choice, options_.pair_tolerance_s, skipped_);
    findFirstFrame();
  }

  std::optional<RecordedFrame> next() {
    while (auto pending = takePending()) {
      if (options_.to_index && pending->index > *options_.to_index) return std::nullopt;
      if (pending->index < options_.from_index) {
        first_pair_.reset();
        continue;
      }
      auto frame = complete(*pending);
      if (frame) return frame;
    }
    return std::nullopt;
  }

  cv::Mat rightColour() const {
    if (last_right_.channels() != 3) return {};
    return rectifier_->rectify(Rectifier::kRight, last_right_);
  }

  std::shared_ptr<const StereoCamera> camera() const { return camera_; }
  const std::optional<CalibrationReport>& calibration() const { return calibration_; }
  const std::map<std::string, std::size_t>& skipped() const { return skipped_; }
  const std::optional<std::string>& truncation() const { return stream_.truncation(); }
  double progress() const { return stream_.progress(); }

 private:
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
      const auto& truncation = stream_.truncation();
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
      if (!pending->pair || (first_pair_ = decode(*pending))) {
        first_ = std::move(pending);
        break;
      }
    }
    if (!first_) {
      throw InputError(path_ + ": no frame can be used" + skippedText() +
                       "; images beside the rawlog are looked for in " + image_folder_);
    }
    if (!first_->pair) return;
    try {
      calibrate(*first_->pair, *first_pair_);
    } catch (const InputError& error) {
      throw InputError(path_ + ": " + error.what());
    }
  }

  void calibrate(const RecordedPair& recorded, const DecodedPair& images) {
    RawStereoCamera raw = rawCameraOf(recorded);
    if (images.left.size() != cv::Size(raw.left.width, raw.left.height)) {
      throw InputError("stereo calibration: is for images of " + std::to_string(raw.left.width) +
                       "x" + std::to_string(raw.left.height) + " px, but they have " +
                       std::to_string(images.left.cols) + "x" + std::to_string(images.left.rows));
    }
    rectifier_.emplace(raw);
    camera_ = std::make_shared<const StereoCamera>(rectifier_->camera());
    calibration_ =
        measureCalibration(rectifier_->rectify(Rectifier::kLeft, greyOf(images.left)),
                           rectifier_->rectify(Rectifier::kRight, greyOf(images.right)), *camera_);
    calibration_->rectified_here = !rectifier_->passesThrough();
    requireNotSwapped(*calibration_);
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
    while (auto observation = stream_.next()) {
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
           (options_.use_imu && dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation)) ||
           (options_.use_odometry &&
            dynamic_cast<const mrpt::obs::CObservationOdometry*>(&observation));
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
      addPose(time, poseFrom(recorded.pose.mean));
    } else if (const auto* imu =
                   dynamic_cast<const mrpt::obs::CObservationIMU*>(observation.get())) {
      prior_.addInertial(sampleFrom(*imu));
    } else if (const auto* odometry =
                   dynamic_cast<const mrpt::obs::CObservationOdometry*>(observation.get())) {
      prior_.addOdometry(time, poseFrom(mrpt::poses::CPose3D(odometry->odometry)));
    } else {
      countClass(*observation);
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

  /// The images of the pair; nullopt, and counted, if one is missing or broken.
  std::optional<DecodedPair> decode(const PendingFrame& pending) {
    if (first_pair_) return std::exchange(first_pair_, std::nullopt);
    DecodedPair result;
    const std::array<std::pair<const mrpt::img::CImage*, cv::Mat*>, 2> sides = {
        {{&pending.pair->left, &result.left}, {&pending.pair->right, &result.right}}};
    for (const auto& [recorded, pixels] : sides) {
      const auto loaded = pixelsOf(*recorded, image_folder_);
      if (const auto* reason = std::get_if<std::string>(&loaded)) {
        ++skipped_[*reason];
        return std::nullopt;
      }
      *pixels = std::get<cv::Mat>(loaded);
    }
    const bool is_other_size =
        result.left.size() != result.right.size() ||
        (camera_ && result.left.size() != cv::Size(camera_->width, camera_->height));
    if (!is_other_size) return result;
    ++skipped_["image_size"];
    return std::nullopt;
  }

  std::optional<RecordedFrame> complete(PendingFrame& pending) {
    RecordedFrame frame;
    if (pending.pair) {
      const auto images = decode(pending);
      if (!images) return std::nullopt;
      const auto start = std::chrono::steady_clock::now();
      frame.stereo = stereoFrame(pending, *images);
      frame.rectify_ms =
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
              .count();
      last_right_ = images->right;
    }
    frame.index = pending.index;
    frame.time = pending.time;
    frame.T_map_robot = pending.T_map_robot;
    frame.detections = std::move(pending.detections);
    if (frame.detections && rectifier_) rectifyBoxes(*frame.detections);
    return frame;
  }

  StereoFrame stereoFrame(const PendingFrame& pending, const DecodedPair& images) {
    StereoFrame frame;
    frame.index = pending.index;
    frame.time = pending.time;
    frame.left = rectifier_->rectify(Rectifier::kLeft, greyOf(images.left));
    frame.right = rectifier_->rectify(Rectifier::kRight, greyOf(images.right));
    if (images.left.channels() == 3) {
      frame.left_colour = rectifier_->rectify(Rectifier::kLeft, images.left);
    }
    frame.camera = camera_;
    frame.motion_prior = prior_.between(last_time_, pending.time);
    prior_.forgetBefore(pending.time);
    last_time_ = pending.time;
    return frame;
  }

  /// Boxes are in the image as recorded; boxes of another image (by its size) stay as they are.
  void rectifyBoxes(Detections& detections) const {
    const bool is_other_image =
        detections.image_width > 0 &&
        (detections.image_width != camera_->width || detections.image_height != camera_->height);
    if (is_other_image) return;
    for (auto& item : detections.items) {
      if (item.box2d) item.box2d = rectifier_->rectify(*item.box2d);
    }
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
  std::string image_folder_;
  std::map<std::string, std::size_t> skipped_;
  ObservationStream stream_;
  std::deque<CObservation::Ptr> probed_;  ///< read by probe(), to be dispatched
  bool holds_images_ = false;
  std::optional<StereoPairing> pairing_;
  FrameAssembler assembler_;
  MotionPriorBuilder prior_;
  std::optional<PendingFrame> first_;  ///< taken by findFirstFrame(), to come out
  std::optional<DecodedPair> first_pair_;
  std::optional<Rectifier> rectifier_;
  std::shared_ptr<const StereoCamera> camera_;
  std::optional<CalibrationReport> calibration_;
  cv::Mat last_right_;             ///< as recorded, of the frame handed out last
  std::optional<Time> last_time_;  ///< of the frame handed out last
};

RawlogSource::RawlogSource(const std::string& path, const RawlogSourceOptions& options)
    : reader_(std::make_unique<Reader>(path, options)) {}
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
