#include "observation_stream.h"

#include <headway/core/error.h>
#include <headway/io/detection_observation.h>
#include <mrpt/core/exceptions.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CActionRobotMovement2D.h>
#include <mrpt/obs/CObservationOdometry.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cctype>
#include <set>

namespace headway::io {
namespace {

// MRPT's object format: length of the class name with the highest bit set, the name,
// a version byte, the content, an end mark. 0x88 would also be the header of a name of 8 letters,
// which no class in a rawlog has.
constexpr unsigned char kNameFlag = 0x80;
constexpr unsigned char kEndMark = 0x88;
constexpr std::size_t kMinNameLength = 3;
constexpr std::size_t kMaxNameLength = 120;
constexpr std::uint8_t kSensoryFrameVersion = 2;  // a count, then the observations
constexpr std::size_t kScanChunk = 1 << 16;
constexpr std::size_t kMaxFailures = 3;

bool isClassName(const std::string& name) {
  return name.size() >= kMinNameLength && std::all_of(name.begin(), name.end(), [](char c) {
           return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == ':' ||
                  c == '<' || c == '>' || c == ',';
         });
}

bool isSensoryFrame(const std::string& class_name) {
  return shortClassName(class_name) == "CSensoryFrame";
}

/// Headers (length byte and name) of all classes that contain observations.
const std::set<std::string>& observationHeaders() {
  static const std::set<std::string> headers = [] {
    std::set<std::string> result;
    const auto add = [&result](const std::string& name) {
      result.insert(static_cast<char>(kNameFlag | name.size()) + name);
    };
    add("mrpt::obs::CSensoryFrame");
    add("mrpt::obs::CActionCollection");
    for (const auto* id :
         mrpt::rtti::getAllRegisteredClassesChildrenOf(CLASS_ID(mrpt::obs::CObservation))) {
      add(id->className);
    }
    return result;
  }();
  return headers;
}

/// Position of the first such header; npos if there is none.
std::size_t findObservationHeader(const std::string& bytes) {
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const auto first = static_cast<unsigned char>(bytes[at]);
    if ((first & kNameFlag) == 0) continue;
    const std::size_t length = first & ~kNameFlag;
    if (at + 1 + length > bytes.size()) continue;
    if (observationHeaders().count(bytes.substr(at, 1 + length)) > 0) return at;
  }
  return std::string::npos;
}

}  // namespace

std::string shortClassName(const std::string& name) {
  const auto colon = name.rfind(':');
  return colon == std::string::npos ? name : name.substr(colon + 1);
}

std::string shortClassName(const mrpt::rtti::CObject& object) {
  return shortClassName(object.GetRuntimeClass()->className);
}

ObservationStream::ObservationStream(const std::string& path,
                                     std::map<std::string, std::size_t>& skipped)
    : path_(path), skipped_(skipped), input_(path) {
  registerClasses();
  const auto header = readHeader();
  if (!header) {
    throw InputError(path_ + ": is not a rawlog" +
                     (truncation_ ? " (" + *truncation_ + ")" : std::string()));
  }
  input_.unread(header->bytes);
}

mrpt::obs::CObservation::Ptr ObservationStream::next() {
  while (ready_.empty() && !at_end_) {
    const auto header = readHeader();
    if (!header) break;
    if (isSensoryFrame(header->class_name) && enterSensoryFrame()) continue;
    if (mrpt::rtti::findRegisteredClass(header->class_name) == nullptr) {
      ++skipped_[shortClassName(header->class_name)];
      skipToNextObservation();
      continue;
    }
    if (isUnreadable(*header)) {
      ++skipped_["unreadable_" + shortClassName(header->class_name)];
      skipToNextObservation();
      continue;
    }
    readObject(*header);
  }
  if (ready_.empty()) return nullptr;
  auto observation = ready_.front();
  ready_.pop_front();
  return observation;
}

