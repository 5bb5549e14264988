// SPDX-License-Identifier: BSD-3-Clause
// What cannot be read: each case a message of one line, or a counted skip, and the rest read.
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <mrpt/obs/CObservationComment.h>
#include <mrpt/obs/CSensoryFrame.h>

#include <cmath>
#include <random>

#include "foreign_recording.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class BadRawlogTest : public ::testing::Test {
 protected:
  std::string errorOfContent(const std::string& content) {
    test::writeContent(path_, content);
    return errorOfFile();
  }
  std::string errorOfFile() {
    return test::errorOf([&] { RawlogSource source(path_, {}); });
  }
  std::string errorOfCamera(const RawStereoCamera& camera, bool swap_images = false) {
    {
      RawlogSink sink(path_, ImageStorage::kEmbedded);
      const auto [left, right] = test::wall(0);
      if (swap_images) sink.writeStereo(1.0, right, left, camera);
      if (!swap_images) sink.writeStereo(1.0, left, right, camera);
    }
    return errorOfFile();
  }

  headway::test::TemporaryFolder folder_;
  std::string path_ = folder_ / "x.rawlog";
};

TEST_F(BadRawlogTest, NamesAMissingFile) {
  path_ = folder_ / "nowhere.rawlog";
  EXPECT_THAT(errorOfFile(), AllOf(HasSubstr("nowhere.rawlog"), HasSubstr("No such file")));
  path_ = folder_.path();
  EXPECT_THAT(errorOfFile(), HasSubstr("is a folder"));
}

TEST_F(BadRawlogTest, EmptyAndForeignFilesAreNotRawlogs) {
  EXPECT_THAT(errorOfContent(""), HasSubstr("x.rawlog: is empty"));
  EXPECT_THAT(errorOfContent("hello"), HasSubstr("is not a rawlog"));
  EXPECT_THAT(errorOfContent("\x89PNG\r\n\x1a\n and more of it"), HasSubstr("is not a rawlog"));
  EXPECT_THAT(errorOfContent("\x1f\x8b broken gz"), HasSubstr("is not a rawlog"));
  EXPECT_THAT(errorOfContent(std::string("\x28\xB5\x2F\xFD", 4) + "rest"),
              HasSubstr("is not a rawlog"));
}

TEST_F(BadRawlogTest, RefusesRandomBytes) {
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    std::string bytes(1 + random() % 5000, '\0');
    for (auto& byte : bytes) byte = static_cast<char>(random());
    EXPECT_NE("no error", errorOfContent(bytes)) << trial;
  }
}

TEST_F(BadRawlogTest, MessagesAreOneLine) {
  EXPECT_THAT(errorOfContent("\x9fmrpt::obs::CObservationOdometry and rubbish"),
              Not(HasSubstr("\n")));
  EXPECT_THAT(errorOfContent("\x9fmrpt::obs::CObservationOdometry\x02 and rubbish"),
              Not(HasSubstr("\n")));
}

TEST_F(BadRawlogTest, ListsTheContentOfARawlogWithoutStereo) {
  auto comment = mrpt::obs::CObservationComment::Create();
  test::writeObjects(path_, {comment, test::singleImage(0, 0, 1.0, "webcam")});
  EXPECT_THAT(errorOfFile(), AllOf(HasSubstr("neither stereo images nor poses"),
                                   HasSubstr("'CObservationComment'"), HasSubstr("'webcam'")));
}

