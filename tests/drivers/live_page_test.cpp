// SPDX-License-Identifier: BSD-3-Clause
// The page of headway-live: its requests, and what a browser makes of it.
#include "live_page.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/stage_times.h>
#include <headway_test/folders.h>
#include <headway_test/http_client.h>
#include <headway_test/peak_memory.h>
#include <headway_test/process.h>
#include <headway_test/waiting.h>
#include <headway_test/walking_track.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

namespace headway::live {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

LivePictures examplePictures(std::size_t frame) {
  LivePictures pictures;
  pictures.arrival_s = monotonicSeconds();
  pictures.frame.index = frame;
  pictures.frame.stereo.emplace();
  pictures.frame.stereo->left = cv::Mat(60, 80, CV_8U, cv::Scalar(90));
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-2.0F, 2.0F, -1.0F, 1.0F, 0.1F);
  grid->setPos(0.05F, 0.05F, 0.1F);
  pictures.map.update(grid);
  return pictures;
}

/// A frame with a walking person, a failed sensor and a warning with a tag.
LiveView exampleView(std::size_t frame) {
  LiveView view;
  view.arrival_s = monotonicSeconds();
  view.update.frame = frame;
  view.update.time = 10.0 + 0.1 * static_cast<double>(frame);
  view.update.camera.status = slam::TrackingStatus::kTracked;
  view.update.camera.T_map_robot.translation().x() = static_cast<double>(frame);
  auto track = test::walkingTrack(7, {4.0, 1.0}, {0.0, 1.2});
  track.box2d = Box2d{10, 20, 30, 50};
  view.update.objects.tracks = {track};
  view.latency_s = 0.045;
  view.frames = frame + 1;
  addWarning("x", frame, "<script>alert(1)</script>", view.warnings);
  return view;
}

/// A laser that failed.
std::vector<drivers::SensorStatus> failedLaser() {
  drivers::SensorStatus sensor;
  sensor.name = "LASER";
  sensor.error = "the plug was pulled";
  return {sensor};
}

class LivePageTest : public ::testing::Test {
 protected:
  static int portOf(const LivePage& page) {
    const std::string url = page.url();
    return std::stoi(url.substr(url.rfind(':') + 1));
  }

  /// Gets what a page on 127.0.0.1 serves.
  static test::HttpResponse get(const LivePage& page, const std::string& path) {
    return test::httpGet("127.0.0.1", portOf(page), path);
  }

  /// The first event of the stream.
  static nlohmann::json firstEvent(const LivePage& page) {
    test::Connection connection("127.0.0.1", portOf(page));
    connection.send(test::httpRequest("/events", "127.0.0.1:" + std::to_string(portOf(page))));
    std::string text;
    (void)test::waitUntil([&] {
      text += connection.receive(0).value_or("");
      const auto data = text.find("data:");
      return data != std::string::npos && text.find("\n\n", data) != std::string::npos;
    });
    return nlohmann::json::parse(text.substr(text.find('{')));
  }
};

TEST_F(LivePageTest, ServesThePageWithAStrictPolicyAndNothingFromElsewhere) {
  LivePage page({});
  EXPECT_THAT(page.url(), StartsWith("http://127.0.0.1:"));
  for (const char* path : {"/", "/page.js", "/top_view.js", "/page.css"}) {
    const auto response = get(page, path);
    EXPECT_EQ(200, response.status) << path;
    EXPECT_THAT(response.field("Content-Security-Policy"),
                HasSubstr("default-src 'none'; script-src 'self'; style-src 'self'"));
    EXPECT_EQ("nosniff", response.field("X-Content-Type-Options"));
    EXPECT_EQ(std::to_string(response.body.size()), response.field("Content-Length"));
    EXPECT_THAT(response.body, Not(HasSubstr("http://")));
    EXPECT_THAT(response.body, Not(HasSubstr("https://")));
    EXPECT_THAT(response.body, Not(HasSubstr("innerHTML")));
  }
  EXPECT_EQ(404, get(page, "/image.jpg").status) << "there is no frame yet";
  EXPECT_EQ(404, get(page, "/../../etc/passwd").status);
}

TEST_F(LivePageTest, EventsAndPicturesShowTheNewestView) {
  LivePage page({});
  page.watch(failedLaser);
  page.show(exampleView(3));
  page.draw(examplePictures(4));
  page.show(exampleView(4));
  const auto json = firstEvent(page);
  EXPECT_EQ(4, json.at("frame"));
  EXPECT_EQ("tracked", json.at("status"));
  EXPECT_EQ(45.0, json.at("latency_ms"));
  EXPECT_EQ(2u, json.at("path").size());
  EXPECT_EQ(7, json.at("tracks")[0].at("id"));
  EXPECT_EQ(20.0, json.at("tracks")[0].at("box")[1]);
  EXPECT_FALSE(json.at("tracks")[0].at("paths")[0].at("points").empty());
  EXPECT_EQ("the plug was pulled", json.at("sensors")[0].at("error"));
  const std::string image = get(page, "/image.jpg").body;
  const std::vector<char> jpeg(image.begin(), image.end());
  EXPECT_EQ(cv::Size(80, 60), cv::imdecode(jpeg, cv::IMREAD_GRAYSCALE).size());
  const std::string grid = get(page, "/grid.png").body;
  const std::vector<char> png(grid.begin(), grid.end());
  const cv::Mat cells = cv::imdecode(png, cv::IMREAD_UNCHANGED);
  EXPECT_EQ(4, cells.channels());
  EXPECT_EQ(1, cv::countNonZero(cv::Mat(cells.reshape(1, cells.rows * cells.cols).col(3))));
}

