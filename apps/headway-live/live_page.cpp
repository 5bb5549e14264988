// SPDX-License-Identifier: BSD-3-Clause
// The page of a live run: what it shows as JSON and pictures.
#include "live_page.h"

#include <headway/core/ellipse.h>
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/core/stage_times.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>

#include "page_files.h"
#include "page_server.h"

namespace headway::live {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMaxAge_s = 1.0;  // of the newest frame while a robot may rely on it

/// The robot's positions so far, for the map; thinned and bounded.
class DrivenPath {
 public:
  void add(const Pose& T_map_robot) {
    const Eigen::Vector2d position = T_map_robot.translation().head<2>();
    if (!position.allFinite()) return;
    // 0.2 m is less than a robot is long; 2000 positions bound the size of an event.
    if (!positions_.empty() && (position - positions_.back()).norm() < 0.2) return;
    positions_.push_back(position);
    if (positions_.size() > 2000) positions_.pop_front();
  }
  [[nodiscard]] const std::deque<Eigen::Vector2d>& positions() const { return positions_; }

 private:
  std::deque<Eigen::Vector2d> positions_;  ///< map frame, oldest first [m]
};

Json colourJson(Colour colour) {
  char text[8];
  std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
  return text;
}

/// JSON has no infinity; what is not finite is shown at 0.
double finite(double value) { return std::isfinite(value) ? value : 0.0; }

/// Six points of a predicted path show its shape.
Json pathJson(const PredictedPath& path) {
  Json points = Json::array();
  const std::size_t step = std::max<std::size_t>(1, path.points.size() / 6);
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

/// Since the images of a frame came [s].
double ageOf(double arrival_s) { return monotonicSeconds() - arrival_s; }

Json warningsJson(const Warnings& warnings) {
  Json json = Json::array();
  for (const auto& [name, warning] : warnings) {
    json.push_back(warning.text + " (" + std::to_string(warning.count) + "x)");
  }
  return json;
}

Json sensorsJson(const std::vector<drivers::SensorStatus>& sensors) {
  Json json = Json::array();
  for (const auto& sensor : sensors) json.push_back(sensorJson(sensor));
  return json;
}

std::string lineOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// The newest frame as a program asks for it, and whether all is well.
std::pair<std::string, bool> healthOf(const LiveView* view, const Json& sensors) {
  if (view == nullptr) {
    return {lineOf({{"status", "waiting"}, {"age_s", nullptr}, {"sensors", sensors}}), false};
  }
  const auto& camera = view->update.camera;
  const double age_s = ageOf(view->arrival_s);
  const Json json = {{"status", slam::toString(camera.status)},
                     {"submap", camera.submap},
                     {"frame", view->update.frame},
                     {"age_s", age_s},
                     {"latency_s", view->latency_s},
                     {"dropped", view->dropped},
                     {"left_out", view->left_out},
                     {"sensors", sensors},
                     {"warnings", warningsJson(view->warnings)}};
  return {lineOf(json), slam::isTracked(camera.status) && age_s <= kMaxAge_s};
}

/// One event of the page: the view as JSON in one line, without pictures.
///
/// @param pictures      that are served; null: none yet
/// @param grid_version  of the picture of the occupancy grid
std::string jsonOf(const LiveView& view, const Json& sensors, const LivePictures* pictures,
                   const DrivenPath& path, std::size_t grid_version) {
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
               {"age_ms", 1e3 * ageOf(view.arrival_s)},
               {"left_out", view.left_out},
               {"tracks", Json::array()},
               {"path", Json::array()},
               {"sensors", sensors},
               {"warnings", warningsJson(view.warnings)}};
  if (pictures != nullptr) {
    json["pictures"] = {{"frame", pictures->frame.index},
                        {"age_ms", 1e3 * ageOf(pictures->arrival_s)},
                        {"has_image", pictures->frame.stereo.has_value()},
                        {"grid", gridJson(pictures->map, grid_version)}};
  }
  for (const auto& track : view.update.objects.tracks) {
    if (isShown(track)) json["tracks"].push_back(trackJson(track));
  }
  for (const auto& position : path.positions()) {
    json["path"].push_back(
        {std::round(position.x() * 100) / 100, std::round(position.y() * 100) / 100});
  }
  return lineOf(json);
}

/// The frame's left image as JPEG; empty without images.
std::string jpegOf(const LivePictures& pictures) {
  const auto& stereo = pictures.frame.stereo;
  if (!stereo) return {};
  return encoded(".jpg", stereo->left_colour.empty() ? stereo->left : stereo->left_colour,
                 {cv::IMWRITE_JPEG_QUALITY, 75});
}

/// The occupancy grid as PNG with transparent unknown cells, greatest y first, of at most as many
/// pixels a side as screens have; empty without one. Occupied cells prevail where cells share a
/// pixel.
std::string pngOf(const LivePictures& pictures) {
  const auto grid = pictures.map.staticGrid();
  if (!grid) return {};
  const auto cells_x = static_cast<int>(grid->getSizeX());
  const auto cells_y = static_cast<int>(grid->getSizeY());
  const int cells_a_pixel = 1 + (std::max(cells_x, cells_y) - 1) / 1600;
  const int columns = 1 + (cells_x - 1) / cells_a_pixel, rows = 1 + (cells_y - 1) / cells_a_pixel;
  const cv::Vec4b free_colour(0x43, 0x38, 0x2f, 255), occupied_colour(0xe4, 0xd9, 0xcf, 255);
  cv::Mat picture(rows, columns, CV_8UC4, cv::Scalar(0, 0, 0, 0));
  for (int y = 0; y < cells_y; ++y) {
    for (int x = 0; x < cells_x; ++x) {
      const float free = grid->getCell(x, y);
      auto& pixel = picture.at<cv::Vec4b>(rows - 1 - y * rows / cells_y, x * columns / cells_x);
      if (free > 0.65F && pixel != occupied_colour) pixel = free_colour;
      if (free < 0.35F) pixel = occupied_colour;
    }
  }
  return encoded(".png", picture, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

constexpr const char* kLocal = "127.0.0.1";

std::string randomToken() {
  std::random_device random;
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 4; ++i) std::snprintf(text.data() + 8 * i, 9, "%08x", random());
  return text.data();
}

Answer answerOf(std::string content, const char* type, int status = 200) {
  return {status, type, std::make_shared<const std::string>(std::move(content))};
}

/// A picture of the newest frame that has one, encoded when it is first asked for.
class EncodedPicture {
 public:
  using Encode = std::string (*)(const LivePictures&);

  EncodedPicture(const char* type, Encode encode) : type_(type), encode_(encode) {}

  Answer answer(std::shared_ptr<const LivePictures> pictures) {
    if (pictures != pictures_) {
      bytes_ = std::make_shared<const std::string>(encode_(*pictures));
      pictures_ = std::move(pictures);
    }
    if (!bytes_ || bytes_->empty()) return answerOf("no picture\n", "text/plain", 404);
    return {200, type_, bytes_};
  }

 private:
  const char* type_;
  Encode encode_;
  std::shared_ptr<const LivePictures> pictures_;  ///< that are encoded
  std::shared_ptr<const std::string> bytes_;
};

}  // namespace

class LivePage::Implementation {
 public:
  explicit Implementation(const LivePageOptions& options) {
    if (options.port) {
      addRoutes(page_.emplace(options.address, options.address == kLocal ? "" : randomToken()));
      page_->start(*options.port, "--show");
    }
    if (options.health_port) {
      health_.emplace(kLocal, "");
      health_->get("/health", [this] {
        const auto [text, is_well] = healthOf(views().first.get(), sensors());
        return answerOf(text + "\n", "application/json", is_well ? 200 : 503);
      });
      health_->start(*options.health_port, "--health");
    }
  }

