// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <random>

#include "plain_rawlog.h"
#include "replay_run.h"

namespace headway {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// A replay of bad input: an error is one line on standard error, and never a crash.
class BadInputTest : public ::testing::Test {
 protected:
  BadInputTest() : rawlog((folder / "in.rawlog").string()) {}

  test::ReplayRun replayIt(const std::string& options = "") {
    return test::replay(rawlog, folder / "out", "-q --snapshots 0 " + options);
  }

  /// The one line of a replay that must end with status 1.
  std::string errorLine(const test::ReplayRun& run) {
    EXPECT_EQ(1, run.process.status) << run.process.output;
    EXPECT_EQ(1, std::count(run.process.output.begin(), run.process.output.end(), '\n'))
        << run.process.output;
    EXPECT_THAT(run.process.output, ::testing::StartsWith("headway-replay: "));
    return run.process.output;
  }

  void expectAllFramesOnDisk(const test::ReplayRun& run, std::size_t frames) {
    EXPECT_EQ(frames, run.summary.at("frames_tracked")) << run.process.output;
    EXPECT_EQ(frames, io::readTum(run.file("trajectory.tum")).size());
    EXPECT_GT(test::contentsOf(run.file("map.headway")).size(), 0u);
  }

  void writeWithCamera(const io::RawStereoCamera& camera, bool swap_images = false) {
    io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
    for (int frame = 0; frame < 3; ++frame) {
      auto pair = test::plainPair(frame);
      if (swap_images) std::swap(pair.left, pair.right);
      sink.writeStereo(test::plainTime(frame), pair.left, pair.right, camera);
    }
    sink.close();
  }

