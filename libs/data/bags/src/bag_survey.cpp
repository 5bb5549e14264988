// SPDX-License-Identifier: BSD-3-Clause
#include "bag_survey.h"

#include <algorithm>
#include <set>

#include "broken_data.h"

namespace headway::bags {
namespace {

constexpr std::int64_t kMaxNanoseconds = 10'000'000'000;

/// Topics of which something must be known before the import.
class Surveyor {
 public:
  Surveyor(const std::vector<BagTopic>& topics, const BagSelection& selection)
      : transform_topics_(selection.tf.begin(), selection.tf.end()) {
    for (const auto& image : {selection.left, selection.right, selection.color, selection.depth}) {
      if (image.empty()) continue;
      sensors_.insert(image);
      const std::string info = cameraInfoTopicOf(image);
      const bool exists = std::any_of(topics.begin(), topics.end(), [&](const BagTopic& topic) {
        return topic.name == info && topic.messages > 0;
      });
      if (exists) missing_infos_.insert(info);
    }
    for (const auto* names : {&selection.imu, &selection.scans}) {
      sensors_.insert(names->begin(), names->end());
    }
    if (!selection.gnss.empty()) sensors_.insert(selection.gnss);
  }

  void use(const BagTopic& topic, const BagMessage& message) {
    try {
      if (missing_infos_.count(topic.name) > 0) {
        survey.camera_infos[topic.name] = decodeCameraInfo(message.content, topic.encoding).info;
        missing_infos_.erase(topic.name);
      } else if (transform_topics_.count(topic.name) > 0) {
        const bool is_static = topic.name.find("static") != std::string::npos;
        for (const auto& transform : decodeTransforms(message.content, topic.encoding)) {
          survey.transforms.add(transform, is_static);
        }
      } else if (sensors_.count(topic.name) > 0 && survey.frames.count(topic.name) == 0) {
        survey.frames[topic.name] = decodeHeader(message.content, topic.encoding).frame;
      }
    } catch (const BrokenData&) {  // counted when it is imported, or there is another one
    }
  }

  [[nodiscard]] bool hasInfos() const { return missing_infos_.empty(); }
  /// Whether nothing more can be learnt: all sensors have frames that belong to one tree.
  [[nodiscard]] bool isComplete() const {
    if (!hasInfos() || survey.frames.size() < sensors_.size()) return false;
    if (transform_topics_.empty()) return true;
    const std::string& first = survey.frames.begin()->second;
    return survey.transforms.contains("base_link") &&
           survey.transforms.between("base_link", first) &&
           std::all_of(survey.frames.begin(), survey.frames.end(), [&](const auto& frame) {
             return survey.transforms.between(first, frame.second).has_value();
           });
  }

  BagSurvey survey;

 private:
  std::set<std::string> missing_infos_;
  std::set<std::string> transform_topics_;
  std::set<std::string> sensors_;
};

}  // namespace

BagSurvey surveyBag(const std::string& path, const BagSelection& selection) {
  const auto bag = openBag(path);
  Surveyor surveyor(bag->topics(), selection);
  std::optional<std::int64_t> start;
  while (const auto message = bag->next()) {
    surveyor.use(bag->topics()[message->topic], *message);
    start = std::min(start.value_or(message->received_ns), message->received_ns);
    const bool is_late = message->received_ns / 2 - *start / 2 > kMaxNanoseconds / 2;
    if (surveyor.isComplete() || (is_late && surveyor.hasInfos())) break;
  }
  return surveyor.survey;
}

}  // namespace headway::bags
