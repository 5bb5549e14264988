// SPDX-License-Identifier: BSD-3-Clause
#include "kitti_tracklets.h"

#include <headway/core/error.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>

#include "text_rows.h"

namespace headway::io {
namespace {

/// Reads the elements of an XML text in order of their tags, without attributes.
class XmlScanner {
 public:
  explicit XmlScanner(const std::string& path) : path_(path) {
    std::ifstream file(path);
    if (!file) throw InputError(path + ": cannot be opened");
    text_.assign(std::istreambuf_iterator<char>(file), {});
  }

  /// Name of the next start or end tag ("item", "/item"); nullopt at the end of the text. Content
  /// before it is returned by content().
  std::optional<std::string> next() {
    const auto open = text_.find('<', position_);
    if (open == text_.npos) return std::nullopt;
    content_ = text_.substr(position_, open - position_);
    const auto close = text_.find('>', open);
    if (close == text_.npos) fail("a tag is not closed");
    position_ = close + 1;
    return text_.substr(open + 1, text_.find_first_of(" >", open) - open - 1);
  }

  [[nodiscard]] const std::string& content() const { return content_; }

  [[nodiscard]] double number(const std::string& tag) const {
    const auto value = parseNumber(content_);
    if (!value || !std::isfinite(*value)) fail("<" + tag + "> is not a number: '" + content_ + "'");
    return *value;
  }

  [[noreturn]] void fail(const std::string& reason) const {
    const auto line =
        1 + std::count(text_.begin(), text_.begin() + static_cast<long>(position_), '\n');
    throw InputError(path_ + ":" + std::to_string(line) + ": " + reason);
  }

 private:
  std::string path_;
  std::string text_;
  std::size_t position_ = 0;
  std::string content_;
};

/// Values of one tracklet or of one of its poses, by tag.
using Values = std::map<std::string, double>;

constexpr double kMaxFrame = 1e9;
constexpr double kTruncatedAtMost = 1.0;  // KITTI: 0 in image, 1 truncated, 2 outside, 3 behind

class TrackletReader {
 public:
  TrackletReader(const std::string& path, const Pose& T_cam_velo,
                 std::map<std::string, std::size_t>& dropped)
      : xml_(path), T_cam_velo_(T_cam_velo), dropped_(dropped) {}

  std::map<std::size_t, Detections> read() {
    bool has_tracklets = false;
    for (auto tag = xml_.next(); tag; tag = xml_.next()) {
      if (*tag == "tracklets") has_tracklets = true;
      if (has_tracklets && *tag == "item") readTracklet();
      if (*tag == "/tracklets") return std::move(frames_);
    }
    xml_.fail(has_tracklets ? "ends within <tracklets>" : "contains no <tracklets>");
  }

 private:
  std::string nextTag() {
    const auto tag = xml_.next();
    if (!tag) xml_.fail("ends within a tracklet");
    return *tag;
  }

  void readTracklet() {
    Values sizes;
    std::string type;
    for (auto tag = nextTag(); tag != "/item"; tag = nextTag()) {
      if (tag == "/objectType") type = xml_.content();
      if (tag == "/h" || tag == "/w" || tag == "/l" || tag == "/first_frame") {
        sizes[tag.substr(1)] = xml_.number(tag);
      }
      if (tag == "poses") readPoses(type, sizes);
    }
    ++next_id_;
  }

  void readPoses(const std::string& type, const Values& sizes) {
    for (const char* name : {"h", "w", "l", "first_frame"}) {
      if (sizes.count(name) == 0) xml_.fail(std::string("the tracklet has no <") + name + ">");
    }
    if (!(sizes.at("first_frame") >= 0.0 && sizes.at("first_frame") <= kMaxFrame)) {
      xml_.fail("<first_frame> is no index of a frame");
    }
    auto frame = static_cast<std::size_t>(sizes.at("first_frame"));
    for (auto tag = nextTag(); tag != "/poses"; tag = nextTag()) {
      if (tag == "item") addPose(type, sizes, readPose(), frame++);
    }
  }

  Values readPose() {
    Values pose;
    for (auto tag = nextTag(); tag != "/item"; tag = nextTag()) {
      if (tag[0] == '/') pose[tag.substr(1)] = xml_.number(tag);
    }
    for (const char* name : {"tx", "ty", "tz", "rz", "truncation"}) {
      if (pose.count(name) == 0) xml_.fail(std::string("the pose has no <") + name + ">");
    }
    return pose;
  }

  void addPose(const std::string& type, const Values& sizes, const Values& pose,
               std::size_t frame) {
    const auto object_class = objectClassFrom(type == "Person (sitting)" ? "Person_sitting" : type);
    if (!object_class) {
      ++dropped_["unknown_class"];
      return;
    }
    if (pose.at("truncation") > kTruncatedAtMost) {
      ++dropped_["tracklet_outside_image"];
      return;
    }
    Detection detection;
    detection.object_class = *object_class;
    detection.detector_id = next_id_;
    Box3d box;
    box.length = sizes.at("l");
    box.width = sizes.at("w");
    box.height = sizes.at("h");
    const Eigen::Vector3d bottom(pose.at("tx"), pose.at("ty"), pose.at("tz"));
    box.centre = T_cam_velo_ * (bottom + Eigen::Vector3d(0.0, 0.0, 0.5 * box.height));
    const double yaw = pose.at("rz");
    box.yaw = opticalYaw(T_cam_velo_.linear() * Eigen::Vector3d(std::cos(yaw), std::sin(yaw), 0.0));
    detection.box3d = box;
    frames_[frame].items.push_back(detection);
  }

  XmlScanner xml_;
  Pose T_cam_velo_;
  std::map<std::string, std::size_t>& dropped_;
  std::int64_t next_id_ = 0;
  std::map<std::size_t, Detections> frames_;
};

}  // namespace

std::map<std::size_t, Detections> readKittiTracklets(const std::string& path,
                                                     const Pose& T_cam_velo,
                                                     std::map<std::string, std::size_t>& dropped) {
  return TrackletReader(path, T_cam_velo, dropped).read();
}

}  // namespace headway::io