  test::TemporaryFolder folder;
  std::string rawlog;
};

TEST_F(BadInputTest, ReplayRecordsTheHashOfTheModel) {
  HEADWAY_REQUIRE_DATA(data);
  test::writePlainRawlog(rawlog);
  const auto model = (data / "models" / "yolox_nano.onnx").string();
  const auto run = replayIt("--detector dnn+stereo_motion --set dnn.model=" + model);
  const auto record = nlohmann::json::parse(test::contentsOf(run.file("replay.json")));
  EXPECT_EQ(model, record["detector_model"]["file"]);
  EXPECT_EQ(64u, record["detector_model"]["sha256"].get<std::string>().size());
  const auto without = replayIt("-w");
  EXPECT_EQ(
      0u,
      nlohmann::json::parse(test::contentsOf(without.file("replay.json"))).count("detector_model"));
}

TEST_F(BadInputTest, GoodInputIsGood) {
  test::writePlainRawlog(rawlog);
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  expectAllFramesOnDisk(run, test::kPlainFrames);
  EXPECT_EQ(test::kPlainFrames, run.summary.at("detections_used"));
}

TEST_F(BadInputTest, AnEmptyResultDoesNotReplaceAGoodOne) {
  writeWithCamera(io::rawFrom(test::plainCamera()));
  ASSERT_EQ(0, replayIt().process.status);
  const std::string before = test::contentsOf(folder / "out/trajectory.tum");
  EXPECT_THAT(errorLine(replayIt("-w --from-index 1000")), HasSubstr("check --from-index"));
  EXPECT_EQ(before, test::contentsOf(folder / "out/trajectory.tum"));
  io::RawlogSink dark(rawlog, io::ImageStorage::kEmbedded);
  const cv::Mat black(test::plainPair(0).left.size(), CV_8U, cv::Scalar(0));
  for (int frame = 0; frame < test::kPlainFrames; ++frame) {
    dark.writeStereo(1000.0 + 0.1 * frame, black, black, io::rawFrom(test::plainCamera()));
  }
  dark.close();
  EXPECT_NE(0, replayIt("-w").process.status);
  EXPECT_EQ(before, test::contentsOf(folder / "out/trajectory.tum"));
}

TEST_F(BadInputTest, AFullStandardOutputIsAnError) {
  writeWithCamera(io::rawFrom(test::plainCamera()));
  const auto run = test::runProcess("(" + test::program("headway-replay") + " -i " + rawlog +
                                    " -o " + (folder / "out").string() + " >/dev/full)");
  EXPECT_EQ(1, run.status);
  EXPECT_THAT(run.output, HasSubstr("standard output: not written completely"));
}

TEST_F(BadInputTest, TimesThatNeverAdvanceAreAnErrorThatReplacesNothing) {
  writeWithCamera(io::rawFrom(test::plainCamera()));
  ASSERT_EQ(0, replayIt().process.status);
  const std::string before = test::contentsOf(folder / "out/trajectory.tum");
  for (const double step_s : {0.0, -0.1}) {
    io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
    for (int frame = 0; frame < test::kPlainFrames; ++frame) {
      const auto pair = test::plainPair(frame);
      sink.writeStereo(1000.0 + step_s * frame, pair.left, pair.right,
                       io::rawFrom(test::plainCamera()));
    }
    sink.close();
    EXPECT_THAT(errorLine(replayIt("-w")), HasSubstr("of all 12 frames are equal or go back"));
    EXPECT_EQ(before, test::contentsOf(folder / "out/trajectory.tum"));
  }
}

TEST_F(BadInputTest, AWrongTruthIsOneError) {
  test::writePlainRawlog(rawlog);
  const auto truth = folder / "truth";
  std::filesystem::create_directories(truth);
  const auto lineWith = [&](const std::string& trajectory) {
    std::ofstream(truth / "trajectory.tum") << trajectory;
    return errorLine(replayIt("-w --truth " + truth.string()));
  };
  EXPECT_THAT(lineWith("1000.0 0 0 zero\n"), HasSubstr("trajectory.tum"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out")) << "it is found before the run";
  EXPECT_THAT(lineWith("7.0 0 0 0 0 0 0 1\n"), HasSubstr("it may belong to another rawlog"));
}

TEST_F(BadInputTest, NoNameReachesTheTerminalWithAnEscapeSequence) {
  test::writePlainRawlog(rawlog);
  const auto run = test::replay(rawlog,
                                folder /
                                    "out\xC2\x9B"
                                    "2J",
                                "--snapshots 1");
  EXPECT_EQ(0, run.process.status);
  EXPECT_THAT(run.process.output, HasSubstr("out?2J/report.html"));
  EXPECT_THAT(run.process.output, ::testing::Not(HasSubstr("\xC2\x9B")));
}

TEST_F(BadInputTest, MissingRawlog) { EXPECT_THAT(errorLine(replayIt()), HasSubstr("in.rawlog")); }

TEST_F(BadInputTest, TruncatedRawlogKeepsTheFramesBefore) {
  test::writePlainRawlog(rawlog);
  std::filesystem::resize_file(rawlog, std::filesystem::file_size(rawlog) * 2 / 3);
  const auto run = replayIt();
  EXPECT_THAT(errorLine(run), HasSubstr("in.rawlog"));
  const std::size_t tracked = run.summary.at("frames_tracked");
  EXPECT_GE(tracked, 3u);
  EXPECT_LT(tracked, static_cast<std::size_t>(test::kPlainFrames));
  expectAllFramesOnDisk(run, tracked);
  EXPECT_TRUE(run.summary.at("ended_early").is_string());
}

TEST_F(BadInputTest, RandomBytes) {
  std::mt19937 random(1);
  std::ofstream file(rawlog, std::ios::binary);
  for (int i = 0; i < 20000; ++i) file.put(static_cast<char>(random()));
  file.close();
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("in.rawlog"));
}

TEST_F(BadInputTest, EmptyFile) {
  std::ofstream(rawlog).close();
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("in.rawlog"));
}

TEST_F(BadInputTest, RawlogWithoutStereo) {
  io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
  sink.writeOdometry(1.0, 0.0, 0.0, 0.0);
  sink.close();
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("stereo"));
}

