// SPDX-License-Identifier: BSD-3-Clause
// The page of a live run: what it shows as JSON and pictures, and its server.
#include "live_page.h"

#include <headway/core/ellipse.h>
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/core/stage_times.h>
#include <httplib.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <random>
#include <string>
#include <thread>

#include "page_files.h"

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
std::pair<std::string, bool> healthOf(const LiveView* view) {
  if (view == nullptr) return {lineOf({{"status", "waiting"}, {"age_s", nullptr}}), false};
  const auto& camera = view->update.camera;
  const double age_s = ageOf(view->arrival_s);
  const Json json = {{"status", slam::toString(camera.status)},
                     {"submap", camera.submap},
                     {"frame", view->update.frame},
                     {"age_s", age_s},
                     {"latency_s", view->latency_s},
                     {"dropped", view->dropped},
                     {"left_out", view->left_out},
                     {"sensors", sensorsJson(view->sensors)},
                     {"warnings", warningsJson(view->warnings)}};
  return {lineOf(json), slam::isTracked(camera.status) && age_s <= kMaxAge_s};
}

/// One event of the page: the view as JSON in one line, without pictures.
///
/// @param pictures      that are served; null: none yet
/// @param grid_version  of the picture of the occupancy grid
std::string jsonOf(const LiveView& view, const LivePictures* pictures, const DrivenPath& path,
                   std::size_t grid_version) {
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
               {"sensors", sensorsJson(view.sensors)},
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
std::string jpegOf(const RecordedFrame& frame) {
  if (!frame.stereo) return {};
  const auto& colour = frame.stereo->left_colour;
  return encoded(".jpg", colour.empty() ? frame.stereo->left : colour,
                 {cv::IMWRITE_JPEG_QUALITY, 75});
}

/// The occupancy grid as PNG with transparent unknown cells, greatest y first; empty without one.
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
      if (free > 0.65F) pixel = {0x43, 0x38, 0x2f, 255};
      if (free < 0.35F) pixel = {0xe4, 0xd9, 0xcf, 255};
    }
  }
  return encoded(".png", picture, {cv::IMWRITE_PNG_COMPRESSION, 1});
}

using httplib::Request;
using httplib::Response;

constexpr int kMaxPages = 4;                  // open at a time; each holds a thread
constexpr int kPageThreads = 12 + kMaxPages;  // browsers keep several connections
constexpr int kHealthThreads = 2;  // a client that keeps one busy does not hide the health
constexpr const char* kCookie = "headway_token";
constexpr const char* kLocal = "127.0.0.1";

std::string randomToken() {
  std::random_device random;
  std::array<char, 33> text{};
  for (std::size_t i = 0; i < 4; ++i) std::snprintf(text.data() + 8 * i, 9, "%08x", random());
  return text.data();
}

