// SPDX-License-Identifier: BSD-3-Clause
// What the rows and boxes of a detection network mean: decoding, classes, tiles, overlaps.
#include "network_boxes.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>
#include <tuple>

namespace headway::detect {
namespace {

constexpr double kRiderOnBicycle = 0.3;  // ratio of a bicycle's box inside its rider's
constexpr double kSameVehicle = 0.6;     // overlap of the boxes of one vehicle of two classes

std::vector<NetworkClass> cocoClasses() {
  std::vector<NetworkClass> classes(80);
  classes[0].object_class = ObjectClass::kPedestrian;  // person
  classes[1].bicycle = true;                           // bicycle
  classes[2].object_class = ObjectClass::kCar;         // car
  classes[3].bicycle = true;                           // motorcycle: its rider moves alike
  classes[5].object_class = ObjectClass::kTruck;       // bus
  classes[6].object_class = ObjectClass::kTram;        // train
  classes[7].object_class = ObjectClass::kTruck;       // truck
  return classes;
}

/// The smallest box that contains both.
Box2d around(const Box2d& a, const Box2d& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

// Networks trained on COCO report a van as car and as truck.
bool isSameVehicle(const Detection& a, const Detection& b) {
  return isVehicle(a.object_class) && isVehicle(b.object_class) &&
         overlap2d(*a.box2d, *b.box2d) > kSameVehicle;
}

// A rider's box reaches into the upper part of the bicycle's.
bool rides(const Box2d& person, const Box2d& bicycle) {
  return ratioInside(bicycle, person) > kRiderOnBicycle &&
         person.bottom > bicycle.top + 0.2 * bicycle.height() && person.top < bicycle.top;
}

}  // namespace

std::vector<NetworkClass> networkClasses(const std::string& names) {
  if (names == "coco") return cocoClasses();
  std::vector<NetworkClass> classes;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    const auto first = name.find_first_not_of(' ');
    const auto last = name.find_last_not_of(' ');
    if (first == std::string::npos) name.clear();
    if (!name.empty()) name = name.substr(first, last - first + 1);
    NetworkClass one;
    one.object_class = objectClassFrom(name);
    classes.push_back(one);
  }
  return classes;
}

std::vector<Detection> toDetections(const std::vector<NetworkBox>& boxes,
                                    const std::vector<NetworkClass>& classes) {
  std::vector<Detection> detections;
  for (const auto& box : boxes) {
    const NetworkClass& network_class = classes.at(box.network_class);
    if (!network_class.object_class) continue;
    Detection detection;
    detection.object_class = *network_class.object_class;
    detection.score = box.score;
    detection.box2d = box.box;
    const bool known = std::any_of(detections.begin(), detections.end(),
                                   [&](const auto& d) { return isSameVehicle(d, detection); });
    if (!known) detections.push_back(detection);
  }
  for (const auto& box : boxes) {
    if (!classes.at(box.network_class).bicycle) continue;
    for (auto& detection : detections) {
      if (detection.object_class != ObjectClass::kPedestrian) continue;
      if (!rides(*detection.box2d, box.box)) continue;
      detection.object_class = ObjectClass::kCyclist;
      detection.box2d = around(*detection.box2d, box.box);
      break;
    }
  }
  return detections;
}

namespace {

constexpr std::array<int, 3> kStrides = {8, 16, 32};

struct GridCell {
  int column;
  int row;
  int stride;
};

std::vector<GridCell> yoloxCells(int width, int height) {
  std::vector<GridCell> cells;
  for (const int stride : kStrides) {
    for (int row = 0; row < height / stride; ++row) {
      for (int column = 0; column < width / stride; ++column) {
        cells.push_back({column, row, stride});
      }
    }
  }
  return cells;
}

// Centre and size in pixels of the network's input.
cv::Vec4d inputBox(const float* row, const NetworkParams& params, const GridCell* cell) {
  if (cell != nullptr) {
    const double stride = cell->stride;
    return {(static_cast<double>(row[0]) + cell->column) * stride,
            (static_cast<double>(row[1]) + cell->row) * stride,
            std::exp(static_cast<double>(row[2])) * stride,
            std::exp(static_cast<double>(row[3])) * stride};
  }
  return {row[0] * static_cast<double>(params.input_width_px),
          row[1] * static_cast<double>(params.input_height_px),
          row[2] * static_cast<double>(params.input_width_px),
          row[3] * static_cast<double>(params.input_height_px)};
}

}  // namespace

int yoloxRows(int input_width_px, int input_height_px) {
  int rows = 0;
  for (const int stride : kStrides) rows += (input_width_px / stride) * (input_height_px / stride);
  return rows;
}

std::vector<NetworkBox> decodeRows(const cv::Mat& rows, const NetworkParams& params,
                                   const InputFit& fit) {
  const bool yolox = params.family == NetworkParams::Family::kYolox;
  const auto cells =
      yolox ? yoloxCells(params.input_width_px, params.input_height_px) : std::vector<GridCell>{};
  std::vector<NetworkBox> boxes;
  for (int i = 0; i < rows.rows; ++i) {
    const float* row = rows.ptr<float>(i);
    const float* best = std::max_element(row + 5, row + rows.cols);
    const double score = yolox ? static_cast<double>(row[4]) * *best : *best;
    if (!(score >= params.min_score)) continue;
    const cv::Vec4d box = inputBox(row, params, yolox ? &cells[i] : nullptr);
    NetworkBox found;
    found.score = score;
    found.network_class = static_cast<std::size_t>(best - row - 5);
    found.box = {(box[0] - 0.5 * box[2]) / fit.scale_x, (box[1] - 0.5 * box[3]) / fit.scale_y,
                 (box[0] + 0.5 * box[2]) / fit.scale_x, (box[1] + 0.5 * box[3]) / fit.scale_y};
    boxes.push_back(found);
  }
  return boxes;
}

std::vector<NetworkBox> withoutOverlaps(std::vector<NetworkBox> boxes, double nms_iou) {
  std::sort(boxes.begin(), boxes.end(), [](const NetworkBox& a, const NetworkBox& b) {
    return std::make_tuple(-a.score, a.box.left, a.box.top) <
           std::make_tuple(-b.score, b.box.left, b.box.top);
  });
  std::vector<NetworkBox> kept;
  for (const auto& box : boxes) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const NetworkBox& other) {
      return other.network_class == box.network_class && overlap2d(other.box, box.box) > nms_iou;
    });
    if (!known) kept.push_back(box);
  }
  return kept;
}

