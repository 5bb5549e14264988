// SPDX-License-Identifier: BSD-3-Clause
#include "observation_stream.h"

#include <headway/core/error.h>
#include <headway/core/worker_thread.h>
#include <headway/io/detection_observation.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/rtti/CObject.h>

#include <algorithm>
#include <cctype>
#include <unordered_set>

#include "recorded_objects.h"

namespace headway::io {
namespace {

// See ObjectReader. An end mark would also be the header of a class with a name of 8 letters, which
// no class in a rawlog has.
constexpr unsigned char kNameFlag = 0x80;
constexpr unsigned char kEndMark = 0x88;
constexpr std::size_t kMinNameLength = 3;
constexpr std::size_t kMaxNameLength = 120;
constexpr std::size_t kScanChunk = 1 << 16;
constexpr std::size_t kMaxReasons = 200;  // counted one by one

constexpr char kSensoryFrame[] = "CSensoryFrame";
constexpr char kActionCollection[] = "CActionCollection";
constexpr char kMovement[] = "CActionRobotMovement2D";

bool isClassName(std::string_view name) {
  return std::all_of(name.begin(), name.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' || c == '<' ||
           c == '>' || c == ',';
  });
}

/// Names of all classes that are or contain observations; without namespace in files before 2.0.
const std::unordered_set<std::string_view>& observationClasses() {
  static const std::unordered_set<std::string_view> classes = [] {
    std::unordered_set<std::string_view> result = {"mrpt::obs::CSensoryFrame",
                                                   "mrpt::obs::CActionCollection",
                                                   "mrpt::obs::CActionRobotMovement2D",
                                                   kSensoryFrame,
                                                   kActionCollection,
                                                   kMovement};
    for (const auto* id :
         mrpt::rtti::getAllRegisteredClassesChildrenOf(CLASS_ID(mrpt::obs::CObservation))) {
      const std::string_view name = id->className;
      result.insert(name);
      result.insert(name.substr(name.rfind(':') + 1));
    }
    return result;
  }();
  return classes;
}

/// Position of the first header of such a class; npos if there is none.
std::size_t findObservationHeader(std::string_view bytes) {
  for (std::size_t at = 0; at + kMinNameLength < bytes.size(); ++at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    const char second = bytes[at + 1];
    // All names begin with "mrpt::", "headway::" or "C".
    if ((first & kNameFlag) == 0 || (second != 'm' && second != 'h' && second != 'C')) continue;
    const std::size_t length = first & ~kNameFlag;
    if (at + 1 + length > bytes.size()) continue;
    if (observationClasses().count(bytes.substr(at + 1, length)) > 0) return at;
  }
  return std::string_view::npos;
}

}  // namespace

std::string shortClassName(const mrpt::rtti::CObject& object) {
  return shortClassName(object.GetRuntimeClass()->className);
}

ObservationStream::ObservationStream(const std::string& path,
                                     std::map<std::string, std::size_t>& skipped)
    : path_(path), skipped_(skipped), input_(path) {
  registerClasses();
  if (!readClassName()) {
    throw InputError(path_ + ": is not a rawlog" +
                     (truncation_ ? " (" + *truncation_ + ")" : std::string()));
  }
  input_.goTo(header_position_);
}

mrpt::obs::CObservation::Ptr ObservationStream::next() {
  while (ready_.empty() && !at_end_ && !stopRequested()) {
    const auto class_name = readClassName();
    if (class_name) readObject(*class_name);
  }
  if (ready_.empty()) return nullptr;
  auto observation = ready_.front();
  ready_.pop_front();
  return observation;
}

/// Class name of the next object; nullopt at the end of the file. Bytes that are no header are
/// skipped.
std::optional<std::string> ObservationStream::readClassName() {
  while (true) {
    input_.mark();
    header_position_ = input_.position();
    const std::string_view header = input_.peek(1 + kMaxNameLength);
    if (header.empty()) return endOfFile();
    const auto first = static_cast<unsigned char>(header[0]);
    if (first == kEndMark && (open_containers_ > 0 || has_skipped_)) {
      input_.take(1);
      if (open_containers_ > 0) --open_containers_;
      continue;
    }
    const std::size_t length = first & ~kNameFlag;
    const std::string_view name = header.substr(1, length);
    if ((first & kNameFlag) != 0 && length >= kMinNameLength && length <= kMaxNameLength &&
        isClassName(name)) {
      if (name.size() < length) {
        truncate("the file ends within an object");
        return std::nullopt;
      }
      std::string result(name);
      input_.take(1 + length);
      return result;
    }
    // Behind an object that was found within a skipped one follows the remainder of the latter.
    if (objects_since_skip_ >= 2) count("broken_header");
    input_.take(1);
    if (!skipToNextObservation()) return endOfFile();
  }
}