/// Whatever the byte at which a file ends, what is whole before it comes out, unharmed.
void expectWholeFramesBeforeEveryCut(const std::string& path, const std::string& whole) {
  std::size_t most = 0;
  for (std::size_t size = 1; size < whole.size(); size += 1 + whole.size() / 61) {
    test::writeContent(path, whole.substr(0, size));
    try {
      RawlogSource source(path, {});
      const auto frames = test::framesOf(source);
      ASSERT_GE(frames.size(), 1u);
      EXPECT_GE(frames.size(), most);
      most = std::max(most, frames.size());
      for (const auto& frame : frames) {
        ASSERT_TRUE(
            test::sameImage(test::wall(static_cast<int>(frame.index)).left, frame.stereo->left));
      }
      if (frames.size() < 4) {
        // A plain file cut exactly between two objects cannot be told from a whole one.
        const bool is_plain = whole[0] != '\x1f';
        EXPECT_TRUE(source.truncation() || is_plain) << size;
        if (source.truncation()) {
          EXPECT_THAT(*source.truncation(), AllOf(HasSubstr("x.rawlog: truncated after"),
                                                  HasSubstr("byte"), Not(HasSubstr("\n"))));
        }
      }
    } catch (const InputError& error) {
      EXPECT_EQ(0u, most) << size << ": " << error.what();
    }
  }
  EXPECT_GE(most, 3u);
}

TEST_F(BadRawlogTest, ReadsTheCompletePartOfATruncatedCompressedFile) {
  test::recordWalls(path_, 4);
  expectWholeFramesBeforeEveryCut(path_, test::contentOf(path_));
}

TEST_F(BadRawlogTest, ReadsTheCompletePartOfATruncatedPlainFile) {
  std::vector<mrpt::serialization::CSerializable::Ptr> objects;
  for (int i = 0; i < 4; ++i) objects.push_back(test::wallObservation(i, test::frameTime(i)));
  test::writeObjects(path_, objects, false);
  expectWholeFramesBeforeEveryCut(path_, test::contentOf(path_));
}

TEST_F(BadRawlogTest, ReadsTheCompletePartOfTruncatedSensoryFrames) {
  std::vector<mrpt::serialization::CSerializable::Ptr> objects;
  for (int i = 0; i < 4; ++i) {
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(test::wallObservation(i, test::frameTime(i)));
    objects.push_back(frame);
  }
  test::writeObjects(path_, objects, false);
  expectWholeFramesBeforeEveryCut(path_, test::contentOf(path_));
}

TEST_F(BadRawlogTest, ReportsTruncationWithinASensoryFrame) {
  auto frame = mrpt::obs::CSensoryFrame::Create();
  frame->insert(test::wallObservation(0, test::frameTime(0)));
  test::writeObjects(path_, {frame}, false);
  const std::string whole = test::contentOf(path_);
  test::writeContent(path_, whole.substr(0, whole.size() - 1));  // its end mark is missing
  RawlogSource source(path_, {});
  EXPECT_EQ(1u, test::framesOf(source).size());
  ASSERT_TRUE(source.truncation());
  EXPECT_THAT(*source.truncation(), HasSubstr("sensory frame"));
}

TEST_F(BadRawlogTest, SurvivesFlippedBytes) {
  test::recordWalls(path_, 2);
  std::vector<mrpt::serialization::CSerializable::Ptr> objects;
  for (int i = 0; i < 2; ++i) objects.push_back(test::wallObservation(i, test::frameTime(i)));
  test::writeObjects(path_, objects, false);
  const std::string whole = test::contentOf(path_);
  std::mt19937 random(3);
  std::size_t read = 0;
  for (int trial = 0; trial < 100; ++trial) {
    std::string bytes = whole;
    // In the first bytes lie the lengths and sizes that do most harm; most others are pixels.
    const std::size_t range = trial % 2 == 0 ? 200 : bytes.size();
    bytes[random() % range] = static_cast<char>(random());
    test::writeContent(path_, bytes);
    try {
      read += test::framesOf(path_).size();
    } catch (const InputError&) {
    }
  }
  EXPECT_GT(read, 40u);
}

