// SPDX-License-Identifier: BSD-3-Clause
// headway-import --check, and refusals that name their cause.
#include <gmock/gmock.h>
#include <headway/io/calibration_file.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <fstream>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <regex>
#include <vector>

#include "foreign_recording.h"
#include "processes.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using Objects = std::vector<mrpt::serialization::CSerializable::Ptr>;

class RecordingCheckTest : public ::testing::Test {
 protected:
  static test::ProcessResult import(const std::string& arguments) {
    return test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-import " + arguments);
  }
  test::ProcessResult check(const std::string& name) {
    return import("rawlog " + at(name) + " --check");
  }
  std::string at(const std::string& name) { return folder_ / name; }
  std::string refusalOf(const std::string& name) {
    return test::errorOf([&] { RawlogSource source(at(name), {}); });
  }
  /// Two cameras whose images are apart.
  void writeApart(const std::string& name, double seconds) {
    Objects objects;
    for (int i = 0; i < 30; ++i) {
      const Time time = test::frameTime(static_cast<std::size_t>(i));
      objects.push_back(test::singleImage(0, i, time, "left"));
      objects.push_back(test::singleImage(1, i, time + seconds, "right"));
    }
    test::writeObjects(at(name), objects);
  }

  headway::test::TemporaryFolder folder_;
};

TEST_F(RecordingCheckTest, MissingTimesAreNamed) {
  Objects objects;
  for (int i = 0; i < 5; ++i) {
    auto stereo = test::wallObservation(i, test::frameTime(0));
    stereo->timestamp = INVALID_TIMESTAMP;
    objects.push_back(stereo);
  }
  test::writeObjects(at("x.rawlog"), objects);
  EXPECT_THAT(refusalOf("x.rawlog"), HasSubstr("5 observations have no timestamp"));
  const auto result = check("x.rawlog");
  EXPECT_EQ(1, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("5 of 5 without a time"));
}

TEST_F(RecordingCheckTest, ImagesOf16BitAreNamed) {
  const cv::Mat deep(120, 160, CV_16UC1, cv::Scalar(4000));
  Objects objects;
  for (int i = 0; i < 5; ++i) {
    auto stereo = test::wallObservation(i, test::frameTime(static_cast<std::size_t>(i)));
    stereo->imageLeft = mrpt::img::CImage(deep, mrpt::img::DEEP_COPY);
    stereo->imageRight = mrpt::img::CImage(deep, mrpt::img::DEEP_COPY);
    objects.push_back(stereo);
  }
  test::writeObjects(at("x.rawlog"), objects);
  EXPECT_THAT(refusalOf("x.rawlog"),
              AllOf(HasSubstr("image_16_bit: 5"), HasSubstr("16 bits per channel")));
  EXPECT_THAT(check("x.rawlog").output, HasSubstr("16 bits per channel"));
}

TEST_F(RecordingCheckTest, FilesOf16BitAreNamed) {
  std::filesystem::create_directories(at("x_Images"));
  const cv::Mat deep(120, 160, CV_16UC1, cv::Scalar(4000));
  cv::imwrite(at("x_Images/deep.png"), deep);
  cv::imwrite(at("x_Images/deep.tif"), deep);
  auto stereo = test::wallObservation(0, test::frameTime(0));
  stereo->imageLeft.setExternalStorage("deep.png");
  stereo->imageRight.setExternalStorage("deep.tif");
  test::writeObjects(at("x.rawlog"), {stereo});
  EXPECT_THAT(refusalOf("x.rawlog"), HasSubstr("16 bits per channel"));

  writeCalibration(at("c.yaml"), test::smallCamera());
  const auto result = import("images --left " + at("x_Images") + " --right " + at("x_Images") +
                             " --calibration " + at("c.yaml") + " --check");
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, HasSubstr("has 16 bits per channel"));
}

TEST_F(RecordingCheckTest, PairsThatAreApartAreNamed) {
  writeApart("x.rawlog", 0.02);
  EXPECT_THAT(refusalOf("x.rawlog"),
              AllOf(HasSubstr("20 ms apart"), HasSubstr("allowed are 10 ms")));
  const auto result = check("x.rawlog");
  EXPECT_EQ(1, result.status) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("times between left and right: median +20.0 ms"),
                                   HasSubstr("trigger both cameras together")));
  writeApart("y.rawlog", 0.0005);
  EXPECT_THAT(check("y.rawlog").output, HasSubstr("ok       times between left and right"));
}