std::nullopt_t ObservationStream::endOfFile() {
  at_end_ = true;
  if (!input_.compressionError().empty()) {
    truncate(input_.compressionError());
  } else if (open_containers_ > 0 && !has_skipped_) {
    truncate("the file ends within a sensory frame");
  }
  return std::nullopt;
}

/// Reads an object after its class name. After a failure continues behind the class name, so that
/// a wrong length costs no other object.
void ObservationStream::readObject(const std::string& class_name) {
  const std::uint64_t start = input_.position();
  const std::string name = shortClassName(class_name);
  try {
    if (readValues(name)) {
      ++objects_since_skip_;
      return;
    }
    count(name);
  } catch (const UnexpectedEnd& error) {
    input_.goTo(start);
    const std::string reason = input_.compressionError();
    if (!skipToNextObservation()) return truncate(reason.empty() ? error.what() : reason);
    return count("unreadable_" + name);
  } catch (const UnknownVersion& error) {
    count("unreadable_" + name + "_" + error.what());
  } catch (const BrokenObject&) {
    count("unreadable_" + name);
  }
  input_.goTo(start);
  (void)skipToNextObservation();
}

/// Reads the values of an object; false if it is not one of those that are used.
bool ObservationStream::readValues(const std::string& name) {
  ObjectReader in(input_);
  if (name == kSensoryFrame || name == kActionCollection) {
    enterContainer(name, in);
  } else if (name == kMovement) {
    const auto increment = readMovement(in);
    if (!increment) return false;
    addMovement(*increment);
  } else if (isReadClass(name)) {
    deliver(readObservation(name, in));
  } else {
    return false;
  }
  return true;
}

/// Reads the version and the number of objects, which follow one by one. The number is not used:
/// the end mark tells where they end.
void ObservationStream::enterContainer(const std::string& name, ObjectReader& in) {
  const auto version = in.value<std::uint8_t>();
  if (name == kSensoryFrame && version == 1) (void)in.value<std::uint32_t>();  // identifier
  const bool is_known = name == kSensoryFrame ? version == 1 || version == 2 : version == 0;
  if (!is_known) throw BrokenObject("a container has an unknown version");
  (void)in.value<std::uint32_t>();
  ++open_containers_;
}

void ObservationStream::addMovement(const mrpt::poses::CPose2D& increment) {
  odometry_ = odometry_ + increment;
  odometry_is_new_ = true;
}

void ObservationStream::deliver(const mrpt::obs::CObservation::Ptr& observation) {
  if (odometry_is_new_ && observation->timestamp != INVALID_TIMESTAMP) {
    auto summed = mrpt::obs::CObservationOdometry::Create();
    summed->timestamp = observation->timestamp;
    summed->sensorLabel = "odometry";
    summed->odometry = odometry_;
    ready_.push_back(summed);
    odometry_is_new_ = false;
  }
  ++observations_;
  ready_.push_back(observation);
}

/// Counts what is skipped; the names in a broken file do not fill the memory.
void ObservationStream::count(const std::string& reason) {
  const bool is_new = skipped_.count(reason) == 0;
  ++skipped_[is_new && skipped_.size() >= kMaxReasons ? "other_classes" : reason];
}

/// Continues at the next header of an observation; false if there is none.
bool ObservationStream::skipToNextObservation() {
  has_skipped_ = true;
  objects_since_skip_ = 0;
  while (!stopRequested()) {
    input_.mark();
    const std::string_view window = input_.peek(kScanChunk);
    const auto at = findObservationHeader(window);
    if (at != std::string_view::npos) {
      input_.take(at);
      return true;
    }
    const bool is_end = window.size() < kScanChunk;
    // A header may begin in the last bytes.
    input_.take(is_end ? window.size() : window.size() - (kMaxNameLength + 1));
    if (is_end) return false;
  }
  return false;
}

void ObservationStream::truncate(const std::string& reason) {
  at_end_ = true;
  truncation_ = path_ + ": truncated after " + std::to_string(observations_) +
                " observations, at byte " + std::to_string(input_.position()) +
                " of the uncompressed content: " + reason;
}

}  // namespace headway::io
