// SPDX-License-Identifier: BSD-3-Clause
// Every parameter at both ends of its range, as --dump-config --expert prints it, on the street.
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/repeats.h>

#include <cmath>
#include <sstream>

namespace headway::pipeline {
namespace {

constexpr std::size_t kImageFrames = test::repeats(8, 3);
constexpr std::size_t kBoxFrames = test::repeats(100, 25);
const std::string kStreetRawlog = std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog";

/// A parameter, and the ends of its range or all its choices.
struct Range {
  std::string section;
  std::string key;
  std::vector<std::string> ends;
};

/// "a" and "b" of a comment that ends in "[unit, a .. b]" or "[a | b]"; empty without such an end.
std::vector<std::string> endsIn(const std::string& comment) {
  const auto open = comment.rfind('[');
  if (open == std::string::npos || comment.back() != ']') return {};
  std::string range = comment.substr(open + 1, comment.size() - open - 2);
  const bool is_number = range.find(" .. ") != std::string::npos;
  if (const auto unit = range.rfind(", "); is_number && unit != std::string::npos) {
    range.erase(0, unit + 2);
  }
  std::vector<std::string> ends;
  std::istringstream words(range);
  for (std::string word; words >> word;) {
    if (word != ".." && word != "|") ends.push_back(word);
  }
  return ends;
}

/// All parameters, by the text that a user reads.
std::vector<Range> ranges() {
  PerceptionParams values;
  Params params;
  values.describe(params);
  std::stringstream text;
  params.print(text);
  std::vector<Range> all;
  std::string section, comment;
  for (std::string line; std::getline(text, line);) {
    if (line.empty()) continue;
    if (line.front() == '[') {
      section = line.substr(1, line.size() - 2);
    } else if (line.front() == '#') {
      comment = line;
    } else {
      all.push_back({section, line.substr(0, line.find(" = ")), endsIn(comment)});
    }
  }
  return all;
}

struct Scene {
  std::shared_ptr<const StereoCamera> camera;  ///< null: poses and boxes alone
  std::vector<RecordedFrame> frames;
};

/// The first frames, with a scan of a laser.
Scene images(std::size_t count) {
  io::RawlogSourceOptions options;
  options.to_index = count - 1;
  io::RawlogSource source(kStreetRawlog, options);
  Scene scene;
  scene.camera = source.camera();
  while (auto frame = source.next()) {
    LaserScan scan;
    scan.time = frame->time;
    scan.ends = {{4.0F, -1.0F}, {4.0F, 0.0F}, {4.0F, 1.0F}};
    frame->laser_scans = {scan};
    scene.frames.push_back(std::move(*frame));
  }
  return scene;
}

/// Boxes and true poses without images.
Scene boxes(std::size_t count) {
  io::RawlogSourceOptions options;
  options.to_index = count - 1;
  io::RawlogSource source(kStreetRawlog, options);
  const auto truth = io::readTruth(kStreetRawlog).poses;
  Scene scene;
  while (auto frame = source.next()) {
    frame->stereo.reset();
    frame->T_map_robot = truth.at(frame->index).value;
    scene.frames.push_back(std::move(*frame));
  }
  return scene;
}

const Scene& sceneFor(const std::string& section) {
  static const Scene kImages = images(kImageFrames);
  static const Scene kFewImages = images(1);
  static const Scene kBoxes = boxes(kBoxFrames);
  if (section == "objects") return kBoxes;
  return section == "hog" || section == "dnn" ? kFewImages : kImages;
}

/// Settings by which the parameters of a section have an effect.
std::vector<std::string> basis(const std::string& section) {
  if (section == "objects" || section == "detect") return {};
  if (section == "hog" || section == "shape" || section == "dnn") {
    return {"detect.detector=" + section};
  }
  return {"detect.detector=stereo_motion", "grid.period_s=0.1"};
}

bool isFinite(const Track& track) {
  bool finite = track.position.allFinite() && track.velocity.allFinite() &&
                track.size.allFinite() && track.position_covariance.allFinite() &&
                track.velocity_covariance.allFinite() && std::isfinite(track.yaw) &&
                std::isfinite(track.yaw_rate) && std::isfinite(track.score);
  for (const auto& path : track.predictions) {
    finite = finite && std::isfinite(path.probability);
    for (const auto& point : path.points) {
      finite = finite && point.position.allFinite() && point.covariance.allFinite();
    }
  }
  return finite;
}

void expectFinite(const PerceptionUpdate& update) {
  EXPECT_TRUE(update.camera.T_map_robot.matrix().allFinite()) << "frame " << update.frame;
  EXPECT_TRUE(update.camera.covariance.allFinite()) << "frame " << update.frame;
  for (const Track& track : update.objects.tracks) {
    EXPECT_TRUE(isFinite(track)) << "frame " << update.frame << ", track " << track.id.value;
  }
}

/// What a run has found, for a test of the scenes.
struct Found {
  std::size_t tracked = 0;    ///< frames
  std::size_t confirmed = 0;  ///< tracks in the last frame
};

Found expectRunsToItsEnd(const std::string& section, const std::vector<std::string>& settings) {
  PerceptionParams values;
  Params params;
  values.describe(params);
  for (const auto& setting : basis(section)) params.set(setting);
  for (const auto& setting : settings) params.set(setting);
  const Scene& scene = sceneFor(section);
  Perception perception(scene.camera, values);
  Found found;
  for (const auto& frame : scene.frames) {
    const auto update = perception.process(frame);
    expectFinite(update);
    found.tracked += update.camera.status == slam::TrackingStatus::kTracked ? 1 : 0;
    found.confirmed = update.objects.tracks.size();
  }
  perception.finish();
  (void)perception.flush();
  EXPECT_EQ(scene.frames.size(), perception.trajectory().size());
  EXPECT_NO_THROW((void)perception.stored());
  return found;
}

class ParameterEndsTest : public testing::TestWithParam<const char*> {
 protected:
  static std::vector<Range> rangesOfSection() {
    std::vector<Range> of_section;
    for (auto& range : ranges()) {
      if (range.section == GetParam()) of_section.push_back(std::move(range));
    }
    return of_section;
  }
};

TEST_P(ParameterEndsTest, EachRunsToItsEnd) {
  for (const auto& range : rangesOfSection()) {
    for (const auto& end : range.ends) {
      const std::string setting = range.section + "." + range.key + "=" + end;
      SCOPED_TRACE(setting);
      EXPECT_NO_THROW((void)expectRunsToItsEnd(range.section, {setting}));
    }
  }
}

/// Contrary parameters may be refused.
TEST_P(ParameterEndsTest, AllAtOneEndRunOrAreRefused) {
  for (const bool lower : {true, false}) {
    std::vector<std::string> settings;
    for (const auto& range : rangesOfSection()) {
      if (range.ends.empty()) continue;
      settings.push_back(range.section + "." + range.key + "=" +
                         (lower ? range.ends.front() : range.ends.back()));
    }
    SCOPED_TRACE(lower ? "lower ends" : "upper ends");
    try {
      (void)expectRunsToItsEnd(GetParam(), settings);
    } catch (const InputError& error) {
      EXPECT_STRNE("", error.what());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Street, ParameterEndsTest,
                         testing::Values("camera", "slam", "detect", "disparity", "stereo_motion",
                                         "hog", "shape", "objects", "grid", "dense", "laser",
                                         "robot"),
                         [](const auto& section) { return std::string(section.param); });

TEST(ParameterRangesTest, AllHaveARangeThatIsTested) {
  const std::vector<std::string> sections = {
      "camera", "slam",    "detect", "disparity", "stereo_motion", "hog",  "shape",
      "dnn",    "objects", "grid",   "dense",     "laser",         "robot"};
  std::size_t tested = 0;
  for (const auto& range : ranges()) {
    EXPECT_NE(sections.end(), std::find(sections.begin(), sections.end(), range.section));
    const bool is_text = range.key == "detector" || range.key == "model" || range.key == "layout" ||
                         range.key == "classes";
    EXPECT_EQ(is_text, range.ends.empty()) << range.section << "." << range.key;
    tested += range.ends.size();
  }
  EXPECT_GT(tested, 380u);
}

TEST(ParameterRangesTest, TheScenesAreTrackedWithDefaults) {
  EXPECT_EQ(kImageFrames, expectRunsToItsEnd("slam", {}).tracked);
  const auto objects = expectRunsToItsEnd("objects", {});
  EXPECT_EQ(kBoxFrames, objects.tracked);
  EXPECT_GE(objects.confirmed, 2u);
}

/// No ground is in reach in the first frames.
TEST(ParameterRangesTest, AnEmptyLookAtTheGroundIsNoGrid) {
  EXPECT_EQ(kImageFrames, expectRunsToItsEnd("grid", {"grid.reach=3"}).tracked);
}

/// A network of another input size than its own is refused.
TEST(ParameterRangesTest, NetworksRunOrAreRefused) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string model = "dnn.model=" + (data / "models" / "yolox_nano.onnx").string();
  for (const auto& range : ranges()) {
    if (range.section != "dnn") continue;
    for (const auto& end : range.ends) {
      const std::string setting = "dnn." + range.key + "=" + end;
      SCOPED_TRACE(setting);
      try {
        (void)expectRunsToItsEnd("dnn", {model, setting});
      } catch (const InputError& error) {
        EXPECT_STRNE("", error.what());
      }
    }
  }
}

}  // namespace
}  // namespace headway::pipeline