/// A rawlog with an object of an unknown class between two stereo pairs.
std::string withUnknownClass(const std::string& path, bool in_sensory_frame) {
  const auto objects = [&](int i) -> mrpt::serialization::CSerializable::Ptr {
    if (!in_sensory_frame) return test::wallObservation(i, test::frameTime(i));
    auto frame = mrpt::obs::CSensoryFrame::Create();
    frame->insert(test::wallObservation(i, test::frameTime(i)));
    return frame;
  };
  std::string content;
  for (int i = 0; i < 3; ++i) {
    test::writeObjects(path, {objects(i)}, false);
    std::string bytes = test::contentOf(path);
    const std::string unknown = std::string("\x93") + "acme::CThermalImage" + std::string(1, '\0') +
                                "pixels \x93 and mrpt::obs::C... \x88";
    if (in_sensory_frame) {
      bytes.insert(bytes.size() - 1, unknown);      // before the frame's end mark
      bytes[bytes.find("CSensoryFrame") + 14] = 2;  // objects in it
    } else {
      bytes += unknown;
    }
    content += bytes;
  }
  return content;
}

TEST_F(BadRawlogTest, SkipsAndCountsObjectsOfUnknownClasses) {
  for (const bool in_sensory_frame : {false, true}) {
    const std::string content = withUnknownClass(path_, in_sensory_frame);
    test::writeContent(path_, content);
    RawlogSource source(path_, {});
    const auto frames = test::framesOf(source);
    ASSERT_EQ(3u, frames.size()) << in_sensory_frame;
    EXPECT_TRUE(test::sameImage(test::wall(2).right, frames[2].stereo->right));
    EXPECT_THAT(source.skipped(), ::testing::ElementsAre(::testing::Pair("CThermalImage", 3u)));
  }
}

TEST_F(BadRawlogTest, ObservationsInsideAnObjectOfAnUnknownClassAreFound) {
  test::writeObjects(path_, {test::wallObservation(0, test::frameTime(0))}, false);
  const std::string first = test::contentOf(path_);
  test::writeObjects(path_, {test::wallObservation(1, test::frameTime(1))}, false);
  const std::string inner = test::contentOf(path_);
  const std::string head = std::string("\x93") + "acme::CThermalImage" + std::string(1, '\0');
  // What follows the inner object begins like a header, and a real one lies close behind.
  test::writeContent(path_, first + head + "pixels" + inner + "\x9f" + "tail\x88" + first + inner);
  RawlogSource source(path_, {});
  EXPECT_EQ(2u, test::framesOf(source).size());
  EXPECT_THAT(source.skipped(), ::testing::ElementsAre(::testing::Pair("CThermalImage", 1u),
                                                       ::testing::Pair("time_backwards", 2u)));
}

/// An image of a version that does not exist yet.
std::string newerImage(const std::string& path) {
  test::writeObjects(path, {test::singleImage(0, 0, 1.0, "newer")}, false);
  std::string newer = test::contentOf(path);
  newer[1 + std::string("mrpt::obs::CObservationImage").size()] = 99;
  return newer;
}

TEST_F(BadRawlogTest, AnUnreadableLastObjectIsCountedAndNotATruncation) {
  const std::string newer = newerImage(path_);
  test::writeObjects(path_, {test::wallObservation(0, test::frameTime(0))}, false);
  std::string content = test::contentOf(path_);
  for (int i = 0; i < 7; ++i) content += newer;
  test::writeContent(path_, content);
  RawlogSource source(path_, {});
  EXPECT_EQ(1u, test::framesOf(source).size());
  EXPECT_FALSE(source.truncation());
  EXPECT_EQ(7u, source.skipped().at("unreadable_CObservationImage_version_99"));
}

TEST_F(BadRawlogTest, SkipsAndCountsObjectsOfNewerVersionsAndUnusedClasses) {
  const std::string newer = newerImage(path_);
  test::writeObjects(path_, {test::wallObservation(0, test::frameTime(0))}, false);
  const std::string good = test::contentOf(path_);
  test::writeObjects(
      path_, {mrpt::obs::CObservationComment::Create(), test::wallObservation(1, test::frameTime(1))},
      false);
  test::writeContent(path_, good + newer + test::contentOf(path_));
  RawlogSource source(path_, {});
  EXPECT_EQ(2u, test::framesOf(source).size());
  EXPECT_FALSE(source.truncation());
  EXPECT_THAT(
      source.skipped(),
      ::testing::ElementsAre(::testing::Pair("CObservationComment", 1u),
                             ::testing::Pair("unreadable_CObservationImage_version_99", 1u)));
}