/// Header of the next object; nullopt at the end of the file or on an error.
std::optional<ObservationStream::Header> ObservationStream::readHeader() {
  unsigned char first = 0;
  do {
    if (input_.Read(&first, 1) == 0) {
      at_end_ = true;
      if (!input_.compressionError().empty()) {
        truncate(input_.compressionError());
      } else if (in_sensory_frame_ && !has_skipped_) {
        truncate("the file ends within a sensory frame");
      }
      return std::nullopt;
    }
    const bool is_frame_end = (in_sensory_frame_ || has_skipped_) && first == kEndMark;
    if (!is_frame_end) break;
    in_sensory_frame_ = false;
  } while (true);
  const std::size_t length = first & ~kNameFlag;
  std::string name(length, '\0');
  const bool is_header = (first & kNameFlag) != 0 && length <= kMaxNameLength;
  if (is_header && input_.Read(name.data(), length) < length) {
    truncate("the file ends within an object");
    return std::nullopt;
  }
  if (!is_header || !isClassName(name)) {
    if (has_skipped_) {
      if (is_header) input_.unread(name);
      skipToNextObservation();
      return readHeader();
    }
    truncate("not an MRPT object");
    return std::nullopt;
  }
  return Header{static_cast<char>(first) + name, name};
}

/// Reads the header of a sensory frame, so that its objects are read next.
///
/// @return false if its version is unknown; nothing has then been read
bool ObservationStream::enterSensoryFrame() {
  std::uint8_t version = 0;
  if (input_.Read(&version, 1) == 1 && version == kSensoryFrameVersion) {
    std::uint32_t count = 0;
    (void)input_.Read(&count, sizeof(count));
    in_sensory_frame_ = true;
    return true;
  }
  input_.unread(std::string(1, static_cast<char>(version)));
  return false;
}

/// Whether all objects of this class and version failed so far. Further attempts would be slow,
/// because MRPT's exceptions contain a call stack.
bool ObservationStream::isUnreadable(const Header& header) {
  char version = 0;
  if (input_.Read(&version, 1) == 1) input_.unread(std::string(1, version));
  reading_ = &readability_[header.class_name + version];
  return reading_->read == 0 && reading_->failed >= kMaxFailures;
}

void ObservationStream::readObject(const Header& header) {
  input_.unread(header.bytes);
  mrpt::serialization::CSerializable::Ptr object;
  try {
    auto archive = mrpt::serialization::archiveFrom(input_);
    object = archive.ReadObject();
  } catch (const std::exception&) {
    if (input_.lastWasShort()) {
      const std::string reason = input_.compressionError();
      truncate(reason.empty() ? "the file ends within an object" : reason);
    } else {
      ++reading_->failed;
      ++skipped_["unreadable_" + shortClassName(header.class_name)];
      skipToNextObservation();
    }
    return;
  }
  ++reading_->read;
  if (auto observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object)) {
    deliver(observation);
  } else if (auto frame = std::dynamic_pointer_cast<mrpt::obs::CSensoryFrame>(object)) {
    for (const auto& one : *frame) deliver(one);
  } else if (auto actions = std::dynamic_pointer_cast<mrpt::obs::CActionCollection>(object)) {
    addMovement(*actions);
  } else {
    ++skipped_[shortClassName(header.class_name)];
  }
}

void ObservationStream::addMovement(const mrpt::obs::CActionCollection& actions) {
  for (const auto& action : actions) {
    const auto* movement =
        dynamic_cast<const mrpt::obs::CActionRobotMovement2D*>(action.get_ptr().get());
    if (movement == nullptr ||
        movement->estimationMethod != mrpt::obs::CActionRobotMovement2D::emOdometry) {
      ++skipped_[shortClassName(*action)];
      continue;
    }
    odometry_ = odometry_ + movement->poseChange->getMeanVal();
    odometry_is_new_ = true;
  }
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

void ObservationStream::skipToNextObservation() {
  has_skipped_ = true;
  std::string window;
  while (true) {
    const std::size_t kept = std::min(window.size(), kMaxNameLength + 1);
    window.erase(0, window.size() - kept);
    window.resize(kept + kScanChunk);
    window.resize(kept + input_.Read(window.data() + kept, kScanChunk));
    const auto at = findObservationHeader(window);
    if (at != std::string::npos) {
      input_.unread(window.substr(at));
      return;
    }
    if (window.size() < kept + kScanChunk) return;
  }
}

void ObservationStream::truncate(const std::string& reason) {
  at_end_ = true;
  truncation_ = path_ + ": truncated after " + std::to_string(observations_) +
                " observations, at byte " + std::to_string(input_.getPosition()) +
                " of the uncompressed content: " + reason;
}

}  // namespace headway::io