  void end() {
    if (page_) page_->end();
    if (health_) health_->end();
  }

  std::string url() const { return page_ ? page_->url() : ""; }
  std::string healthUrl() const { return health_ ? health_->url() + "health" : ""; }

  void watch(SensorStates sensors) {
    const std::lock_guard lock(sensors_mutex_);
    sensors_ = std::move(sensors);
  }

  void show(LiveView view) {
    auto next = std::make_shared<const LiveView>(std::move(view));
    const std::lock_guard lock(mutex_);
    if (slam::isTracked(next->update.camera.status)) {
      path_.add(next->update.camera.T_map_robot);
    }
    view_.swap(next);
    ++views_;
  }

  void draw(LivePictures pictures) {
    auto next = std::make_shared<const LivePictures>(std::move(pictures));
    const std::lock_guard lock(mutex_);
    if (!pictures_ || next->map.staticGrid() != pictures_->map.staticGrid()) ++grid_version_;
    pictures_.swap(next);
  }

 private:
  void addRoutes(PageServer& server) {
    server.get("/", [&server] {
      Answer page = answerOf(kPageHtml, "text/html; charset=utf-8");
      page.cookie = server.cookie();
      return page;
    });
    server.get("/page.css", kPageCss, "text/css");
    server.get("/top_view.js", kTopViewScript, "text/javascript; charset=utf-8");
    server.get("/page.js", kPageScript, "text/javascript; charset=utf-8");
    server.get("/image.jpg", [this] { return image_.answer(views().second); });
    server.get("/grid.png", [this] { return grid_.answer(views().second); });
    server.stream("/events", [this] {
      return
          [this, sent = std::size_t{0}, sent_s = 0.0]() mutable { return nextEvent(sent, sent_s); };
    });
  }

