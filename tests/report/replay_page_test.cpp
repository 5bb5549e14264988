// SPDX-License-Identifier: BSD-3-Clause
// The page of a replay, as bytes and in a browser.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/replay_page.h>
#include <headway_test/browser.h>
#include <headway_test/peak_memory.h>

#include <algorithm>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <random>

#include "html.h"

namespace headway::report {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr int kFrames = 30;

Time timeOf(int frame) { return 1000.0 + 0.1 * frame; }

/// A car that overtakes the robot on the left, and one that is parked on the right.
std::vector<Track> tracksAt(int frame) {
  Track car;
  car.id = TrackId{7};
  car.object_class = ObjectClass::kCar;
  car.status = TrackStatus::kConfirmed;
  car.motion_state = MotionState::kMoving;
  car.position << 8.0 + 1.0 * frame, 3.5, 0.75;
  car.velocity << 10.0, 0.0, 0.0;
  car.size << 4.2, 1.8, 1.5;
  Track parked = car;
  parked.id = TrackId{9};
  parked.object_class = frame == 3 ? ObjectClass::kCar : ObjectClass::kVan;
  parked.motion_state = MotionState::kStatic;
  parked.position << 25.0, -4.0, 0.9;
  parked.velocity.setZero();
  return {car, parked};
}

class ReplayPageTest : public ::testing::Test {
 protected:
  ReplayPageTest() {
    std::vector<Stamped<Pose>> path;
    std::ofstream tracks(folder_ / "tracks.csv"), predictions(folder_ / "predictions.csv");
    tracks << io::trackCsvHeader() << '\n';
    predictions << io::predictionCsvHeader() << '\n';
    for (int i = 0; i < kFrames; ++i) {
      const auto frame = static_cast<std::size_t>(i);
      path.push_back({timeOf(i), Pose(Eigen::Translation3d(0.5 * i, 0.0, 0.0))});
      for (const auto& track : tracksAt(i)) {
        io::writeTrackCsv(tracks, {frame, timeOf(i), track});
        for (int k = 1; k <= 30; ++k) {
          io::PredictionRow row{frame, timeOf(i), track.id, track.object_class, 0, 1.0, {}};
          row.point.horizon_s = 0.1 * k;
          // The predicted speed is 0.5 m/s too high.
          row.point.position = track.position + row.point.horizon_s * track.velocity +
                               row.point.horizon_s * Eigen::Vector3d(0.5, 0.0, 0.0);
          row.point.covariance = 0.02 * k * Eigen::Matrix2d::Identity();
          io::writePredictionCsv(predictions, row);
        }
      }
      options_.images[frame] = {};
      cv::imencode(".jpg", cv::Mat(60, 160, CV_8UC3, cv::Scalar(40, 120, 60 + 4 * i)),
                   options_.images[frame]);
    }
    io::writeTum(folder_ / "trajectory.tum", path);
    writeCloud("map_dense.ply", groundAndWall());
    writeCamera();
    options_.title = "<img src=x onerror=alert(1)> & co";
    options_.keyframes = {path[0], path[10], path[20]};
  }

  /// Ground and a wall on the right.
  [[nodiscard]] static std::vector<std::array<float, 3>> groundAndWall() {
    std::vector<std::array<float, 3>> points;
    for (int i = 0; i < 200; ++i) {
      const float x = 0.25F * static_cast<float>(i);
      for (int k = -20; k < 20; ++k) points.push_back({x, 0.4F * static_cast<float>(k), 0.0F});
      for (int k = 0; k < 20; ++k) points.push_back({x, -8.0F, 0.2F * static_cast<float>(k)});
    }
    return points;
  }