namespace {

constexpr double kMinOverlap = 0.2;          // of neighbouring tiles, over their width
constexpr double kEnoughPixels = 2.0 / 3.0;  // per row of the whole image, over those of a tile
constexpr double kEdge_px = 6.0;             // boxes that end nearer to a tile's edge are cut by it
constexpr int kMaxTiles = 8;                 // narrower than a tile by less than the overlap
constexpr double kPartInside = 0.7;          // of a cut box inside the whole one

/// A box, and by which inner edges of its tile it is cut.
struct TileBox {
  NetworkBox box;
  bool cut_left = false;
  bool cut_right = false;
  std::size_t first_tile = 0;
  std::size_t last_tile = 0;  ///< another one if the box is joined of parts

  [[nodiscard]] bool isCut() const { return cut_left || cut_right; }
};

std::vector<TileBox> markCuts(const std::vector<TileBoxes>& tiles, int image_width) {
  std::vector<TileBox> marked;
  for (std::size_t t = 0; t < tiles.size(); ++t) {
    const cv::Rect& tile = tiles[t].tile;
    for (const NetworkBox& box : tiles[t].boxes) {
      TileBox one{box, false, false, t, t};
      one.cut_left = tile.x > 0 && box.box.left < tile.x + kEdge_px;
      one.cut_right =
          tile.x + tile.width < image_width && box.box.right > tile.x + tile.width - kEdge_px;
      marked.push_back(one);
    }
  }
  // Complete boxes first, so that they suppress their parts.
  std::stable_sort(marked.begin(), marked.end(), [](const TileBox& a, const TileBox& b) {
    if (a.isCut() != b.isCut()) return b.isCut();
    return a.box.score > b.box.score;
  });
  return marked;
}

bool sameRows(const Box2d& a, const Box2d& b) {
  const double common = std::min(a.bottom, b.bottom) - std::max(a.top, b.top);
  return common > 0.5 * std::max(a.height(), b.height());
}

/// Whether two cut boxes of neighbouring tiles are parts of one object.
bool areParts(const TileBox& a, const TileBox& b) {
  const TileBox& left = a.first_tile < b.first_tile ? a : b;
  const TileBox& right = a.first_tile < b.first_tile ? b : a;
  return right.first_tile == left.last_tile + 1 && left.cut_right && right.cut_left &&
         left.box.box.right > right.box.box.left && sameRows(left.box.box, right.box.box);
}

/// Extends a part by another one, which may be cut on its far side.
void join(const TileBox& part, TileBox& whole) {
  const bool from_left = part.first_tile < whole.first_tile;
  Box2d& box = whole.box.box;
  box = around(box, part.box.box);
  (from_left ? whole.cut_left : whole.cut_right) = from_left ? part.cut_left : part.cut_right;
  (from_left ? whole.first_tile : whole.last_tile) = from_left ? part.first_tile : part.last_tile;
}

bool suppresses(const TileBox& kept, const TileBox& other, double nms_iou) {
  if (overlap2d(kept.box.box, other.box.box) > nms_iou) return true;
  const bool is_other_tile = kept.first_tile > other.last_tile || kept.last_tile < other.first_tile;
  return other.isCut() && is_other_tile && ratioInside(other.box.box, kept.box.box) > kPartInside;
}

}  // namespace

std::vector<cv::Rect> tilesOf(cv::Size image, cv::Size input) {
  const int narrowest = (image.width + kMaxTiles - 1) / kMaxTiles;
  const int width =
      std::max(narrowest, static_cast<int>(std::lround(static_cast<double>(image.height) *
                                                       input.width / input.height)));
  if (width >= kEnoughPixels * image.width) return {{0, 0, image.width, image.height}};
  const double step = (1.0 - kMinOverlap) * width;
  const int steps = static_cast<int>(std::ceil((image.width - width) / step));
  std::vector<cv::Rect> tiles;
  for (int k = 0; k <= steps; ++k) {
    tiles.emplace_back((image.width - width) * k / steps, 0, width, image.height);
  }
  return tiles;
}

std::vector<NetworkBox> joinTiles(const std::vector<TileBoxes>& tiles, int image_width,
                                  double nms_iou) {
  std::vector<TileBox> kept;
  for (const TileBox& box : markCuts(tiles, image_width)) {
    bool known = false;
    for (TileBox& other : kept) {
      if (other.box.network_class != box.box.network_class) continue;
      if (other.isCut() && box.isCut() && areParts(other, box)) {
        join(box, other);
        known = true;
      } else {
        known = suppresses(other, box, nms_iou);
      }
      if (known) break;
    }
    if (!known) kept.push_back(box);
  }
  std::vector<NetworkBox> boxes;
  for (const TileBox& box : kept) boxes.push_back(box.box);
  return withoutOverlaps(std::move(boxes), nms_iou);
}

}  // namespace headway::detect