  /// The next event after view number `sent`, at most ten a second, or after a second the sensors
  /// alone, by which a browser that has gone is noticed, too; empty if it is not time yet.
  std::string nextEvent(std::size_t& sent, double& sent_s) const {
    const double passed_s = monotonicSeconds() - sent_s;
    std::unique_lock lock(mutex_);
    const bool is_new = views_ != sent;
    if (passed_s < (is_new ? 0.1 : 1.0)) return {};
    sent_s += passed_s;
    if (!is_new) {
      lock.unlock();
      return "event: sensors\ndata: " + lineOf(sensors()) + "\n\n";
    }
    sent = views_;
    const auto view = view_;
    const auto pictures = pictures_;
    const DrivenPath path = path_;
    const std::size_t grid_version = grid_version_;
    lock.unlock();
    return "data: " + jsonOf(*view, sensors(), pictures.get(), path, grid_version) + "\n\n";
  }

  Json sensors() const {
    const std::lock_guard lock(sensors_mutex_);
    return sensorsJson(sensors_ ? sensors_() : std::vector<drivers::SensorStatus>());
  }

  /// What is shown and drawn; null: nothing yet.
  std::pair<std::shared_ptr<const LiveView>, std::shared_ptr<const LivePictures>> views() const {
    const std::lock_guard lock(mutex_);
    return {view_, pictures_};
  }

  mutable std::mutex sensors_mutex_;
  SensorStates sensors_;  // guarded by sensors_mutex_, also while it is called
  mutable std::mutex mutex_;
  std::shared_ptr<const LiveView> view_;  // guarded by mutex_, like the members below
  std::shared_ptr<const LivePictures> pictures_;
  DrivenPath path_;
  std::size_t grid_version_ = 0;
  std::size_t views_ = 0;
  EncodedPicture image_{"image/jpeg", jpegOf};  // used by the page's thread alone, like the next
  EncodedPicture grid_{"image/png", pngOf};
  std::optional<PageServer> page_, health_;  // last members, so that they end before the others
};

LivePage::LivePage(const LivePageOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

LivePage::~LivePage() { end(); }

void LivePage::end() { implementation_->end(); }

std::string LivePage::url() const { return implementation_->url(); }

std::string LivePage::healthUrl() const { return implementation_->healthUrl(); }

void LivePage::watch(SensorStates sensors) { implementation_->watch(std::move(sensors)); }

void LivePage::show(LiveView view) { implementation_->show(std::move(view)); }

void LivePage::draw(LivePictures pictures) { implementation_->draw(std::move(pictures)); }

}  // namespace headway::live