TEST_F(BadInputTest, MissingExternalImageIsACountedSkip) {
  test::writePlainRawlog(rawlog, io::ImageStorage::kExternalPng);
  std::vector<std::filesystem::path> images;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "in_Images")) {
    images.push_back(entry.path());
  }
  std::sort(images.begin(), images.end());
  ASSERT_EQ(2u * test::kPlainFrames, images.size());
  std::filesystem::remove(images[images.size() / 4]);
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(1, run.summary.at("observations_skipped").at("missing_image"));
  EXPECT_EQ(1, run.summary.at("frames_lost"));
  expectAllFramesOnDisk(run, test::kPlainFrames - 1);
}

TEST_F(BadInputTest, ABrokenJpegIsACountedSkip) {
  {
    io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
    for (int frame = 0; frame < test::kPlainFrames; ++frame) {
      auto pair = test::plainPair(frame);
      for (cv::Mat* image : {&pair.left, &pair.right})
        cv::cvtColor(*image, *image, cv::COLOR_GRAY2BGR);
      sink.writeStereo(test::plainTime(frame), pair.left, pair.right,
                       io::rawFrom(test::plainCamera()));
    }
    sink.close();
  }
  const auto plain = folder / "plain";
  ASSERT_EQ(0, test::runProcess("gzip -dc " + rawlog + " > " + plain.string()).status);
  std::string bytes = test::contentsOf(plain);
  auto at = bytes.find("\xFF\xC4");  // Huffman tables, without which libjpeg cannot go on
  for (std::size_t middle = bytes.size() / 2; at < middle; at = bytes.find("\xFF\xC4", at + 1)) {
  }
  ASSERT_NE(std::string::npos, at);
  bytes[at + 4] = '\x7F';
  std::ofstream(rawlog, std::ios::binary) << bytes;
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(1, run.summary.at("observations_skipped").at("broken_image"));
  expectAllFramesOnDisk(run, test::kPlainFrames - 1);
}

TEST_F(BadInputTest, ZeroBaseline) {
  auto camera = io::rawFrom(test::plainCamera());
  camera.T_left_right.translation().setZero();
  writeWithCamera(camera);
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("baseline"));
}

TEST_F(BadInputTest, NegativeBaseline) {
  auto camera = io::rawFrom(test::plainCamera());
  camera.T_left_right.translation() *= -1.0;
  writeWithCamera(camera);
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("baseline"));
}

TEST_F(BadInputTest, ZeroFocalLength) {
  auto camera = io::rawFrom(test::plainCamera());
  camera.left.fx = camera.right.fx = 0.0;
  writeWithCamera(camera);
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("focal"));
}

TEST_F(BadInputTest, LeftAndRightImageSwapped) {
  writeWithCamera(io::rawFrom(test::plainCamera()), true);
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("swapped"));
}

TEST_F(BadInputTest, ImpossibleBoxesAreCountedByReason) {
  auto nan = test::plainDetection();
  nan.box3d->centre.x() = std::numeric_limits<double>::quiet_NaN();
  auto behind = test::plainDetection();
  behind.box3d->centre.z() = -5.0;
  auto flat = test::plainDetection();
  flat.box3d->height = 0.0;
  {
    io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
    for (int frame = 0; frame < test::kPlainFrames; ++frame) {
      test::writePlainFrame(sink, frame, {test::plainDetection(), nan, behind, flat});
    }
    sink.close();
  }
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_EQ(test::kPlainFrames, run.summary.at("detections_used"));
  const auto& dropped = run.summary.at("detections_dropped");
  EXPECT_EQ(test::kPlainFrames, dropped["nan_box"]) << dropped;
  EXPECT_EQ(test::kPlainFrames, dropped["behind_camera"]) << dropped;
  EXPECT_EQ(test::kPlainFrames, dropped["zero_size"]) << dropped;
  EXPECT_THAT(test::contentsOf(run.folder / "detections.csv"), ::testing::Not(HasSubstr("nan")));
}