TEST_F(LivePageTest, SensorsAreShownWithoutFrames) {
  LivePage page({});
  page.watch(failedLaser);
  test::Connection connection("127.0.0.1", portOf(page));
  connection.send(test::httpRequest("/events", "127.0.0.1:" + std::to_string(portOf(page))));
  std::string text;
  EXPECT_TRUE(test::waitUntil([&] {
    text += connection.receive(0).value_or("");
    return text.find("event: sensors\ndata: [{") != std::string::npos &&
           text.find("the plug was pulled") != std::string::npos;
  })) << text;
}

TEST_F(LivePageTest, ALargeGridIsShownSmallerWithAllThatIsOccupied) {
  LivePage page({});
  LivePictures pictures = examplePictures(4);
  auto grid = mrpt::maps::COccupancyGridMap2D::Create(-225.0F, 225.0F, -150.0F, 150.0F, 0.1F);
  for (int i = 0; i < 3; ++i) grid->setCell(3000 + i, 0, i == 1 ? 0.1F : 0.9F);
  pictures.map.update(grid);
  const test::PeakMemory memory;
  page.draw(pictures);
  const std::string png = get(page, "/grid.png").body;
  EXPECT_LE(memory.growthMb(), 20.0);
  const cv::Mat cells =
      cv::imdecode(std::vector<char>(png.begin(), png.end()), cv::IMREAD_UNCHANGED);
  ASSERT_EQ(cv::Size(1500, 1000), cells.size());
  EXPECT_EQ(cv::Vec4b(0xe4, 0xd9, 0xcf, 255), cells.at<cv::Vec4b>(999, 1000));
  EXPECT_EQ(1, cv::countNonZero(cv::Mat(cells.reshape(1, 1500 * 1000).col(3))));
}

TEST_F(LivePageTest, FiguresGoOnWhilePicturesAreLeftOut) {
  LivePage page({});
  page.draw(examplePictures(4));
  LiveView view = exampleView(9);
  view.left_out = "without pictures";
  view.arrival_s -= 0.5;
  page.show(view);
  const auto json = firstEvent(page);
  EXPECT_EQ(9, json.at("frame"));
  EXPECT_GE(json.at("age_ms"), 500.0);
  EXPECT_EQ("without pictures", json.at("left_out"));
  EXPECT_EQ(4, json.at("pictures").at("frame"));
  EXPECT_LT(json.at("pictures").at("age_ms"), json.at("age_ms"));
  EXPECT_EQ(200, get(page, "/image.jpg").status) << "the last one";
}

TEST_F(LivePageTest, HealthIsGoodWhileTrackedAndNoOlderThanASecond) {
  LivePage page({std::nullopt, "127.0.0.1", 0});
  EXPECT_EQ("", page.url());
  const std::string url = page.healthUrl();
  EXPECT_THAT(url, StartsWith("http://127.0.0.1:"));
  const int port = std::stoi(url.substr(url.rfind(':') + 1));
  const auto health = [&](int status) {
    const auto response = test::httpGet("127.0.0.1", port, "/health");
    EXPECT_EQ(status, response.status) << response.body;
    return nlohmann::json::parse(response.body);
  };
  EXPECT_EQ("waiting", health(503).at("status"));
  page.watch(failedLaser);
  EXPECT_EQ("the plug was pulled", health(503).at("sensors")[0].at("error")) << "before any frame";
  LiveView view = exampleView(3);
  view.update.camera.submap = 2;
  view.update.camera.status = slam::TrackingStatus::kTrackedInNewSubmap;
  page.show(view);
  const auto json = health(200);
  EXPECT_EQ("tracked_in_new_submap", json.at("status"));
  EXPECT_EQ(2, json.at("submap"));
  EXPECT_LT(json.at("age_s"), 1.0);
  EXPECT_EQ(0.045, json.at("latency_s"));
  EXPECT_EQ("the plug was pulled", json.at("sensors")[0].at("error"));
  page.watch({});
  EXPECT_TRUE(health(200).at("sensors").empty()) << "as it is now";
  EXPECT_EQ(1u, json.at("warnings").size());
  for (const auto status : {slam::TrackingStatus::kUnreliable, slam::TrackingStatus::kLost}) {
    view.update.camera.status = status;
    page.show(view);
    EXPECT_EQ(slam::toString(status), health(503).at("status"));
  }
  view.update.camera.status = slam::TrackingStatus::kTracked;
  view.arrival_s = monotonicSeconds() - 0.8;
  page.show(view);
  (void)health(200);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_GT(health(503).at("age_s"), 1.0) << "nothing has come since";
  EXPECT_EQ(404, test::httpGet("127.0.0.1", port, "/").status);
  const std::string other = "evil.example:" + std::to_string(port);
  EXPECT_EQ(403, test::httpGet("127.0.0.1", port, "/health", "", other).status);
}