  void writeCloud(const char* name, const std::vector<std::array<float, 3>>& points) const {
    std::ofstream file(folder_ / name, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
            "property uchar green\nproperty uchar blue\nend_header\n";
    for (const auto& point : points) {
      file.write(reinterpret_cast<const char*>(point.data()), sizeof point);
      file.write(point[1] < -7.9f ? "\xa0\x60\x40" : "\x60\x64\x68", 3);
    }
  }

  void writeCamera() const {
    StereoCamera camera;
    camera.width = 160;
    camera.height = 60;
    camera.fx = camera.fy = 90.0;
    camera.cx = 79.5;
    camera.cy = 29.5;
    camera.baseline_m = 0.4;
    camera.T_robot_cam.translation().z() = 1.6;
    io::writeCalibration(folder_ / "calibration.yaml", camera);
  }

  std::string write() {
    return writeReplayPage(folder_.path(), options_, [](const std::string&) {});
  }
  std::string page() { return test::contentsOf(write()); }

  test::TemporaryFolder folder_;
  ReplayPageOptions options_;
};

TEST_F(ReplayPageTest, HasAStrictPolicyAndNoTextThatIsParsed) {
  const std::string html = page();
  EXPECT_THAT(html, HasSubstr("default-src 'none'; img-src data:; style-src 'sha256-"));
  EXPECT_THAT(html, HasSubstr("script-src 'sha256-"));
  EXPECT_THAT(html, Not(HasSubstr("unsafe")));
  EXPECT_THAT(html, Not(HasSubstr("<img src=x")));
  EXPECT_THAT(html, HasSubstr("three.js r111, MIT licence"));
  EXPECT_EQ(html, page()) << "the same folder gives the same bytes";
}

TEST_F(ReplayPageTest, ShowsWhatThereIsAndRefusesAFolderWithoutATrajectory) {
  std::filesystem::remove(folder_ / "map_dense.ply");
  std::filesystem::remove(folder_ / "predictions.csv");
  std::filesystem::remove(folder_ / "calibration.yaml");
  EXPECT_THAT(page(), HasSubstr("\"dense\":null"));
  std::filesystem::remove(folder_ / "trajectory.tum");
  EXPECT_THROW((void)page(), InputError);
}

TEST_F(ReplayPageTest, OfVeryManyBoxesTheNearestAreShownAndTheRestIsSaid) {
  constexpr std::size_t kManyFrames = 60, kMany = 1000;
  std::vector<Stamped<Pose>> path;
  {
    std::ofstream tracks(folder_ / "tracks.csv"), predictions(folder_ / "predictions.csv");
    tracks << io::trackCsvHeader() << '\n';
    predictions << io::predictionCsvHeader() << '\n';
    for (std::size_t frame = 0; frame < kManyFrames; ++frame) {
      const Time time = timeOf(static_cast<int>(frame));
      path.push_back({time, Pose::Identity()});
      for (std::size_t i = 0; i < kMany; ++i) {
        Track track = tracksAt(0)[0];
        track.id = TrackId{static_cast<std::int64_t>(i)};
        track.position.x() = 1000.0 - static_cast<double>(i);  // the last is the nearest
        io::writeTrackCsv(tracks, {frame, time, track});
        for (int k = 1; k <= 6; ++k) {
          io::PredictionRow row{frame, time, track.id, track.object_class, 0, 1.0, {}};
          row.point.horizon_s = 0.5 * k;
          row.point.position = track.position;
          row.point.covariance = Eigen::Matrix2d::Identity();
          io::writePredictionCsv(predictions, row);
        }
      }
    }
  }
  io::writeTum(folder_ / "trajectory.tum", path);
  std::vector<std::string> notes;
  const test::PeakMemory memory;
  const auto page =
      writeReplayPage(folder_.path(), options_, [&](const auto& n) { notes.push_back(n); });
  EXPECT_LT(memory.growthMb(), 100) << "of more than 700 with all boxes";
  EXPECT_LT(std::filesystem::file_size(page), 15'000'000U);
  ASSERT_EQ(2U, notes.size());
  EXPECT_THAT(notes[0], HasSubstr("40020 of 60000 boxes are left out: at most the nearest 333"));
  EXPECT_THAT(notes[1], HasSubstr("predictions of 6660 boxes are left out"));
}

TEST_F(ReplayPageTest, OfEverythingAtOnceHasAtMostFifteenMegabytes) {
  std::mt19937 random(7);
  std::vector<std::array<float, 3>> points(700000);
  std::uniform_real_distribution<float> metres(-100.0F, 100.0F);
  for (auto& point : points) point = {metres(random), metres(random), metres(random)};
  for (const char* name : {"map_dense.ply", "map_points.ply"}) writeCloud(name, points);
  cv::Mat noise(1100, 2300, CV_8U);
  cv::randu(noise, 0, 256);
  cv::imwrite((folder_ / "map_grid.png").string(), noise);
  std::ofstream(folder_ / "map_grid.yaml")
      << "image: map_grid.png\nresolution: 0.1\norigin: [0, 0, 0]\nnegate: 0\n"
         "occupied_thresh: 0.65\nfree_thresh: 0.2\n";
  PageImages images;
  cv::Mat image(480, 640, CV_8UC3);
  for (std::size_t i = 0; i < 300; ++i) {
    cv::randu(image, 0, 256);
    images.add(i, image);
  }
  options_.images = images.jpegs();
  options_.keyframes.assign(20000, {timeOf(0), Pose::Identity()});
  std::vector<Stamped<Pose>> path;
  {
    std::ofstream tracks(folder_ / "tracks.csv"), predictions(folder_ / "predictions.csv");
    tracks << io::trackCsvHeader() << '\n';
    predictions << io::predictionCsvHeader() << '\n';
    for (std::size_t frame = 0; frame < 2500; ++frame) {
      const Time time = timeOf(static_cast<int>(frame));
      path.push_back({time, Pose(Eigen::Translation3d(metres(random), metres(random), 0.0))});
      for (std::int64_t i = 0; i < 10; ++i) {
        Track track = tracksAt(0)[0];
        track.id = TrackId{i};
        track.position << metres(random), metres(random), 0.5;
        io::writeTrackCsv(tracks, {frame, time, track});
        for (int k = 1; k <= 6; ++k) {
          io::PredictionRow row{frame, time, track.id, track.object_class, 0, 1.0, {}};
          row.point.horizon_s = 0.5 * k;
          row.point.position << metres(random), metres(random), 0.5;
          row.point.covariance = Eigen::Matrix2d::Identity();
          io::writePredictionCsv(predictions, row);
        }
      }
    }
  }
  io::writeTum(folder_ / "trajectory.tum", path);
  std::filesystem::create_directories(folder_ / "truth");
  io::writeTum(folder_ / "truth/trajectory.tum", path);
  options_.truth = folder_ / "truth";
  const std::string html = page();
  const auto bytes = html.size();
  EXPECT_LT(bytes, 15'000'000U);
  const auto some = [](std::size_t all, const std::string& what, std::size_t shown) {
    return HasSubstr("\"of " + grouped(all) + " " + what + " " + grouped(shown) + " are shown\"");
  };
  EXPECT_THAT(html, some(700000, "points of the dense map", 350000));
  EXPECT_THAT(html, some(700000, "landmarks", 58334));
  EXPECT_THAT(html, some(2500, "frames", 1250));
  EXPECT_THAT(html, some(20000, "keyframes", 3334));
  EXPECT_THAT(html, some(2500, "camera images", images.jpegs().size()));
  EXPECT_GT(bytes, 8'000'000U) << "not for want of contents";
}

TEST_F(ReplayPageTest, SaysThatARunDidNotEnd) {
  EXPECT_THAT(page(), Not(HasSubstr("(ended early)")));
  std::ofstream(folder_ / "summary.json") << R"({"ended_early": null})";
  EXPECT_THAT(page(), Not(HasSubstr("(ended early)")));
  std::ofstream(folder_ / "summary.json")
      << R"({"ended_early": "killed after the checkpoint at frame 7"})";
  EXPECT_THAT(page(), HasSubstr("(ended early)"));
}

/// The page in Chromium.
class ReplayPageInBrowserTest : public ReplayPageTest {
 protected:
  void SetUp() override {
    if (!test::hasBrowser()) GTEST_SKIP() << "chromium is not installed";
  }

