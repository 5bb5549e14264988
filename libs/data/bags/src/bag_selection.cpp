// SPDX-License-Identifier: BSD-3-Clause
// Which topics of a bag are imported: wishes, completed by types and names.
#include <headway/bags/bag_selection.h>
#include <headway/core/error.h>
#include <headway/core/text.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <sstream>
#include <tuple>

namespace headway::bags {
namespace {

constexpr const char* kNone = "none";
const std::vector<std::string> kImageTypes = {"sensor_msgs/Image", "sensor_msgs/CompressedImage"};
const std::vector<std::string> kTransformTypes = {"tf2_msgs/TFMessage", "tf/tfMessage"};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

bool isOneOf(const std::string& type, const std::vector<std::string>& types) {
  return std::find(types.begin(), types.end(), type) != types.end();
}

std::vector<std::string> splitAtCommas(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    if (!part.empty()) result.push_back(part);
  }
  return result;
}

/// Topics of a bag by type.
class TopicNames {
 public:
  explicit TopicNames(const std::vector<BagTopic>& topics) : topics_(topics) {}

  /// Names of the readable topics of some types that have messages, most messages first.
  [[nodiscard]] std::vector<std::string> of(const std::vector<std::string>& types) const {
    std::vector<const BagTopic*> found;
    for (const BagTopic& topic : topics_) {
      const bool is_readable = topic.encoding != Encoding::kOther && topic.messages > 0;
      if (is_readable && isOneOf(topic.type, types)) found.push_back(&topic);
    }
    std::stable_sort(found.begin(), found.end(), [](const BagTopic* a, const BagTopic* b) {
      return std::tie(b->messages, a->name) < std::tie(a->messages, b->name);
    });
    std::vector<std::string> names;
    for (const BagTopic* topic : found) names.push_back(topic->name);
    return names;
  }

  /// @throws InputError unless there is such a topic of one of the types
  void require(const std::string& name, const std::vector<std::string>& types) const {
    const auto topic = std::find_if(topics_.begin(), topics_.end(),
                                    [&](const BagTopic& one) { return one.name == name; });
    if (topic == topics_.end()) {
      throw InputError("there is no topic " + name +
                       "; of its type there are: " + listOf(of(types)));
    }
    if (!isOneOf(topic->type, types)) {
      throw InputError("topic " + name + " has the type " + topic->type + ", must be " +
                       types.front() + "; such are: " + listOf(of(types)));
    }
  }

