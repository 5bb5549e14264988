// SPDX-License-Identifier: BSD-3-Clause
// The drivers of all sensors of a robot, each in its own thread and started again if it fails.
#include <headway/core/error.h>
#include <headway/drivers/sensor_group.h>
#include <headway/io/detection_observation.h>
#include <headway/io/image_file.h>
#include <headway/io/raw_camera.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/hwdrivers/CGenericSensor.h>
#include <mrpt/hwdrivers/registerAllClasses.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <future>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

namespace headway::drivers {
namespace {

using Clock = std::chrono::steady_clock;
using mrpt::hwdrivers::CGenericSensor;

Clock::duration seconds(double s) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(s));
}

/// First line of an exception's message; MRPT's contain more.
std::string reasonOf(const std::exception& error) {
  const std::string text = error.what();
  const auto message = text.find("Message:");
  const auto begin = message == std::string::npos ? 0 : message + 8;
  const auto first = text.find_first_not_of(" \n", begin);
  if (first == std::string::npos) return "unknown failure";
  return text.substr(first, text.find('\n', first) - first);
}

}  // namespace

class SensorGroup::Implementation : public std::enable_shared_from_this<Implementation> {
 public:
  Implementation(const mrpt::config::CConfigFileBase& configuration,
                 ObservationCallback observation, MessageCallback message,
                 const SensorGroupOptions& options)
      : configuration_(textOf(configuration)),
        observation_(std::move(observation)),
        message_(std::move(message)),
        options_(options) {
    mrpt::hwdrivers::registerAllClasses_mrpt_hwdrivers();
    io::registerClasses();
    std::vector<std::string> sections;
    configuration_.getAllSections(sections);
    for (const auto& section : sections) {
      if (section == "global" || !configuration_.keyExists(section, "driver") ||
          configuration_.read_bool(section, "rawlog-grabber-ignore", false)) {
        continue;
      }
      (void)create(section);  // reports mistakes at once
      SensorStatus status;
      status.name = section;
      status_.push_back(status);
    }
    if (status_.empty()) throw InputError("no section has the key 'driver'; see rawlog-grabber");
  }

  void start() {
    if (!threads_.empty()) return;
    for (std::size_t i = 0; i < status_.size(); ++i) {
      std::packaged_task<void()> task([self = shared_from_this(), i] { self->run(i); });
      ends_.push_back(task.get_future());
      threads_.emplace_back(std::move(task));
    }
  }

  bool stop() {
    {
      const std::scoped_lock lock(callback_mutex_, mutex_);
      stopping_ = true;
    }
    stopped_.notify_all();
    const auto end = Clock::now() + seconds(options_.max_stop_s);
    for (std::size_t i = 0; i < threads_.size(); ++i) {
      if (!threads_[i].joinable()) continue;
      if (ends_[i].wait_until(end) == std::future_status::ready) {
        threads_[i].join();
        continue;
      }
      threads_[i].detach();
      has_blocked_ = true;
      message_("sensor [" + status_[i].name + "]: its driver does not return; it is left");
    }
    ends_.clear();  // a future keeps its task, which keeps this
    return !has_blocked_;
  }

  std::vector<SensorStatus> status() const {
    const std::lock_guard lock(mutex_);
    return status_;
  }

 private:
  static std::string textOf(const mrpt::config::CConfigFileBase& configuration) {
    mrpt::config::CConfigFileMemory copy;
    std::vector<std::string> sections, keys;
    configuration.getAllSections(sections);
    for (const auto& section : sections) {
      configuration.getAllKeys(section, keys);
      for (const auto& key : keys) {
        copy.write(section, key, configuration.read_string(section, key, ""));
      }
    }
    return copy.getContent();
  }

  /// A configured driver that has not been started.
  CGenericSensor::Ptr create(const std::string& section) const {
    const std::string name = configuration_.read_string(section, "driver", "", true);
    const auto sensor = CGenericSensor::createSensorPtr(name);
    if (sensor == nullptr) {
      throw InputError("[" + section + "] driver = " + name +
                       ": MRPT has no such class of sensors");
    }
    try {
      sensor->loadConfig(configuration_, section);
    } catch (const std::exception& error) {
      throw InputError("[" + section + "] " + reasonOf(error));
    }
    requireFile(section, "rawlog_file", "rawlog");
    requireFile(section, "image_dir_url", "image_dir");
    return sensor;
  }