TEST_F(BadRawlogTest, RefusesInvalidCalibrationsWithTheReason) {
  const RawStereoCamera good = rawFrom(test::smallCamera());
  EXPECT_EQ("no error", errorOfCamera(good));
  const auto with = [&](auto change) {
    RawStereoCamera camera = good;
    change(camera);
    return errorOfCamera(camera);
  };
  EXPECT_THAT(with([](auto& c) { c.T_left_right.translation().x() = 0; }),
              AllOf(HasSubstr("x.rawlog: stereo calibration"), HasSubstr("baseline is zero")));
  EXPECT_THAT(with([](auto& c) { c.T_left_right.translation().x() = -0.2; }),
              HasSubstr("left and right are swapped"));
  EXPECT_THAT(with([](auto& c) { c.T_left_right.translation() << 0, 0.2, 0; }),
              HasSubstr("not displaced horizontally"));
  EXPECT_THAT(with([](auto& c) { c.T_left_right.translation().x() = NAN; }),
              HasSubstr("not finite"));
  EXPECT_THAT(with([](auto& c) { c.left.fx = 0; }), HasSubstr("left focal length fx is 0"));
  EXPECT_THAT(with([](auto& c) { c.right.fy = -100; }), HasSubstr("right focal length fy"));
  EXPECT_THAT(with([](auto& c) { c.left.cx = NAN; }), HasSubstr("principal point"));
  EXPECT_THAT(with([](auto& c) { c.left.cx = c.right.cx = 1e7; }), HasSubstr("far outside"));
  EXPECT_THAT(with([](auto& c) { c.T_robot_left.translation().z() = 1650; }),
              HasSubstr("check the unit (metres) of its pose"));
  EXPECT_THAT(with([](auto& c) { c.T_left_right.translation().x() = 1e9; }),
              HasSubstr("the baseline is 1e+09 m"));
  EXPECT_THAT(with([](auto& c) { c.left.width = c.right.width = 640; }),
              HasSubstr("for images of 640x120 px, but they have 160x120"));
  EXPECT_THAT(with([](auto& c) { c.right.width = 640; }), HasSubstr("differ in size"));
  for (const double focal_px : {1e-3, 1e6}) {
    EXPECT_THAT(with([&](auto& c) {
                  for (auto* lens : {&c.left, &c.right}) lens->fx = lens->fy = focal_px;
                }),
                HasSubstr("no lens of a robot's camera"));
  }
}

TEST_F(BadRawlogTest, DetectsSwappedImages) {
  EXPECT_THAT(errorOfCamera(rawFrom(test::smallCamera()), true),
              AllOf(HasSubstr("median disparity"), HasSubstr("-8.0"), HasSubstr("swapped")));
}

TEST_F(BadRawlogTest, FisheyeAndRationalLensesAreRectified) {
  auto observation = test::wallObservation(0, 1.0);
  observation->leftCamera.setDistortionKannalaBrandt(0.01, 0, 0, 0);
  test::writeObjects(path_, {observation});
  EXPECT_TRUE(RawlogSource(path_, {}).calibration()->rectified_here);
  observation->leftCamera.setDistortionPlumbBob(0.01, 0, 0, 0, 0);
  observation->leftCamera.dist[6] = 0.01;
  test::writeObjects(path_, {observation});
  EXPECT_TRUE(RawlogSource(path_, {}).calibration()->rectified_here);
  observation->leftCamera.dist[6] = std::nan("");
  test::writeObjects(path_, {observation});
  EXPECT_NE("", errorOfFile());
}

}  // namespace
}  // namespace headway::io