TEST_F(RecordingCheckTest, SensorsOfAnotherClockAreNamed) {
  for (const auto& [offset, expected] :
       {std::pair(-0.02,
                  "ok       times of wheels (CObservationOdometry): 30, 10.00 Hz, longest gap "
                  "0.100 s, 0 gaps, +0.000 s from the images"),
        std::pair(-0.6, "warning  times of wheels"),
        std::pair(120.0, "bad      times of wheels")}) {
    Objects objects;
    for (int i = 0; i < 30; ++i) {
      const Time time = test::frameTime(static_cast<std::size_t>(i));
      auto wheels = mrpt::obs::CObservationOdometry::Create();
      wheels->sensorLabel = "wheels";
      wheels->timestamp = mrptTime(time + offset);
      objects.push_back(wheels);
      objects.push_back(test::wallObservation(i, time));
    }
    test::writeObjects(at("x.rawlog"), objects);
    const auto result = check("x.rawlog");
    EXPECT_THAT(result.output, HasSubstr(expected));
    EXPECT_EQ(offset != -0.02, result.output.find("use one clock") != std::string::npos);
    if (offset > 1.0) {
      EXPECT_EQ(1, result.status);
    }
  }
}

TEST_F(RecordingCheckTest, LaserScansAreNotCalledUnused) {
  Objects objects;
  for (int i = 0; i < 5; ++i) {
    const Time time = test::frameTime(static_cast<std::size_t>(i));
    auto scan = mrpt::obs::CObservation2DRangeScan::Create();
    scan->sensorLabel = "laser";
    scan->timestamp = mrptTime(time);
    scan->resizeScanAndAssign(3, 2.0F, true);
    objects.push_back(test::wallObservation(i, time));
    objects.push_back(scan);
  }
  test::writeObjects(at("x.rawlog"), objects);
  EXPECT_THAT(check("x.rawlog").output,
              AllOf(HasSubstr("times of laser"), Not(HasSubstr("unused"))));
}

