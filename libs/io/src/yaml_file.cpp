#include "yaml_file.h"

#include <headway/core/error.h>

#include <algorithm>
#include <filesystem>

#include "text_rows.h"

namespace headway::io {
namespace {

constexpr double kRotationTolerance = 1e-3;

std::string firstLineOf(const std::exception& error) {
  const std::string text = error.what();
  return text.substr(0, text.find('\n'));
}

}  // namespace

YamlFile::YamlFile(const std::string& path) : path_(path) {
  if (!std::filesystem::is_regular_file(path)) fail("does not exist");
  try {
    root_ = mrpt::containers::yaml::FromFile(path);
  } catch (const std::exception& error) {
    fail("is not a YAML file: " + firstLineOf(error));
  }
  if (!root_.isMap()) fail("is not a YAML map");
}

std::vector<double> YamlFile::numbers(const std::string& key, std::size_t min_size,
                                      std::size_t max_size) const {
  if (!root_.has(key)) fail("key '" + key + "' is missing");
  std::vector<double> values;
  const auto add = [&](const mrpt::containers::yaml::node_t& node) {
    const auto value = node.isScalar() ? parseNumber(node.as<std::string>()) : std::nullopt;
    if (!value) fail("key '" + key + "' contains a value that is not a number");
    values.push_back(*value);
  };
  const mrpt::containers::yaml entry = root_[key];
  const mrpt::containers::yaml list =
      entry.isMap() && entry.has("data") ? mrpt::containers::yaml(entry["data"]) : entry;
  if (list.isSequence()) {
    for (const auto& node : list.asSequence()) add(node);
  } else {
    add(list.node());
  }
  if (values.size() < min_size || values.size() > max_size) {
    fail("key '" + key + "' has " + std::to_string(values.size()) + " numbers, must be " +
         std::to_string(min_size) +
         (max_size > min_size ? " to " + std::to_string(max_size) : std::string()));
  }
  return values;
}

std::string YamlFile::word(const std::string& key) const {
  if (!root_.has(key)) fail("key '" + key + "' is missing");
  const mrpt::containers::yaml entry = root_[key];
  if (!entry.isScalar()) fail("key '" + key + "' is not a string");
  return entry.node().as<std::string>();
}

Pose YamlFile::pose(const std::string& key) const {
  const auto values = numbers(key, 12, 16);
  Pose pose = Pose::Identity();
  for (std::size_t i = 0; i < 12; ++i) {
    pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = values[i];
  }
  const Eigen::Matrix3d turn = pose.linear();
  if (!pose.matrix().allFinite() || turn.determinant() < 0.0 ||
      !(turn * turn.transpose()).isIdentity(kRotationTolerance)) {
    fail("key '" + key + "' is not a pose: its 3x3 part is not a rotation");
  }
  return pose;
}

void YamlFile::requireOnly(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : root_.asMap()) {
    const auto name = key.as<std::string>();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      fail("key '" + name + "' is unknown");
    }
  }
}

void YamlFile::fail(const std::string& reason) const { throw InputError(path_ + ": " + reason); }

}  // namespace headway::io