/// Compares without revealing by its duration where the first difference is.
bool isEqual(const std::string& a, const std::string& b) {
  unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

std::string cookieOf(const Request& request) {
  const std::string all = "; " + request.get_header_value("Cookie");
  const std::string name = std::string("; ") + kCookie + "=";
  const auto begin = all.find(name);
  if (begin == std::string::npos) return {};
  return all.substr(begin + name.size(), all.find(';', begin + name.size()) - begin - name.size());
}

httplib::Headers securityHeaders() {
  return {{"Content-Security-Policy",
           "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; "
           "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cache-Control", "no-store"}};
}

/// Serves GET requests that name its address as their host and have its token, if there is one.
class Server {
 public:
  using Handler = std::function<void(Response&)>;

  /// @param token    empty: none is needed
  /// @param threads  one for each connection that is served at a time
  Server(std::string address, std::string token, int threads)
      : address_(std::move(address)), token_(std::move(token)) {
    server_.new_task_queue = [threads] { return new httplib::ThreadPool(threads); };
    // httplib's default, SO_REUSEPORT, would share the port with other programs.
    server_.set_socket_options([](socket_t socket) {
      const int on = 1;
      setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    server_.set_default_headers(securityHeaders());
    server_.set_pre_routing_handler(
        [this](const Request& request, Response& response) { return admit(request, response); });
  }
  ~Server() {
    server_.stop();
    if (thread_.joinable()) thread_.join();
  }
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  void get(const char* path, Handler handler) {
    server_.Get(path, [handler = std::move(handler)](const Request&, Response& response) {
      handler(response);
    });
  }
  void get(const char* path, const char* text, const char* type) {
    get(path, [=](Response& response) { response.set_content(text, type); });
  }

  /// @param port    0: any free one
  /// @param option  of the command line, for the error
  /// @throws InputError
  void start(int port, const std::string& option) {
    port_ = port == 0 ? server_.bind_to_any_port(address_) : port;
    const bool is_bound = port == 0 ? port_ > 0 : server_.bind_to_port(address_, port_);
    if (!is_bound) {
      throw InputError(option + ": " + address_ + ":" + std::to_string(port) +
                       " cannot be served; the port is taken, or no interface has this address");
    }
    thread_ = std::thread([this] { server_.listen_after_bind(); });
    while (!server_.is_running()) std::this_thread::yield();
  }

  [[nodiscard]] std::string url() const {
    return "http://" + address_ + ":" + std::to_string(port_) + "/";
  }

 private:
  using Result = httplib::Server::HandlerResponse;

  Result admit(const Request& request, Response& response) const {
    const auto host = request.get_header_value("Host");
    const std::string port = ":" + std::to_string(port_);
    const bool is_known =
        host == address_ + port || (address_ == kLocal && host == "localhost" + port);
    const auto given =
        request.has_param("token") ? request.get_param_value("token") : cookieOf(request);
    if (is_known && (token_.empty() || isEqual(given, token_))) return Result::Unhandled;
    response.status = 403;
    response.set_content("forbidden: open the address that headway-live prints\n", "text/plain");
    return Result::Handled;
  }

  const std::string address_;
  const std::string token_;
  int port_ = 0;
  httplib::Server server_;
  std::thread thread_;
};

}  // namespace

class LivePage::Implementation {
 public:
  explicit Implementation(const LivePageOptions& options)
      : token_(options.address == kLocal ? "" : randomToken()) {
    if (options.port) {
      addRoutes(page_.emplace(options.address, token_, kPageThreads));
      page_->start(*options.port, "--show");
    }
    if (options.health_port) {
      health_.emplace(kLocal, "", kHealthThreads);
      health_->get("/health", [this](Response& response) {
        const auto [text, is_well] = healthOf(views().first.get());
        response.status = is_well ? 200 : 503;
        response.set_content(text + "\n", "application/json");
      });
      health_->start(*options.health_port, "--health");
    }
  }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex_);
      is_ending_ = true;
    }
    changed_.notify_all();
  }

  std::string url() const {
    return page_ ? page_->url() + (token_.empty() ? "" : "?token=" + token_) : "";
  }
  std::string healthUrl() const { return health_ ? health_->url() + "health" : ""; }

  void show(LiveView view) {
    auto next = std::make_shared<const LiveView>(std::move(view));
    {
      const std::lock_guard lock(mutex_);
      if (slam::isTracked(next->update.camera.status)) {
        path_.add(next->update.camera.T_map_robot);
      }
      view_.swap(next);
      ++views_;
    }
    changed_.notify_all();
  }

  void draw(LivePictures pictures) {
    auto next = std::make_shared<const LivePictures>(std::move(pictures));
    const std::lock_guard lock(mutex_);
    if (!pictures_ || next->map.staticGrid() != pictures_->map.staticGrid()) ++grid_version_;
    pictures_.swap(next);
  }

 private:
  void addRoutes(Server& server) {
    server.get("/", [this](Response& response) {
      if (!token_.empty()) {
        response.set_header("Set-Cookie", std::string(kCookie) + "=" + token_ +
                                              "; HttpOnly; SameSite=Strict; Path=/");
      }
      response.set_content(kPageHtml, "text/html; charset=utf-8");
    });
    server.get("/page.css", kPageCss, "text/css");
    server.get("/top_view.js", kTopViewScript, "text/javascript; charset=utf-8");
    server.get("/page.js", kPageScript, "text/javascript; charset=utf-8");
    server.get("/image.jpg", [this](Response& response) {
      const auto pictures = views().second;
      sendPicture(pictures ? jpegOf(pictures->frame) : "", "image/jpeg", response);
    });
    server.get("/grid.png", [this](Response& response) {
      const auto pictures = views().second;
      sendPicture(pictures ? pngOf(pictures->map) : "", "image/png", response);
    });
    server.get("/events", [this](Response& response) { sendEvents(response); });
  }

  static void sendPicture(const std::string& bytes, const char* type, Response& response) {
    if (bytes.empty()) {
      response.status = 404;
      return;
    }
    response.set_content(bytes, type);
  }

  void sendEvents(Response& response) {
    if (pages_.fetch_add(1) >= kMaxPages) {
      --pages_;
      response.status = 503;
      return;
    }
    auto sent = std::make_shared<std::size_t>(0);
    response.set_chunked_content_provider(
        "text/event-stream",
        [this, sent](std::size_t, httplib::DataSink& sink) {
          const std::string text = nextEvent(*sent);
          return !text.empty() && sink.write(text.data(), text.size());
        },
        [this](bool) { --pages_; });
  }

  /// The next event after view number `sent`, at most ten a second, or after a second a comment, so
  /// that a browser that has gone is noticed; empty at the end.
  std::string nextEvent(std::size_t& sent) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, std::chrono::milliseconds(100), [this] { return is_ending_; });
    changed_.wait_for(lock, std::chrono::seconds(1), [&] { return is_ending_ || views_ > sent; });
    if (is_ending_) return {};
    if (views_ == sent) return ":\n\n";
    sent = views_;
    const auto view = view_;
    const auto pictures = pictures_;
    const DrivenPath path = path_;
    const std::size_t grid_version = grid_version_;
    lock.unlock();
    return "data: " + jsonOf(*view, pictures.get(), path, grid_version) + "\n\n";
  }

  /// What is shown and drawn; null: nothing yet.
  std::pair<std::shared_ptr<const LiveView>, std::shared_ptr<const LivePictures>> views() const {
    const std::lock_guard lock(mutex_);
    return {view_, pictures_};
  }

  const std::string token_;  ///< empty: not needed
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<const LiveView> view_;  // guarded by mutex_, like the members below
  std::shared_ptr<const LivePictures> pictures_;
  DrivenPath path_;
  std::size_t grid_version_ = 0;
  std::size_t views_ = 0;
  bool is_ending_ = false;
  std::atomic<int> pages_{0};            ///< open event streams
  std::optional<Server> page_, health_;  // last members, so that they end before the others
};

LivePage::LivePage(const LivePageOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

LivePage::~LivePage() = default;

std::string LivePage::url() const { return implementation_->url(); }

std::string LivePage::healthUrl() const { return implementation_->healthUrl(); }

void LivePage::show(LiveView view) { implementation_->show(std::move(view)); }

void LivePage::draw(LivePictures pictures) { implementation_->draw(std::move(pictures)); }

}  // namespace headway::live
