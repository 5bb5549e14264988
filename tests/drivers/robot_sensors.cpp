// SPDX-License-Identifier: BSD-3-Clause
// A plug-in with a driver of sensors, as a robot's maker would write one: odometry, inertial
// sensor, laser and camera of a simulated robot, from its true path and its recorded images.
#include <headway/core/mrpt_pose.h>
#include <headway/core/recorded_frame.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/trajectory_file.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <mrpt/serialization/CArchive.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace headway::test {

/// Blocks until a file exists, or its folder does not, as without a path.
inline void waitForFile(const std::filesystem::path& path) {
  while (!exists(path) && exists(path.parent_path())) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// Section of an .ini file: `kind` = odometry, imu, laser, left or right; `trajectory` = true path
/// (TUM); `rawlog_file` = stereo recording that left and right images, without calibration, are
/// taken of; `late_s` is added to the times; after `unplug_after` observations the driver throws
/// once; it blocks in loadConfig() until file `configured_with` exists, and in initialize() until
/// `started_with` does.
///
/// Recorded times pass at the speed of the computer's clock from the process's start.
class RobotSensor : public mrpt::hwdrivers::CGenericSensor {
  DEFINE_GENERIC_SENSOR(RobotSensor)

 public:
  void initialize() override {
    waitForFile(started_with_);
    if (kind_ != "left" && kind_ != "right") return;
    mrpt::io::CFileGZInputStream file(rawlog_);
    auto archive = mrpt::serialization::archiveFrom(file);
    while (images_.size() < kImages) {
      mrpt::serialization::CSerializable::Ptr object;
      archive >> object;
      auto stereo = std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(object);
      if (stereo != nullptr) images_.push_back(std::move(stereo));
    }
  }

  void doProcess() override {
    static const double start_s = monotonicSeconds();
    const double now = path_.front().time + monotonicSeconds() - start_s;
    for (; next_ < path_.size() && path_[next_].time <= now; ++next_) {
      if (path_[next_].time < now - kKept_s) continue;  // before the driver was started
      if (delivered_++ == unplug_after_ && !std::exchange(wasUnplugged(), true)) {
        throw std::runtime_error("the plug was pulled");
      }
      if (auto observation = observe(next_)) {
        observation->timestamp = io::mrptTime(path_[next_].time + late_s_);
        observation->sensorLabel = m_sensorLabel;
        appendObservation(observation);
      }
    }
  }

 protected:
  void loadConfig_sensorSpecific(const mrpt::config::CConfigFileBase& configuration,
                                 const std::string& section) override {
    waitForFile(configuration.read_string(section, "configured_with", ""));
    started_with_ = configuration.read_string(section, "started_with", "");
    kind_ = configuration.read_string(section, "kind", "", true);
    path_ = io::readTum(configuration.read_string(section, "trajectory", "", true));
    late_s_ = configuration.read_double(section, "late_s", 0.0);
    unplug_after_ = configuration.read_uint64_t(section, "unplug_after", 1 << 30);
    rawlog_ = configuration.read_string(section, "rawlog_file", "");
  }

 private:
  mrpt::obs::CObservation::Ptr observe(std::size_t i) const {
    if (kind_ == "odometry") return odometryAt(i);
    if (kind_ == "imu") return inertialSampleAt(i);
    if (kind_ == "laser") return scan();
    return i < images_.size() ? imageAt(i) : nullptr;
  }

  mrpt::obs::CObservation::Ptr odometryAt(std::size_t i) const {
    auto observation = mrpt::obs::CObservationOdometry::Create();
    const Pose& T = path_[i].value;
    observation->odometry = {T.translation().x(), T.translation().y(), yawOf(T)};
    return observation;
  }

  mrpt::obs::CObservation::Ptr inertialSampleAt(std::size_t i) const {
    auto observation = mrpt::obs::CObservationIMU::Create();
    const std::size_t before = i > 0 ? i - 1 : 0;
    const std::size_t after = std::min(i + 1, path_.size() - 1);
    const double rate = wrapAngle(yawOf(path_[after].value) - yawOf(path_[before].value)) /
                        (path_[after].time - path_[before].time);
    observation->set(mrpt::obs::IMU_WX, 0.0);
    observation->set(mrpt::obs::IMU_WY, 0.0);
    observation->set(mrpt::obs::IMU_WZ, rate);
    return observation;
  }

  static mrpt::obs::CObservation::Ptr scan() {
    auto observation = mrpt::obs::CObservation2DRangeScan::Create();
    observation->aperture = 3.0F;
    observation->maxRange = 10.0F;
    observation->sensorPose = mrpt::poses::CPose3D(0.1, 0.0, 0.25, 0.0, 0.0, 0.0);
    constexpr std::size_t kBeams = 61;
    observation->resizeScan(kBeams);
    for (std::size_t beam = 0; beam < kBeams; ++beam) {
      observation->setScanRange(beam, 4.0F);
      observation->setScanRangeValidity(beam, true);
    }
    return observation;
  }

  mrpt::obs::CObservation::Ptr imageAt(std::size_t i) const {
    const auto& stereo = *images_[i];
    auto observation = mrpt::obs::CObservationImage::Create();
    observation->image = kind_ == "left" ? stereo.imageLeft : stereo.imageRight;
    return observation;
  }

  /// Whether the sensor was unplugged, which a new driver of the same label knows.
  bool& wasUnplugged() const {
    static std::mutex mutex;
    static std::map<std::string, bool> unplugged;
    const std::lock_guard lock(mutex);
    return unplugged[m_sensorLabel];
  }

  static constexpr double kKept_s = 0.2;       ///< observations that a driver's buffer holds
  static constexpr std::size_t kImages = 150;  ///< of the recording

  std::string started_with_;
  std::string kind_;
  std::string rawlog_;
  std::vector<Stamped<Pose>> path_;
  std::size_t next_ = 0;       ///< in path_
  std::size_t delivered_ = 0;  ///< observations
  double late_s_ = 0.0;
  std::size_t unplug_after_ = 0;
  std::vector<mrpt::obs::CObservationStereoImages::Ptr> images_;
};

}  // namespace headway::test

IMPLEMENTS_GENERIC_SENSOR(RobotSensor, headway::test)

namespace {
[[maybe_unused]] const bool g_is_registered = [] {
  headway::test::RobotSensor::doRegister();
  return true;
}();
}  // namespace
