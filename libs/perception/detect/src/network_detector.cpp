// SPDX-License-Identifier: BSD-3-Clause
// A network that detects objects in single images: its format, its file, and the detector.
#include <headway/core/error.h>
#include <headway/detect/network_detector.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>
#include <set>
#include <vector>

#include "network_boxes.h"

namespace headway::detect {
namespace {

constexpr long kMaxLayoutNumber = 16384;
constexpr const char* kInstalledModels = "/usr/share/headway/models";
constexpr int kBoxColumns = 5;  // centre, size, objectness

[[noreturn]] void fail(const std::string& what) { throw InputError("[dnn] " + what); }

void requireFile(const std::string& key, const std::string& path, const std::string& kind) {
  if (path.empty()) {
    fail(key + " is not set: expected the path of " + kind +
         " (headway ships no weights; doc/detectors.md says where to get them)");
  }
  if (!std::filesystem::is_regular_file(path)) {
    fail(key + " = " + path + ": no such file; expected " + kind);
  }
}

/// Requires the numbers of a Darknet .cfg by which OpenCV divides or allocates to be possible.
void requireLayout(const std::string& path) {
  static const std::set<std::string> positive = {"width", "height", "channels", "filters",
                                                 "size",  "stride", "groups",   "classes",
                                                 "num",   "output"};
  std::ifstream file(path);
  std::string line;
  for (int number = 1; std::getline(file, line); ++number) {
    line.erase(std::remove_if(line.begin(), line.end(),
                              [](unsigned char c) { return std::isspace(c) != 0; }),
               line.end());
    const auto equals = line.find('=');
    if (line[0] == '#' || equals == std::string::npos) continue;
    if (positive.count(line.substr(0, equals)) == 0) continue;
    const long value = std::strtol(line.c_str() + equals + 1, nullptr, 10);
    if (value >= 1 && value <= kMaxLayoutNumber) continue;
    fail("layout = " + path + ":" + std::to_string(number) + ": " + line.substr(0, 80) +
         " is not from 1 to " + std::to_string(kMaxLayoutNumber));
  }
}

cv::dnn::Net load(const NetworkParams& params) {
  const bool darknet = params.family == NetworkParams::Family::kDarknet;
  requireFile("model", params.model, darknet ? "a Darknet .weights file" : "an ONNX model (YOLOX)");
  if (darknet) {
    requireFile("layout", params.layout, "the Darknet .cfg file of the weights");
    requireLayout(params.layout);
  }
  try {
    return darknet ? cv::dnn::readNetFromDarknet(params.layout, params.model)
                   : cv::dnn::readNetFromONNX(params.model);
  } catch (const cv::Exception&) {
    fail("model = " + params.model + ": OpenCV cannot read it as " +
         (darknet ? "Darknet weights of layout " + params.layout : "an ONNX model") +
         "; set family to what the file is");
  }
}

/// Parameters with the model's file.
NetworkParams withModel(NetworkParams params) {
  params.model = findModel(params);
  return params;
}

}  // namespace

std::string findModel(const NetworkParams& params) {
  if (!params.model.empty() || params.family != NetworkParams::Family::kYolox) return params.model;
  const char* folder = std::getenv("HEADWAY_MODELS");
  for (const auto& path : {std::string(folder != nullptr ? folder : ""), userModels(),
                           std::string(kInstalledModels)}) {
    for (const char* name : {"yolox_nano.onnx", "yolox_tiny.onnx"}) {
      const auto file = std::filesystem::path(path) / name;
      std::error_code unreadable;
      if (!path.empty() && std::filesystem::is_regular_file(file, unreadable)) return file.string();
    }
  }
  return "";
}

std::string userModels() {
  const auto isSet = [](const char* value) { return value != nullptr && *value != '\0'; };
  const char* data = std::getenv("XDG_DATA_HOME");
  const char* home = std::getenv("HOME");
  if (isSet(data)) return std::string(data) + "/headway/models";
  return isSet(home) ? std::string(home) + "/.local/share/headway/models" : "";
}

void NetworkParams::describe(Params::Section section) {
  auto user = section.user();
  user.add("family", family, {{"yolox", Family::kYolox}, {"darknet", Family::kDarknet}},
           "Kind of network that the weights are for");
  user.add("model", model, "File of the weights: .onnx (yolox) or .weights (darknet)");
  user.add("layout", layout, "File of the layers (.cfg), darknet only");
  user.add("classes", classes,
           "Classes of the network's outputs: coco, or KITTI's names separated by commas");
  user.add("min_score", min_score, 0.0, 1.0, "",
           "Minimum score of a box; smaller finds more objects and more false ones");
  section.add("input_width_px", input_width_px, 32, 4096, "px",
              "Width of the network's input, a multiple of 32");
  section.add("input_height_px", input_height_px, 32, 4096, "px",
              "Height of the network's input, a multiple of 32");
  section.add("scale", scale, 0.0, 10.0, "", "Factor of the grey levels 0 ... 255");
  section.add("swap_red_blue", swap_red_blue, "RGB input instead of BGR");
  section.add("letterbox", letterbox, "Keep the image's proportions and pad it with grey");
  section.add("tiles", tiles,
              "Run the network also on overlapping tiles of wide images, at its own scale");
  section.add("letterbox_grey", letterbox_grey, 0, 255, "", "Grey level of the letterbox padding");
  section.add("nms_iou", nms_iou, 0.0, 1.0, "IoU",
              "Non-maximum suppression: overlap from which the lower score of a class is dropped");
}

void NetworkParams::validate() const {
  validateRanges(*this, "dnn");
  if (input_width_px % 32 != 0 || input_height_px % 32 != 0) {
    fail("input_width_px and input_height_px must be multiples of 32, are " +
         std::to_string(input_width_px) + " and " + std::to_string(input_height_px));
  }
}

class NetworkDetector::Implementation {
 public:
  explicit Implementation(const NetworkParams& params)
      : params_(params), classes_(networkClasses(params.classes)), net_(load(params)) {
    // A first run shows whether the network is what the configuration says.
    (void)boxesIn(cv::Mat(64, 64, CV_8UC3, cv::Scalar::all(0)));
  }