  void open(const std::string& link, int width = 640, int height = 400,
            const std::string& more_options = "") {
    browser_.emplace(width, height, more_options);
    browser_->open("file://" + write() + link);
    ASSERT_TRUE(browser_->waitFor("document.documentElement.dataset.drawn"));
  }
  std::string text(const std::string& id) {
    const auto value = browser_->evaluate("document.getElementById('" + id + "').textContent");
    return value.is_string() ? value.get<std::string>() : "";
  }
  /// Waits until the view is at rest, with all of its points.
  cv::Mat screenshot() {
    EXPECT_TRUE(browser_->waitFor("replayPage.full"));
    const std::string base64 = browser_->screenshot();
    std::vector<unsigned char> png;
    unsigned bits = 0, count = 0;
    constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    for (const char digit : base64) {
      if (digit == '=') break;
      bits = bits << 6 | static_cast<unsigned>(kDigits.find(digit));
      count += 6;
      if (count < 8) continue;
      count -= 8;
      png.push_back(static_cast<unsigned char>(bits >> count & 255));
    }
    return cv::imdecode(png, cv::IMREAD_COLOR);
  }
  void clickTrack(int id) {
    const auto pixel = browser_->evaluate(
        "(() => { const state = replayPage.moment.tracks.find((t) => t.id === " +
        std::to_string(id) +
        "); const p = new THREE.Vector3(state.x, state.y, "
        "state.z).project(replayPage.views.camera);"
        "return [(p.x + 1) / 2 * innerWidth, (1 - p.y) / 2 * innerHeight]; })()");
    browser_->click(pixel.at(0), pixel.at(1));
  }