  /// Files do not come while a robot runs, as devices do.
  void requireFile(const std::string& section, const std::string& key,
                   const std::string& grabber) const {
    const std::string path = configuration_.read_string(section, key, "");
    const std::string type = configuration_.read_string(section, "grabber_type", grabber);
    if (path.empty() || type != grabber) return;
    std::error_code unknown;  // of what is neither a file nor a folder
    std::string fault = std::filesystem::exists(path) ? "" : "no such file or folder";
    if (fault.empty() && std::filesystem::is_empty(path, unknown)) fault = "is empty";
    const bool is_file = std::filesystem::is_regular_file(path, unknown);
    if (fault.empty() && is_file) fault = io::lfsPointerFault(path);
    if (!fault.empty()) throw InputError("[" + section + "] " + key + " = " + path + ": " + fault);
  }

  /// A sensor's thread: starts it until it is to be stopped.
  void run(std::size_t index) {
    const std::string name = status_[index].name;  // names never change
    while (!isStopping()) {
      try {
        const auto sensor = create(name);
        sensor->initialize();
        setRunning(index);
        deliver(*sensor, index);
      } catch (const std::exception& error) {
        setFailed(index, reasonOf(error));
      }
      waitUntil(Clock::now() + seconds(options_.retry_s));
    }
  }

  /// Returns when it is to be stopped. @throws std::exception if the sensor fails or falls silent
  void deliver(CGenericSensor& sensor, std::size_t index) {
    const double rate_hz = sensor.getProcessRate();
    const bool is_side_by_side =
        configuration_.read_bool(status_[index].name, "side_by_side", false);
    auto due = Clock::now();
    std::optional<Clock::time_point> last;  // of an observation
    while (!isStopping()) {
      sensor.doProcess();
      const auto observations = sensor.getObservations();
      for (const auto& [time, object] : observations) {
        auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
        if (is_side_by_side) observation = io::splitSideBySide(observation);
        if (observation != nullptr) deliver(observation, index);
      }
      if (sensor.getState() == CGenericSensor::ssError) {
        throw InputError("the driver reports an error");
      }
      if (!observations.empty()) last = Clock::now();
      if (last && Clock::now() - *last > seconds(options_.max_silence_s)) {
        throw InputError("no observation for " + std::to_string(options_.max_silence_s) + " s");
      }
      due = std::max(due + seconds(rate_hz > 0.0 ? 1.0 / rate_hz : 0.0), Clock::now());
      if (rate_hz <= 0.0 && observations.empty()) due += std::chrono::milliseconds(1);
      waitUntil(due);
    }
  }

  void deliver(const mrpt::obs::CObservation::Ptr& observation, std::size_t index) {
    {
      const std::lock_guard lock(mutex_);
      ++status_[index].observations;
    }
    const std::lock_guard lock(callback_mutex_);
    if (!isStopping()) observation_(observation);  // what it uses may end after stop()
  }

  void setRunning(std::size_t index) {
    const std::lock_guard lock(mutex_);
    status_[index].is_running = true;
  }

  void setFailed(std::size_t index, const std::string& reason) {
    bool is_new = false;
    {
      const std::lock_guard lock(mutex_);
      SensorStatus& status = status_[index];
      is_new = status.is_running || status.error != reason;
      status.is_running = false;
      status.error = reason;
      ++status.restarts;
    }
    if (!is_new) return;  // the same failure at each attempt is said once
    const std::lock_guard lock(callback_mutex_);
    if (!isStopping())
      message_("sensor [" + status_[index].name + "]: " + reason + "; it is started again");
  }

  [[nodiscard]] bool isStopping() const {
    const std::lock_guard lock(mutex_);
    return stopping_;
  }

  void waitUntil(Clock::time_point time) {
    std::unique_lock lock(mutex_);
    stopped_.wait_until(lock, time, [this] { return stopping_; });
  }

  const mrpt::config::CConfigFileMemory configuration_;
  const ObservationCallback observation_;
  const MessageCallback message_;
  const SensorGroupOptions options_;
  std::mutex callback_mutex_;  ///< held during callbacks
  mutable std::mutex mutex_;
  std::condition_variable stopped_;
  bool stopping_ = false;             // guarded by mutex_
  std::vector<SensorStatus> status_;  // guarded by mutex_ once threads run
  std::vector<std::thread> threads_;
  std::vector<std::future<void>> ends_;  ///< of these
  bool has_blocked_ = false;             ///< a driver, at the end
};

SensorGroup::SensorGroup(const mrpt::config::CConfigFileBase& configuration,
                         ObservationCallback observation, MessageCallback message,
                         const SensorGroupOptions& options)
    : implementation_(std::make_shared<Implementation>(configuration, std::move(observation),
                                                       std::move(message), options)) {}

SensorGroup::~SensorGroup() { implementation_->stop(); }

void SensorGroup::start() { implementation_->start(); }

bool SensorGroup::stop() { return implementation_->stop(); }

std::vector<SensorStatus> SensorGroup::status() const { return implementation_->status(); }

}  // namespace headway::drivers