  [[nodiscard]] const std::string& model() const { return params_.model; }

  std::vector<Detection> detect(const StereoFrame& frame) {
    cv::Mat image = frame.left_colour;
    if (image.empty()) cv::cvtColor(frame.left, image, cv::COLOR_GRAY2BGR);
    auto boxes = joinTiles(boxesOfTiles(image), image.cols, params_.nms_iou);
    for (auto& box : boxes) {
      box.box.left = std::clamp(box.box.left, 0.0, image.cols - 1.0);
      box.box.right = std::clamp(box.box.right, 0.0, image.cols - 1.0);
      box.box.top = std::clamp(box.box.top, 0.0, image.rows - 1.0);
      box.box.bottom = std::clamp(box.box.bottom, 0.0, image.rows - 1.0);
    }
    return toDetections(boxes, classes_);
  }

 private:
  /// Boxes of the image as a whole, for large objects, and of its tiles, for small ones.
  std::vector<TileBoxes> boxesOfTiles(const cv::Mat& image) {
    const cv::Rect whole({0, 0}, image.size());
    std::vector<TileBoxes> found = {{whole, boxesIn(image)}};
    if (!params_.tiles) return found;
    const auto tiles = tilesOf(image.size(), {params_.input_width_px, params_.input_height_px});
    if (tiles.size() == 1) return found;
    for (const cv::Rect& tile : tiles) {
      auto boxes = boxesIn(image(tile));
      for (NetworkBox& box : boxes) {
        box.box.left += tile.x;
        box.box.right += tile.x;
      }
      found.push_back({tile, std::move(boxes)});
    }
    return found;
  }

  std::vector<NetworkBox> boxesIn(const cv::Mat& image) {
    const cv::Size size(params_.input_width_px, params_.input_height_px);
    InputFit fit{size.width / static_cast<double>(image.cols),
                 size.height / static_cast<double>(image.rows)};
    if (params_.letterbox) fit.scale_x = fit.scale_y = std::min(fit.scale_x, fit.scale_y);
    cv::Mat input(size, CV_8UC3, cv::Scalar::all(params_.letterbox_grey));
    const cv::Size inner(std::max(1, static_cast<int>(image.cols * fit.scale_x)),
                         std::max(1, static_cast<int>(image.rows * fit.scale_y)));
    cv::resize(image, input({0, 0, inner.width, inner.height}), inner);
    std::vector<cv::Mat> outputs;
    try {
      net_.setInput(cv::dnn::blobFromImage(input, params_.scale, size, {}, params_.swap_red_blue));
      net_.forward(outputs, net_.getUnconnectedOutLayersNames());
    } catch (const cv::Exception&) {
      fail("model = " + params_.model + ": cannot run on an input of " +
           std::to_string(size.width) + "x" + std::to_string(size.height) +
           " px; set input_width_px and input_height_px to those it was made for");
    }
    std::vector<NetworkBox> boxes;
    for (const auto& output : outputs) {
      const auto found = decodeRows(rowsOf(output), params_, fit);
      boxes.insert(boxes.end(), found.begin(), found.end());
    }
    return boxes;
  }

  // The output as one box a row; checks that it is what the family gives.
  [[nodiscard]] cv::Mat rowsOf(const cv::Mat& output) const {
    const int columns = kBoxColumns + static_cast<int>(classes_.size());
    const bool yolox = params_.family == NetworkParams::Family::kYolox;
    const int wanted_rows = yolox ? yoloxRows(params_.input_width_px, params_.input_height_px) : -1;
    const int last = output.size[output.dims - 1];
    const auto rows = static_cast<int>(output.total() / std::max(1, last));
    if (output.type() != CV_32F || last != columns || (yolox && rows != wanted_rows)) {
      fail("model = " + params_.model + ": gives " + std::to_string(rows) + " rows of " +
           std::to_string(last) + " values, expected " +
           (yolox ? std::to_string(wanted_rows) + " rows of " : std::string("rows of ")) +
           std::to_string(columns) + " (4 for the box, 1 objectness, " +
           std::to_string(classes_.size()) + " classes); check family, classes and input size");
    }
    return output.reshape(1, rows);
  }

  NetworkParams params_;
  std::vector<NetworkClass> classes_;
  cv::dnn::Net net_;
};

NetworkDetector::NetworkDetector(const NetworkParams& params)
    : implementation_(std::make_unique<Implementation>(withModel(validated(params)))) {}

NetworkDetector::~NetworkDetector() = default;

const std::string& NetworkDetector::model() const { return implementation_->model(); }

Detections NetworkDetector::detect(const StereoFrame& frame) {
  Detections detections = emptyDetections(frame);
  detections.items = implementation_->detect(frame);
  for (auto& detection : detections.items) detection.evidence.classifier = true;
  return detections;
}

std::string sha256OfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read");
  const std::string content{std::istreambuf_iterator<char>(file), {}};
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned size = 0;
  if (file.bad() ||
      EVP_Digest(content.data(), content.size(), hash.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw InputError(path + ": its SHA-256 cannot be computed");
  }
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[hash[i] >> 4U];
    text += kDigits[hash[i] & 0xFU];
  }
  return text;
}

}  // namespace headway::detect