  std::optional<test::PageBrowser> browser_;
};

cv::Mat smallVersion(const cv::Mat& picture) {
  cv::Mat small;
  cv::resize(picture, small, {128, 80}, 0, 0, cv::INTER_AREA);
  return small;
}

/// Ratio of the pixels of small pictures whose colour differs clearly.
double difference(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat distance;
  cv::absdiff(a, b, distance);
  cv::transform(distance, distance, cv::Matx13f(1, 1, 1));
  return cv::countNonZero(distance > 60) / static_cast<double>(a.total());
}

TEST_F(ReplayPageInBrowserTest, LinksScrubbingStepsAndClicksShowTheMoment) {
  options_.images.erase(5);
  open("#t=1.23&track=7");
  EXPECT_THAT(text("title"), HasSubstr("onerror=alert(1)"));
  EXPECT_EQ("of 30 camera images 29 are shown", text("left-out"));
  EXPECT_EQ("0:01.2", text("time"));
  EXPECT_THAT(text("moment"), HasSubstr("frame 12"));
  EXPECT_THAT(text("track"), HasSubstr("Car 7"));
  EXPECT_THAT(text("track"), HasSubstr("10.0 m/s · moving"));
  EXPECT_THAT(text("errors"), HasSubstr("0.50 m1.00 m–")) << "after 1, 2, 3 s";
  browser_->evaluate("scrub.value = 2.0; scrub.dispatchEvent(new Event('input'))");
  ASSERT_TRUE(browser_->waitFor("moment.textContent.startsWith('frame 20')"));
  browser_->press("ArrowRight");
  EXPECT_TRUE(browser_->waitFor("moment.textContent.startsWith('frame 21')"));
  EXPECT_EQ("#t=2.10&track=7", browser_->evaluate("location.hash"));
  browser_->press("Home");
  EXPECT_EQ("#t=0.00&track=7", browser_->evaluate("location.hash"));
  browser_->press("Escape");
  EXPECT_TRUE(browser_->waitFor("document.getElementById('track').hidden"));
  for (const char* view : {"follow", "top"}) {
    browser_->evaluate("document.querySelector('[data-view=" + std::string(view) + "]').click()");
    ASSERT_TRUE(browser_->waitFor("document.documentElement.dataset.drawn.endsWith('" +
                                  std::string(view) + "')"));
    clickTrack(9);
    EXPECT_TRUE(browser_->waitFor("track.textContent.includes('Van 9')")) << view;
    EXPECT_THAT(text("votes"), HasSubstr("Van29Car1")) << view;
    browser_->press("Escape");
  }
  browser_->press(" ");
  EXPECT_TRUE(browser_->waitFor("replayPage.time === replayPage.replay.duration"));
  EXPECT_THAT(browser_->messages(), IsEmpty());
}

TEST_F(ReplayPageInBrowserTest, BeginsWithRobotAndPathInView) {
  for (const auto& [width, height] : {std::pair(640, 400), std::pair(390, 760)}) {
    open("", width, height);
    EXPECT_EQ(true, browser_->evaluate(
                        "replayPage.replay.frames.every(({pose: [x, y, z]}) => { const p = new "
                        "THREE.Vector3(x, y, z).project(replayPage.views.camera); return "
                        "Math.abs(p.x) < 1 && Math.abs(p.y) < 1 && p.z < 1; })"));
  }
  EXPECT_THAT(text("moment"), HasSubstr("frame 0 · 0.0 m/s over 1 s · 2 tracks"));
  browser_->evaluate("replayPage.setTime(2)");
  EXPECT_TRUE(browser_->waitFor("moment.textContent.startsWith('frame 20 · 5.0 m/s over 1 s')"));
  EXPECT_THAT(browser_->messages(), IsEmpty());
}

TEST_F(ReplayPageInBrowserTest, ALinkIsDrawnBeforeTheNextPicture) {
  open("#t=1");
  EXPECT_EQ("20 top", browser_->evaluate(
                          "window.requestAnimationFrame = () => 0; history.replaceState(null, '', "
                          "'#t=2&view=top'); dispatchEvent(new Event('hashchange')); "
                          "document.documentElement.dataset.drawn"));
}

TEST_F(ReplayPageInBrowserTest, PointsBetweenEyeAndRobotFade) {
  open("#t=1&view=orbit");
  // From beyond the wall on the right.
  browser_->evaluate(
      "Object.assign(replayPage.views.orbit, {turn: -Math.PI / 2, elevation: 0.15, distance: 20}); "
      "replayPage.redraw()");
  const cv::Mat picture = screenshot();
  cv::Mat wall;
  cv::inRange(picture, cv::Scalar(44, 76, 140), cv::Scalar(84, 116, 180), wall);
  const cv::Rect robot(290, 165, 60, 50);
  EXPECT_LT(cv::countNonZero(wall(robot)), robot.area() / 10) << "was all of it";
  EXPECT_GT(cv::countNonZero(wall), 2000) << "elsewhere it is seen";
}

TEST_F(ReplayPageInBrowserTest, EachViewLooksAsBefore) {
  open("#t=1");
  cv::Mat last;
  for (const std::string view : {"follow", "orbit", "top", "camera"}) {
    browser_->evaluate("replayPage.changeView('" + view + "')");
    last = smallVersion(screenshot());
    const std::string expected_file =
        std::string(HEADWAY_SOURCE_DIR) + "/tests/report/pictures/" + view + ".png";
    const cv::Mat expected = cv::imread(expected_file);
    const bool is_alike = !expected.empty() && difference(last, expected) < 0.05;
    const std::string actual_file = ::testing::TempDir() + "replay_page_" + view + ".png";
    if (!is_alike) cv::imwrite(actual_file, last);
    EXPECT_TRUE(is_alike) << actual_file << " differs from " << expected_file;
  }
  browser_->evaluate("replayPage.changeView('follow'); replayPage.setTime(2)");
  EXPECT_GT(difference(smallVersion(screenshot()), last), 0.10) << "another view, another time";
  EXPECT_THAT(browser_->messages(), IsEmpty());
}

TEST_F(ReplayPageInBrowserTest, WhatIsSelectedStandsOutInBothThemes) {
  open("#t=1&track=7");
  const std::string edges =
      "[...replayPage.world.boxes.values()].map((box) => box.edges.material.color.getHexString())";
  browser_->evaluate("replayPage.setTheme(false)");
  EXPECT_TRUE(browser_->waitFor(edges + ".includes('ffffff')"));
  browser_->evaluate("replayPage.setTheme(true)");
  EXPECT_TRUE(browser_->waitFor(edges + ".includes('1b2430')"));
  EXPECT_EQ(false, browser_->evaluate(edges + ".includes('ffffff')"));
  EXPECT_THAT(browser_->messages(), IsEmpty());
}

TEST_F(ReplayPageInBrowserTest, FitsAPhone) {
  open("#t=1&track=7", 390, 760);
  EXPECT_EQ(390, browser_->evaluate("document.documentElement.scrollWidth"));
  EXPECT_EQ(true, browser_->evaluate(
                      "[...document.querySelectorAll('button, select, input[type=range]')].filter("
                      "(e) => e.offsetParent).every((e) => { const r = e.getBoundingClientRect(); "
                      "return r.left >= 0 && r.right <= 390 && r.bottom <= 760; })"))
      << "every control is on the screen";
  EXPECT_THAT(browser_->messages(), IsEmpty());
}

TEST_F(ReplayPageInBrowserTest, WithoutWebglAMessageAndTheViewFromAboveRemain) {
  open("#t=1", 640, 400, "--disable-3d-apis");
  EXPECT_THAT(text("message"), HasSubstr("no WebGL"));
  EXPECT_EQ("10 top", browser_->evaluate("document.documentElement.dataset.drawn"));
  const cv::Mat blue = screenshot();
  cv::Mat car;
  cv::inRange(blue, cv::Scalar(200, 130, 30), cv::Scalar(255, 190, 90), car);
  EXPECT_GT(cv::countNonZero(car), 100) << "the moving car";
}

}  // namespace
}  // namespace headway::report