TEST_F(BadInputTest, TimeRunningBackwardsIsACountedSkip) {
  {
    io::RawlogSink sink(rawlog, io::ImageStorage::kEmbedded);
    for (const int frame : {0, 1, 2, 3, 2, 1, 4, 5}) {
      test::writePlainFrame(sink, frame, {test::plainDetection()});
    }
    sink.close();
  }
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  EXPECT_GE(run.summary.at("observations_skipped").at("time_backwards"), 2);
  expectAllFramesOnDisk(run, 6);
}

TEST_F(BadInputTest, UnknownClassInTheRawlogIsACountedSkip) {
  // The class name of the boxes, changed in the file: a class that no one has registered.
  test::writePlainRawlog(rawlog);
  const auto plain = folder / "plain";
  ASSERT_EQ(0, test::runProcess("gzip -dc " + rawlog + " > " + plain.string()).status);
  std::string bytes = test::contentsOf(plain);
  const std::string name = "CObservationObjectDetections";
  std::size_t changed = 0;
  for (auto at = bytes.find(name); at != std::string::npos; at = bytes.find(name, at + 1)) {
    bytes.replace(at, name.size(), "CObservationOfSomethingElses");
    ++changed;
  }
  ASSERT_EQ(static_cast<std::size_t>(test::kPlainFrames), changed);
  std::ofstream(rawlog, std::ios::binary) << bytes;
  const auto run = replayIt();
  EXPECT_EQ(0, run.process.status) << run.process.output;
  expectAllFramesOnDisk(run, test::kPlainFrames);
  std::size_t skipped = 0;
  for (const auto& [reason, count] : run.summary.at("observations_skipped").items()) {
    if (reason.find("CObservationOfSomethingElses") != std::string::npos) {
      skipped += count.get<std::size_t>();
    }
  }
  EXPECT_EQ(static_cast<std::size_t>(test::kPlainFrames), skipped)
      << run.summary.at("observations_skipped");
  EXPECT_EQ(0, run.summary.at("detections_used"));
}

TEST_F(BadInputTest, UnwritableOutput) {
  test::writePlainRawlog(rawlog);
  std::ofstream(folder / "out") << "a file where the folder should be";
  const auto run = replayIt();
  EXPECT_THAT(errorLine(run), HasSubstr("out"));
}

TEST_F(BadInputTest, ExistingResultsAreNotOverwrittenUnasked) {
  test::writePlainRawlog(rawlog);
  EXPECT_EQ(0, replayIt().process.status);
  EXPECT_THAT(errorLine(replayIt()), HasSubstr("-w"));
  EXPECT_EQ(0, replayIt("-w").process.status);
}

TEST_F(BadInputTest, UnknownConfigurationKey) {
  test::writePlainRawlog(rawlog);
  const auto config = folder / "bad.ini";
  std::ofstream(config) << "[slam]\nno_such_key = 1\n";
  EXPECT_THAT(errorLine(replayIt("-c " + config.string())),
              AllOf(HasSubstr("bad.ini"), HasSubstr("[slam]"), HasSubstr("no_such_key")));
}

TEST_F(BadInputTest, ADetectorWithoutItsModelEndsBeforeTheReplay) {
  test::writePlainRawlog(rawlog);
  EXPECT_THAT(errorLine(replayIt("--detector dnn")),
              AllOf(HasSubstr("[dnn] model is not set"), HasSubstr("expected")));
  EXPECT_THAT(errorLine(replayIt("--detector dnn --set dnn.model=nowhere.onnx")),
              AllOf(HasSubstr("nowhere.onnx"), HasSubstr("ONNX")));
  EXPECT_THAT(errorLine(replayIt("--set detect.detector=radar")),
              AllOf(HasSubstr("radar"), HasSubstr("stereo_motion")));
}

TEST_F(BadInputTest, WrongUseEndsWithStatus2) {
  EXPECT_EQ(2, replayIt("--no-such-option").process.status);
  EXPECT_EQ(2, replayIt("--realtime -1").process.status);
  EXPECT_EQ(2, replayIt("--detector unknown").process.status);
}

}  // namespace
}  // namespace headway