TEST_F(RecordingCheckTest, AGoodRecordingIsOk) {
  const auto result =
      import("rawlog " + std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog --check");
  EXPECT_EQ(0, result.status) << result.output;
  for (const char* item :
       {"ok       rig: 672x256 px, baseline 0.5400 m", "ok       times of stereo", "10.00 Hz",
        "ok       exposure", "ok       blur", "ok       vertical offset", "result: 0 bad"}) {
    EXPECT_THAT(result.output, HasSubstr(item));
  }
}

TEST_F(RecordingCheckTest, WhatNothingShowsIsUnknown) {
  test::writeObjects(at("x.rawlog"),
                     {test::wallObservation(0, 100.0), test::wallObservation(1, 100.1)});
  EXPECT_THAT(check("x.rawlog").output,
              AllOf(HasSubstr("unknown  mounting: not compared"), HasSubstr(" 1 unknown,")));
}

TEST_F(RecordingCheckTest, GapsAndTimesSetBackAreSeen) {
  Objects objects;
  for (int i = 0; i < 60; ++i) {
    const double gap = i < 30 ? 0.0 : 2.0;
    objects.push_back(test::wallObservation(i, 100.0 + 0.1 * i + gap));
  }
  test::writeObjects(at("x.rawlog"), objects);
  EXPECT_THAT(check("x.rawlog").output,
              AllOf(HasSubstr("longest gap 2.100 s, 1 gaps"), HasSubstr("samples are missing")));
  objects.push_back(test::wallObservation(60, 90.0));
  test::writeObjects(at("x.rawlog"), objects);
  EXPECT_THAT(check("x.rawlog").output, HasSubstr("the clock was set"));
}

TEST_F(RecordingCheckTest, UsageIsChecked) {
  EXPECT_EQ(2, import("rawlog x.rawlog").status);
  EXPECT_EQ(2, import("euroc /x").status);  // neither -o nor --check
  EXPECT_EQ(0, import("rawlog --help").status);
  EXPECT_EQ(1, import("rawlog " + at("none.rawlog") + " --check").status);
}

/// Frames of the bundled hall with right images that are `rows(i)` px lower, or of another place.
void writeHall(const std::string& path, bool is_other, const std::function<int(int)>& rows) {
  static const auto frames = [] {
    RawlogSource source(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall.rawlog", {});
    return test::framesOf(source);
  }();
  RawlogSink sink(path, ImageStorage::kEmbeddedRaw);
  for (int i = 0; i < 30; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const auto& left = *frames[index].stereo;
    const cv::Mat& right = frames[is_other ? frames.size() - 1 - index : index].stereo->right;
    const cv::Matx23d down(1, 0, 0, 0, 1, rows(i));
    cv::Mat moved;
    cv::warpAffine(right, moved, down, right.size(), cv::INTER_NEAREST, cv::BORDER_REFLECT);
    sink.writeStereo(left.time, left.left, moved, rawFrom(*left.camera));
  }
  sink.close();
}

TEST_F(RecordingCheckTest, PairsThatHaveNothingInCommonAreRefusedInTheFirstSecond) {
  const auto framesBeforeRefusal = [&](std::size_t& frames) {
    return test::errorOf([&] {
      RawlogSource source(at("x.rawlog"), {});
      while (source.next()) ++frames;
    });
  };
  std::size_t frames = 0;
  writeHall(at("x.rawlog"), true, [](int) { return 0; });
  EXPECT_THAT(framesBeforeRefusal(frames),
              HasSubstr("nothing matches: the cameras see different things, or are not "
                        "synchronised"));
  EXPECT_LT(frames, 15u) << "the hall has 15 a second";
  const auto result = check("x.rawlog");
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, HasSubstr("nothing matches"));
  frames = 0;
  writeHall(at("x.rawlog"), false, [](int i) { return -7 + 2 * i; });  // while the cameras nod
  EXPECT_THAT(framesBeforeRefusal(frames), HasSubstr("not synchronised (rows differ by"));
  EXPECT_LT(frames, 15u) << "the hall has 15 a second";
  for (const int row : {0, 3, 12}) {  // as of a camera that is turned in its mounting
    frames = 0;
    writeHall(at("x.rawlog"), false, [&](int) { return row; });
    EXPECT_EQ("no error", framesBeforeRefusal(frames)) << row;
    EXPECT_EQ(30u, frames);
  }
}

/// A depth camera before boxes at 1 to 3 m and a wall at 4 m. The calibration that is written has
/// both cameras in one place, with the lens of the colour image.
///
/// @param shift_m  of the depth camera to the right
/// @param growth   of its focal length
void writeBoxes(const std::string& path, double shift_m, double growth) {
  constexpr int kWidth = 320, kHeight = 240;
  RawDepthCamera camera;
  camera.color = {kWidth, kHeight, 280.0, 280.0, 159.5, 119.5, {}, {}, false};
  camera.depth = camera.color;
  camera.max_range_m = 8.0;
  RawlogSink sink(path, ImageStorage::kEmbeddedRaw);
  for (int i = 0; i < 30; ++i) {
    cv::Mat left(kHeight, kWidth, CV_8U, cv::Scalar(120)), noise(kHeight, kWidth, CV_16S);
    cv::Mat depth(kHeight, kWidth, CV_16U, cv::Scalar(4000));
    cv::RNG random(3), grain(static_cast<std::uint64_t>(i));
    for (int box = 0; box < 12; ++box) {  // from the farthest on
      const double z = 3.0 - 2.0 * box / 12.0, side = random.uniform(0.15, 0.5);
      const double x = random.uniform(-1.0, 1.0) * 0.6 * z - 0.02 * i,
                   y = random.uniform(-0.4, 0.4) * z;
      const auto draw = [&](cv::Mat& image, double focal, double from_x, double value) {
        const cv::Point corner(cvRound(159.5 + focal * (x - from_x) / z),
                               cvRound(119.5 + focal * y / z));
        cv::rectangle(
            image,
            cv::Rect(corner, cv::Size(cvRound(focal * side / z), cvRound(1.5 * focal * side / z))),
            value, cv::FILLED);
      };
      draw(left, 280.0, 0.0, box % 2 == 0 ? 60.0 + box : 180.0 + 4 * box);
      draw(depth, 280.0 * (1.0 + growth), shift_m, 1000.0 * z);
    }
    grain.fill(noise, cv::RNG::NORMAL, 0, 2);
    cv::add(left, noise, left, cv::noArray(), CV_8U);
    sink.writeDepth(test::frameTime(static_cast<std::size_t>(i)), left, depth, camera);
  }
  sink.close();
}

TEST_F(RecordingCheckTest, ColourAndDepthThatAreOutOfRegisterAreMeasured) {
  const auto registration = [&](double shift_m, double growth) {
    writeBoxes(at("x.rawlog"), shift_m, growth);
    const std::string output = check("x.rawlog").output;
    std::smatch match;
    EXPECT_TRUE(std::regex_search(
        output, match,
        std::regex("(\\w+) +registration: depth fits colour if moved by ([+-]\\d+) \\+- \\d+ mm "
                   "right, ([+-]\\d+) \\+- \\d+ mm down, and grown by ([+-][0-9.]+) ")))
        << output;
    return std::vector<std::string>(match.begin(), match.end());
  };
  const auto good = registration(0.0, 0.0);
  EXPECT_EQ("ok", good[1]);
  const auto shifted = registration(0.03, 0.0);
  EXPECT_EQ("warning", shifted[1]);
  EXPECT_NEAR(30.0, std::stod(shifted[2]), 8.0);
  EXPECT_NEAR(0.0, std::stod(shifted[3]), 8.0);
  EXPECT_NEAR(0.0, std::stod(shifted[4]), 1.5);
  const auto grown = registration(0.0, 0.06);
  EXPECT_EQ("warning", grown[1]);
  EXPECT_NEAR(0.0, std::stod(grown[2]), 8.0);
  EXPECT_NEAR(-5.7, std::stod(grown[4]), 1.5) << "1 / 1.06 - 1";
}

TEST_F(RecordingCheckTest, TheMountingIsComparedWithTheFloor) {
  const std::string hall = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/hall.rawlog";
  EXPECT_THAT(import("rawlog " + hall + " --check").output,
              HasSubstr("ok       mounting: as the floor in view shows it: 0.3"));
  ASSERT_EQ(0, test::runProcess(std::string(HEADWAY_BIN_DIR) +
                                "/headway-export kitti-odometry -q --to-index 59 " + hall + " -o " +
                                at("kitti"))
                   .status);
  std::ofstream(at("c.yaml")) << "image_size: [640, 480]\nleft: [450, 450, 319.5, 239.5]\n"
                                 "baseline_m: 0.05\nframe_rate_hz: 15\nT_robot_cam: [0, "
                                 "-0.08715574, 0.9961947, 0.1, -1, 0, 0, 0.025, 0, -0.9961947, "
                                 "-0.08715574, 0.6]\n";
  const auto wrong = import("images --left " + at("kitti/image_0") + " --right " +
                            at("kitti/image_1") + " --calibration " + at("c.yaml") + " --check");
  EXPECT_THAT(wrong.output,
              AllOf(HasSubstr("warning  camera_mounting"), HasSubstr("is stated to be 0.60 m")));
}

/// The stated offset of the inertial sensor's times [ms].
double statedOffset(const std::string& output) {
  std::smatch match;
  EXPECT_TRUE(std::regex_search(output, match, std::regex("inertial times ([+-][0-9]+) ms")))
      << output;
  return match.empty() ? 1e9 : std::stod(match[1].str());
}

TEST_F(RecordingCheckTest, ExactTimesOfAnInertialSensorAreOk) {
  for (const int seed : {1, 2}) {
    const auto made = test::runProcess(
        std::string(HEADWAY_BIN_DIR) + "/headway-sim -q -w -c " + HEADWAY_SOURCE_DIR +
        "/config/worlds/hall.ini --rig small --frames 100 --set camera.imu=true --seed " +
        std::to_string(seed) + " -o " + at("x.rawlog"));
    ASSERT_EQ(0, made.status) << made.output;
    EXPECT_NEAR(0.0, statedOffset(check("x.rawlog").output), 4.0) << seed;
  }
}

TEST_F(RecordingCheckTest, TheClockOfAnInertialSensorIsMeasured) {
  HEADWAY_REQUIRE_DATA(data);
  const auto result =
      import("kitti-raw " + (data / "kitti_raw").string() +
             " --drive 2011_09_26_drive_0005_sync --from-index 60 -q --check -o " + at("x.rawlog"));
  std::map<std::string, std::size_t> skipped;
  RawlogSink sink(at("late.rawlog"), ImageStorage::kEmbeddedRaw);
  (void)visitObservations(at("x.rawlog"), skipped, [&](const mrpt::obs::CObservation& observation) {
    const auto copy =
        std::dynamic_pointer_cast<mrpt::obs::CObservation>(observation.duplicateGetSmartPtr());
    if (dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation) != nullptr) {
      copy->timestamp = mrptTime(timeFrom(observation.timestamp) + 0.08);
    }
    sink.write(*copy);
  });
  sink.close();
  const auto late = check("late.rawlog");
  EXPECT_EQ(1, late.status);
  EXPECT_NEAR(80.0, statedOffset(late.output) - statedOffset(result.output), 4.0);
}

}  // namespace
}  // namespace headway::io