TEST_F(LivePageTest, OtherHostNamesAreRejected) {
  LivePage page({});
  const std::string port = ":" + std::to_string(portOf(page));
  for (const auto& [host, status] : {std::pair("evil.example", 403), std::pair("localhost", 200)}) {
    EXPECT_EQ(status, test::httpGet("127.0.0.1", portOf(page), "/", "", host + port).status);
  }
}

TEST_F(LivePageTest, AnotherAddressNeedsTheToken) {
  LivePage page({0, "127.0.0.2"});
  const auto token_at = page.url().find("?token=");
  ASSERT_NE(std::string::npos, token_at) << page.url();
  const std::string query = page.url().substr(token_at);
  const auto get = [&](const std::string& path, const std::string& fields = "") {
    return test::httpGet("127.0.0.2", portOf(page), path, fields);
  };
  for (const char* path :
       {"/", "/page.js", "/events", "/image.jpg", "/?token=0", "/?", "/nothing"}) {
    EXPECT_EQ(403, get(path).status) << path;
  }
  const auto opened = get("/" + query);
  ASSERT_EQ(200, opened.status);
  const std::string cookie = opened.field("Set-Cookie");
  EXPECT_THAT(cookie, HasSubstr("HttpOnly; SameSite=Strict"));
  const std::string value = cookie.substr(0, cookie.find(';'));
  EXPECT_EQ(200, get("/page.js", "Cookie: other=1; " + value + "\r\n").status);
  EXPECT_EQ(403, get("/page.js", "Cookie: x" + value + "\r\n").status);
  EXPECT_EQ(query.size(), std::string("?token=").size() + 32);
  LivePage other({0, "127.0.0.2"});
  EXPECT_EQ(std::string::npos, other.url().find(query)) << "tokens differ";
}

TEST_F(LivePageTest, ATakenPortAndAnUnknownAddressAreErrors) {
  LivePage page({});
  EXPECT_THROW(LivePage({portOf(page)}), InputError);
  EXPECT_THROW(LivePage({0, "203.0.113.7"}), InputError);
  EXPECT_THROW(LivePage({std::nullopt, "127.0.0.1", portOf(page)}), InputError);
}

/// Chromium without a window, ended by the destructor.
class Browser {
 public:
  explicit Browser(const std::string& url) {
    const std::string pid = folder_ / "pid";
    (void)test::runProcess("chromium --headless=new --no-sandbox --disable-gpu --user-data-dir=" +
                           (folder_ / "profile").string() + " --remote-debugging-port=0 '" + url +
                           "' >" + (folder_ / "output").string() + " 2>&1 & echo $! >" + pid);
    process_ = std::stoi(test::contentsOf(pid));
  }
  ~Browser() { (void)test::runProcess("kill " + std::to_string(process_) + "; sleep 0.5"); }

  /// Waits until the page's title, which the script sets after drawing, has this text.
  ///
  /// @param show  called before each look
  [[nodiscard]] std::string waitForTitle(
      const std::string& text, const std::function<void()>& show = [] {}) const {
    std::string titles;
    (void)test::waitUntil([&] {
      show();
      const std::string port = test::contentsOf(folder_ / "profile/DevToolsActivePort");
      if (port.find('\n') == std::string::npos) return false;
      titles = test::httpGet("127.0.0.1", std::stoi(port), "/json/list").body;
      return titles.find(text) != std::string::npos;
    });
    return titles;
  }
  [[nodiscard]] std::string output() const { return test::contentsOf(folder_ / "output"); }

 private:
  test::TemporaryFolder folder_;
  int process_ = 0;
};

TEST_F(LivePageTest, ChromiumDrawsTheNewestFrame) {
  LivePage page({});
  page.draw(examplePictures(3));
  const Browser browser(page.url());
  for (const std::size_t frame : {3, 4}) {  // the picture of the second one is left out
    const std::string title = "tracked, frame " + std::to_string(frame);
    EXPECT_THAT(browser.waitForTitle(title, [&] { page.show(exampleView(frame)); }),
                HasSubstr(title));
  }
  EXPECT_THAT(browser.waitForTitle("no frame for"), HasSubstr("tracked before, frame 4"));
  EXPECT_THAT(browser.output(), Not(HasSubstr("Content Security Policy")));
}

}  // namespace
}  // namespace headway::live
