// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/drivers/observation_recorder.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <fstream>

#include "../io/foreign_recording.h"
#include "../io/synthetic_recording.h"

namespace headway::drivers {
namespace {

TEST(ObservationRecorderTest, RecordsWhatItIsGiven) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "live.rawlog";
  ObservationRecorder recorder(path);
  for (int i = 0; i < 5; ++i) {
    recorder.write(io::test::wallObservation(i, io::test::frameTime(i)));
  }
  recorder.close();
  EXPECT_EQ(recorder.dropped(), 0u);
  const auto frames = io::test::framesOf(path);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_TRUE(io::test::sameImage(frames[4].stereo->left, io::test::wall(4).left));
}

TEST(ObservationRecorderTest, AnOlderFileRemainsUntilTheNewOneIsComplete) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "live.rawlog";
  std::ofstream(path) << "older";
  {
    ObservationRecorder killed(path);
    killed.write(io::test::wallObservation(0, io::test::frameTime(0)));
  }
  EXPECT_EQ(test::contentsOf(path), "older");
  ObservationRecorder recorder(path);
  recorder.write(io::test::wallObservation(0, io::test::frameTime(0)));
  recorder.close();
  EXPECT_EQ(io::test::framesOf(path).size(), 1u);
}

TEST(ObservationRecorderTest, NamesThePathThatCannotBeWritten) {
  EXPECT_THROW(ObservationRecorder("/no/such/folder/live.rawlog"), InputError);
}

}  // namespace
}  // namespace headway::drivers
