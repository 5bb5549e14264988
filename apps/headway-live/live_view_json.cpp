// SPDX-License-Identifier: BSD-3-Clause
#include "live_view_json.h"

#include <headway/core/ellipse.h>
#include <headway/core/object_class.h>

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace headway::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kPathSpacing = 0.2;  // [m]
constexpr std::size_t kMaxPathPositions = 2000;
constexpr std::size_t kPointsOfPath = 6;  // of a predicted path
constexpr int kJpegQuality = 75;
constexpr float kFreeAbove = 0.65F, kOccupiedBelow = 0.35F;  // probability of a cell to be free

Json colourJson(Colour colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text;
}

/// JSON has no infinity; what is not finite is shown at 0.
double finite(double value) { return std::isfinite(value) ? value : 0.0; }

Json pathJson(const PredictedPath& path) {
  Json points = Json::array();
  const std::size_t step = std::max<std::size_t>(1, path.points.size() / kPointsOfPath);
  for (std::size_t i = step - 1; i < path.points.size(); i += step) {
    const PredictedPoint& point = path.points[i];
    const Ellipse ellipse = sigmaEllipse(point.covariance);
    points.push_back({finite(point.position.x()), finite(point.position.y()), finite(ellipse.major),
                      finite(ellipse.minor), finite(ellipse.angle)});
  }
  return {{"probability", finite(path.probability)}, {"points", points}};
}

Json trackJson(const Track& track) {
  Json json = {{"id", track.id.value},
               {"class", displayName(track.object_class)},
               {"colour", colourJson(colourOf(track.object_class))},
               {"moving", isMoving(track)},
               {"coasting", track.status == TrackStatus::kCoasting},
               {"x", finite(track.position.x())},
               {"y", finite(track.position.y())},
               {"yaw", finite(track.yaw)},
               {"length", finite(track.size.x())},
               {"width", finite(track.size.y())},
               {"speed", finite(track.velocity.head<2>().norm())},
               {"paths", Json::array()}};
  if (const auto& box = track.box2d) json["box"] = {box->left, box->top, box->right, box->bottom};
  if (!isMoving(track)) return json;
  for (const auto& path : track.predictions) {
    if (!path.points.empty()) json["paths"].push_back(pathJson(path));
  }
  return json;
}

Json gridJson(const map::PerceptionMap& map, std::size_t version) {
  const auto grid = map.staticGrid();
  if (!grid) return nullptr;
  return {{"version", version},
          {"x", grid->getXMin()},
          {"y", grid->getYMin()},
          {"width", grid->getXMax() - grid->getXMin()},
          {"height", grid->getYMax() - grid->getYMin()}};
}

Json sensorJson(const drivers::SensorStatus& sensor) {
  return {{"name", sensor.name},
          {"running", sensor.is_running},
          {"error", sensor.error},
          {"observations", sensor.observations},
          {"restarts", sensor.restarts}};
}

std::string encoded(const std::string& extension, const cv::Mat& image,
                    const std::vector<int>& options = {}) {
  std::vector<unsigned char> bytes;
  if (image.empty() || !cv::imencode(extension, image, bytes, options)) return {};
  return {bytes.begin(), bytes.end()};
}

}  // namespace

void DrivenPath::add(const Pose& T_map_robot) {
  const Eigen::Vector2d position = T_map_robot.translation().head<2>();
  if (!position.allFinite()) return;
  if (!positions_.empty() && (position - positions_.back()).norm() < kPathSpacing) return;
  positions_.push_back(position);
  if (positions_.size() > kMaxPathPositions) positions_.pop_front();
}

std::string jsonOf(const LiveView& view, const DrivenPath& path, std::size_t grid_version) {
  const auto& camera = view.update.camera;
  const auto& place = camera.T_map_robot.translation();
  Json json = {{"frame", view.update.frame},
               {"time", view.update.time},
               {"status", slam::toString(camera.status)},
               {"pose", {finite(place.x()), finite(place.y()), finite(yawOf(camera.T_map_robot))}},
               {"inliers", camera.inliers},
               {"latency_ms", 1e3 * view.latency_s},
               {"process_ms", 1e3 * view.process_s},
               {"frames", view.frames},
               {"dropped", view.dropped},
               {"has_image", view.frame.stereo.has_value()},
               {"grid", gridJson(view.map, grid_version)},
               {"tracks", Json::array()},
               {"path", Json::array()},
               {"sensors", Json::array()},
               {"warnings", Json::array()}};
  for (const auto& track : view.update.objects.tracks) {
    if (isShown(track)) json["tracks"].push_back(trackJson(track));
  }
  for (const auto& position : path.positions()) {
    json["path"].push_back(
        {std::round(position.x() * 100) / 100, std::round(position.y() * 100) / 100});
  }
  for (const auto& sensor : view.sensors) json["sensors"].push_back(sensorJson(sensor));
  for (const auto& [name, warning] : view.warnings) {
    json["warnings"].push_back(warning.text + " (" + std::to_string(warning.count) + "x)");
  }
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string jpegOf(const RecordedFrame& frame) {
  if (!frame.stereo) return {};
  const auto& colour = frame.stereo->left_colour;
  return encoded(".jpg", colour.empty() ? frame.stereo->left : colour,
                 {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
}

std::string pngOf(const map::PerceptionMap& map) {
  const auto grid = map.staticGrid();
  if (!grid) return {};
  const auto columns = static_cast<int>(grid->getSizeX());
  const auto rows = static_cast<int>(grid->getSizeY());
  cv::Mat picture(rows, columns, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      const float free = grid->getCell(x, y);
      auto& pixel = picture.at<cv::Vec4b>(rows - 1 - y, x);
      if (free > kFreeAbove) pixel = {0x43, 0x38, 0x2f, 255};
      if (free < kOccupiedBelow) pixel = {0xe4, 0xd9, 0xcf, 255};
    }
  }
  return encoded(".png", picture, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

}  // namespace headway::live
