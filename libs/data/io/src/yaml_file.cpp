// SPDX-License-Identifier: BSD-3-Clause
// Numbers and strings of YAML files, for MRPT's parser checked first: it does not return from some
// texts.
#include "yaml_file.h"

#include <headway/core/error.h>
#include <headway/io/image_file.h>
#include <libfyaml.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <typeinfo>

#include "text_rows.h"

namespace headway::io {
namespace {

std::string firstLineOf(const std::exception& error) {
  const std::string text = error.what();
  return text.substr(0, text.find('\n'));
}

constexpr int kMaxDepth = 32;  // of nested lists; libfyaml recurses

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code unknown;  // then as much as is allowed
  const auto size =
      std::min<std::uintmax_t>(std::filesystem::file_size(path, unknown), kMaxCalibrationBytes + 1);
  std::string content(static_cast<std::size_t>(size), '\0');
  file.read(content.data(), static_cast<std::streamsize>(content.size()));
  content.resize(static_cast<std::size_t>(file.gcount()));
  return content;
}

/// Why libfyaml must not be given a text; empty if it may be. It does not return from a directive
/// with a byte that is not printable, and recurses into lists without limit.
std::string unsafeBecause(const std::string& content) {
  if (content.size() > kMaxCalibrationBytes) return "it is larger than 1 MB";
  int brackets = 0;
  int indicators = 0;  // since the last other character
  for (std::size_t at = 0; at < content.size(); ++at) {
    const char c = content[at];
    const bool is_control =
        static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t' && c != '\r';
    if (is_control || c == '\x7F') return "it contains a control character";
    // Carriage returns and breaks of Unicode end lines too.
    const char before = at == 0 ? '\n' : content[at - 1];
    const bool is_start = before == '\n' || before == '\r' || static_cast<signed char>(before) < 0;
    if (c == '%' && is_start) {
      const std::string line = content.substr(at, content.find('\n', at) - at);
      const bool is_text = std::all_of(line.begin(), line.end(), [](char one) {
        return (one >= ' ' && one <= '~') || one == '\t' || one == '\r';
      });
      if (!is_text) return "a directive contains a byte that is not ASCII";
    }
    if (c == '[' || c == '{') ++brackets;
    if ((c == ']' || c == '}') && brackets > 0) --brackets;
    if (c == '-' || c == '?' || c == ':') ++indicators;
    if (c != '-' && c != '?' && c != ':' && c != ' ' && c != '\t' && c != '\n' && c != '\r') {
      indicators = 0;
    }
    if (brackets > kMaxDepth || indicators > 10 * kMaxDepth)
      return "its lists are nested too deeply";
  }
  return "";
}

/// Why a text is not one whole document, as libfyaml says it; empty if it is. MRPT's parser takes
/// what comes before an error for the whole, and lets libfyaml print.
std::string incompleteBecause(const std::string& content) {
  char* messages = nullptr;
  std::size_t size = 0;
  FILE* stream = open_memstream(&messages, &size);
  fy_diag_cfg said{};
  fy_diag_cfg_default(&said);
  said.fp = stream;
  said.colorize = said.show_source = false;
  fy_diag* diagnosis = fy_diag_create(&said);
  fy_parse_cfg options{};
  options.diag = diagnosis;
  fy_parser* parser = fy_parser_create(&options);
  int documents = 0;
  bool has_failed =
      parser == nullptr || fy_parser_set_string(parser, content.data(), content.size()) != 0;
  while (!has_failed) {
    fy_document* document = fy_parse_load_document(parser);
    if (document == nullptr) break;
    fy_parse_document_destroy(parser, document);
    ++documents;
  }
  has_failed = has_failed || fy_parser_get_stream_error(parser);
  fy_parser_destroy(parser);
  fy_diag_destroy(diagnosis);
  (void)std::fclose(stream);
  std::string text(messages, size);
  std::free(messages);
  if (!has_failed) return documents > 1 ? "it contains several documents" : "";
  text = text.substr(0, text.find('\n'));
  const auto place = text.find(">:");  // after the name of a text in memory
  return place == std::string::npos ? "its end is missing" : "line " + text.substr(place + 2);
}

/// The text without what OpenCV's FileStorage adds to YAML: a directive that is none, and tags.
std::string withoutOpenCvMarks(std::string content) {
  if (content.rfind("%YAML:", 0) == 0) content.erase(0, content.find('\n'));
  const std::string tag = "!!opencv-matrix";
  for (auto at = content.find(tag); at != std::string::npos; at = content.find(tag, at)) {
    content.replace(at, tag.size(), tag.size(), ' ');
  }
  return content;
}

/// Whether every key, at any depth, is a string. MRPT reads `NULL` and `~` as keys of no type, and
/// then throws from every search of their map.
bool hasOnlyNames(const mrpt::containers::yaml::node_t& node) {
  if (node.isSequence()) {
    const auto& list = node.asSequence();
    return std::all_of(list.begin(), list.end(), hasOnlyNames);
  }
  if (!node.isMap()) return true;
  const auto& map = node.asMap();
  return std::all_of(map.begin(), map.end(), [](const auto& entry) {
    const auto& [key, value] = entry;
    return key.isScalar() && key.asScalar().type() == typeid(std::string) && hasOnlyNames(value);
  });
}

}  // namespace