  [[nodiscard]] static std::string listOf(const std::vector<std::string>& names) {
    std::string text;
    for (const auto& name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "none" : text;
  }

 private:
  const std::vector<BagTopic>& topics_;
};

/// Lower is better: not compressed, raw, then the order of names.
std::tuple<bool, bool, std::string> preference(const std::string& name) {
  return {contains(name, "compressed"), contains(name, "rect"), name};
}

/// The name with the part that means left replaced by that which means right; empty if it has none.
std::vector<std::string> rightNamesOf(const std::string& left) {
  static const std::array<std::pair<const char*, const char*>, 8> sides = {
      {{"left", "right"},
       {"cam0", "cam1"},
       {"cam_0", "cam_1"},
       {"camera0", "camera1"},
       {"camera_0", "camera_1"},
       {"infra1", "infra2"},
       {"fisheye1", "fisheye2"},
       {"image_0", "image_1"}}};
  std::vector<std::string> names;
  for (const auto& [of_left, of_right] : sides) {
    std::string name = left;
    const std::string part = of_left;
    for (auto at = name.find(part); at != std::string::npos; at = name.find(part, at + 1)) {
      name.replace(at, part.size(), of_right);
    }
    if (name != left) names.push_back(name);
  }
  return names;
}

void guessStereo(const std::vector<std::string>& images, BagSelection& selection) {
  for (const auto& left : images) {
    if (!selection.left.empty() && left != selection.left) continue;
    for (const auto& right : rightNamesOf(left)) {
      if (!selection.right.empty() && right != selection.right) continue;
      if (std::find(images.begin(), images.end(), right) == images.end()) continue;
      selection.left = left;
      selection.right = right;
      return;
    }
  }
}

bool isDepth(const std::string& name) {
  return contains(name, "depth") && !contains(name, "color") && !contains(name, "rgb");
}

/// Depth as seen by the colour camera ("aligned", "registered") before depth as recorded.
void guessDepth(const std::vector<std::string>& images, BagSelection& selection) {
  std::vector<std::string> depths, colours;
  for (const auto& name : images) {
    const bool is_aligned =
        contains(name, "depth") && (contains(name, "aligned") || contains(name, "registered"));
    if (is_aligned) depths.insert(depths.begin(), name);
    if (!is_aligned && isDepth(name)) depths.push_back(name);
    const bool is_colour = contains(name, "color") || contains(name, "rgb");
    if (is_colour && !contains(name, "depth")) colours.push_back(name);
  }
  if (selection.depth.empty() && !depths.empty()) selection.depth = depths.front();
  if (selection.color.empty() && !colours.empty()) selection.color = colours.front();
}

std::string requiredName(const TopicNames& topics, const std::string& wish,
                         const std::vector<std::string>& types) {
  if (wish.empty() || wish == kNone) return "";
  topics.require(wish, types);
  return wish;
}

void selectCamera(const TopicNames& topics, const BagWishes& wishes, BagSelection& selection) {
  if (wishes.left == kNone && wishes.color == kNone) return;
  auto images = topics.of(kImageTypes);
  std::sort(images.begin(), images.end(), [](const std::string& a, const std::string& b) {
    return preference(a) < preference(b);
  });
  selection.left = requiredName(topics, wishes.left, kImageTypes);
  selection.right = requiredName(topics, wishes.right, kImageTypes);
  selection.color = requiredName(topics, wishes.color, kImageTypes);
  selection.depth = requiredName(topics, wishes.depth, kImageTypes);
  const bool wants_depth = !selection.color.empty() || !selection.depth.empty();
  const bool wants_stereo = !selection.left.empty() || !selection.right.empty();
  if (wants_depth && wants_stereo) {
    throw InputError(
        "--left and --right select a stereo camera, --color and --depth a depth "
        "camera: give one of the two");
  }
  if (!wants_depth && (selection.left.empty() || selection.right.empty())) {
    guessStereo(images, selection);
  }
  const bool is_stereo = !selection.left.empty() && !selection.right.empty();
  if (!is_stereo && !wants_stereo) guessDepth(images, selection);
  if (!is_stereo && (selection.color.empty() || selection.depth.empty())) {
    throw InputError(
        "the topics do not tell the camera: give --left and --right, or --color "
        "and --depth; images are in: " +
        TopicNames::listOf(images));
  }
}

/// One sensor: two would be mixed. RealSense cameras have a topic each for gyro and accelerometer.
std::vector<std::string> guessedImu(const std::vector<std::string>& topics) {
  for (const auto& gyro : topics) {
    if (!endsWith(gyro, "/gyro/sample")) continue;
    const std::string accel = gyro.substr(0, gyro.size() - 11) + "accel/sample";
    if (std::find(topics.begin(), topics.end(), accel) != topics.end()) return {gyro, accel};
  }
  for (const auto& topic : topics) {
    if (endsWith(topic, "/imu/data") || endsWith(topic, "/imu")) return {topic};
  }
  if (topics.empty()) return {};
  return {topics.front()};
}

/// Wheel odometry, not that of a camera, such as headway's, a filter, or the truth.
std::string guessedOdometry(const std::vector<std::string>& topics) {
  for (const auto& topic : topics) {
    std::string name = topic;
    std::transform(name.begin(), name.end(), name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    static const std::array<const char*, 11> others = {"visual", "vio",  "truth",    "gps",
                                                       "filter", "slam", "icp",      "stereo",
                                                       "lidar",  "/zed", "/headway/"};
    if (std::none_of(others.begin(), others.end(),
                     [&](const char* other) { return contains(name, other); })) {
      return topic;
    }
  }
  return "";
}

std::vector<std::string> wishedOr(const TopicNames& topics, const std::string& wish,
                                  const std::vector<std::string>& types,
                                  const std::vector<std::string>& guessed) {
  if (wish.empty()) return guessed;
  if (wish == kNone) return {};
  auto names = splitAtCommas(wish);
  for (const auto& name : names) topics.require(name, types);
  return names;
}

std::string firstOf(const std::vector<std::string>& names) {
  return names.empty() ? "" : names.front();
}

}  // namespace

BagSelection selectTopics(const std::vector<BagTopic>& bag_topics, const BagWishes& wishes) {
  const TopicNames topics(bag_topics);
  BagSelection selection;
  selectCamera(topics, wishes, selection);
  const auto choose = [&](const std::string& wish, const std::vector<std::string>& types,
                          const std::vector<std::string>& guessed) {
    return wishedOr(topics, wish, types, guessed);
  };
  const std::vector<std::string> imu = {"sensor_msgs/Imu"}, odometry = {"nav_msgs/Odometry"},
                                 scan = {"sensor_msgs/LaserScan"}, fix = {"sensor_msgs/NavSatFix"};
  selection.imu = choose(wishes.imu, imu, guessedImu(topics.of(imu)));
  selection.scans = choose(wishes.scan, scan, topics.of(scan));
  selection.odometry =
      firstOf(choose(wishes.odometry, odometry, {guessedOdometry(topics.of(odometry))}));
  selection.gnss = firstOf(choose(wishes.gnss, fix, topics.of(fix)));
  selection.tf = choose(wishes.tf, kTransformTypes, topics.of(kTransformTypes));
  return selection;
}

std::string useOf(const BagTopic& topic, const BagSelection& selection) {
  const std::string& name = topic.name;
  const std::pair<const std::string&, const char*> single[] = {
      {selection.left, "left image"},    {selection.right, "right image"},
      {selection.color, "colour image"}, {selection.depth, "depth image"},
      {selection.odometry, "odometry"},  {selection.gnss, "satellite positions"}};
  for (const auto& [selected, use] : single) {
    if (!selected.empty() && selected == name) return use;
  }
  if (isOneOf(name, selection.imu)) return "inertial samples";
  if (isOneOf(name, selection.scans)) return "laser scans";
  if (isOneOf(name, selection.tf)) return "mounting";
  for (const auto& image : {selection.left, selection.right, selection.color, selection.depth}) {
    if (!image.empty() && name == cameraInfoTopicOf(image)) return "calibration";
  }
  return "";
}

std::string cameraInfoTopicOf(const std::string& image_topic) {
  std::string name = image_topic;
  for (const char* transport : {"/compressed", "/compressedDepth"}) {
    if (endsWith(name, transport)) name.erase(name.size() - std::string(transport).size());
  }
  const auto slash = name.rfind('/');
  return (slash == std::string::npos ? "" : name.substr(0, slash)) + "/camera_info";
}

}  // namespace headway::bags