YamlFile::YamlFile(const std::string& path) : path_(path) {
  if (!std::filesystem::is_regular_file(path)) fail("does not exist");
  const std::string content = withoutOpenCvMarks(contentOf(path));
  const std::string reason = unsafeBecause(content);
  if (!reason.empty()) fail("is not read: " + reason);
  const std::string incomplete = incompleteBecause(content);
  if (!incomplete.empty()) fail("is not a YAML file: " + incomplete);
  try {
    root_ = mrpt::containers::yaml::FromText(content);
  } catch (const std::exception& error) {
    fail("is not a YAML file: " + firstLineOf(error));
  }
  if (!root_.isMap()) fail("is not a YAML map");
  if (!hasOnlyNames(root_.node())) fail("is not read: one of its keys is not a string");
}

std::vector<double> YamlFile::numbers(const std::string& key, std::size_t min_size,
                                      std::size_t max_size) const {
  if (!root_.has(key)) fail("key '" + prefix_ + key + "' is missing");
  std::vector<double> values;
  const auto add = [&](const mrpt::containers::yaml::node_t& node) {
    const auto value = node.isScalar() ? parseNumber(node.as<std::string>()) : std::nullopt;
    if (!value) fail("key '" + prefix_ + key + "' contains a value that is not a number");
    values.push_back(*value);
  };
  const mrpt::containers::yaml entry = root_[key];
  const mrpt::containers::yaml list =
      entry.isMap() && entry.has("data") ? mrpt::containers::yaml(entry["data"]) : entry;
  if (list.isSequence()) {
    for (const auto& node : list.asSequence()) {
      if (!node.isSequence()) {
        add(node);
        continue;
      }
      for (const auto& number : node.asSequence()) add(number);
    }
  } else {
    add(list.node());
  }
  if (values.size() < min_size || values.size() > max_size) {
    fail("key '" + prefix_ + key + "' has " + std::to_string(values.size()) + " numbers, must be " +
         std::to_string(min_size) +
         (max_size > min_size ? " to " + std::to_string(max_size) : std::string()));
  }
  return values;
}

cv::Size YamlFile::imageSize(const std::string& key) const {
  const auto sides = numbers(key, 2, 2);
  for (const double side : sides) {
    if (!(side >= 1.0 && side <= kMaxImageSide) || side != std::floor(side)) {
      fail("key '" + key + "' is no size of images [px]");
    }
  }
  return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
}

YamlFile YamlFile::within(const std::string& key) const {
  if (!root_.has(key)) fail("key '" + prefix_ + key + "' is missing");
  mrpt::containers::yaml entry = root_[key];
  if (!entry.isMap()) fail("key '" + prefix_ + key + "' has no keys of its own");
  return YamlFile(path_, prefix_ + key + ".", std::move(entry));
}

std::string YamlFile::word(const std::string& key) const {
  if (!root_.has(key)) fail("key '" + prefix_ + key + "' is missing");
  const mrpt::containers::yaml entry = root_[key];
  if (!entry.isScalar()) fail("key '" + prefix_ + key + "' is not a string");
  return entry.node().as<std::string>();
}

Pose YamlFile::pose(const std::string& key) const {
  const auto values = numbers(key, 12, 16);
  Pose pose = Pose::Identity();
  for (std::size_t i = 0; i < 12; ++i) {
    pose.matrix()(static_cast<Eigen::Index>(i / 4), static_cast<Eigen::Index>(i % 4)) = values[i];
  }
  if (!pose.matrix().allFinite() || !isRotation(pose.linear())) {
    fail("key '" + prefix_ + key + "' is not a pose: its 3x3 part is not a rotation");
  }
  return pose;
}

void YamlFile::requireOnly(const std::vector<std::string>& known) const {
  for (const auto& [key, value] : root_.asMap()) {
    const auto name = key.as<std::string>();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      fail("key '" + prefix_ + name + "' is unknown");
    }
  }
}

void YamlFile::fail(const std::string& reason) const { throw InputError(path_ + ": " + reason); }

}  // namespace headway::io
