// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/drivers/observation_recorder.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <headway_test/small_disk.h>
#include <headway_test/waiting.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <fstream>
#include <mutex>

#include "../io/foreign_recording.h"
#include "../io/synthetic_recording.h"

namespace headway::drivers {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Collects what the recorder says.
class ObservationRecorderTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> messages() const {
    const std::lock_guard lock(mutex_);
    return messages_;
  }

  const ObservationRecorder::MessageCallback say_ = [this](const std::string& text) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(text);
  };

 private:
  mutable std::mutex mutex_;
  std::vector<std::string> messages_;
};

TEST_F(ObservationRecorderTest, RecordsWhatItIsGiven) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "live.rawlog";
  ObservationRecorder recorder(path, say_);
  for (int i = 0; i < 5; ++i) {
    recorder.write(io::test::wallObservation(i, io::test::frameTime(i)));
  }
  recorder.close();
  EXPECT_EQ(recorder.dropped(), 0u);
  const auto frames = io::test::framesOf(path);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_TRUE(io::test::sameImage(frames[4].stereo->left, io::test::wall(4).left));
}

TEST_F(ObservationRecorderTest, AnOlderFileRemainsUntilTheNewOneIsClosed) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "live.rawlog";
  std::ofstream(path) << "older";
  {
    ObservationRecorder killed(path, say_);
    killed.write(io::test::wallObservation(0, io::test::frameTime(0)));
  }
  EXPECT_EQ(test::contentsOf(path), "older");
  ObservationRecorder empty(path, say_);
  empty.close();
  EXPECT_EQ(test::contentsOf(path), "older") << "nothing was recorded";
  ObservationRecorder recorder(path, say_);
  recorder.write(io::test::wallObservation(0, io::test::frameTime(0)));
  recorder.close();
  recorder.write(io::test::wallObservation(1, io::test::frameTime(1)));
  recorder.close();
  EXPECT_EQ(io::test::framesOf(path).size(), 1u);
  EXPECT_THAT(messages(), ElementsAre());
}

TEST_F(ObservationRecorderTest, SaysAtOnceThatTheDiskIsFullAndKeepsWhatItHas) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "live.rawlog";
  std::ofstream(path) << "older";
  const test::SmallDisk disk(200000);
  ObservationRecorder recorder(path, say_);
  int written = 0;
  EXPECT_TRUE(test::waitUntil([&] {
    recorder.write(io::test::wallObservation(written, io::test::frameTime(written)));
    ++written;
    return !messages().empty();
  }));
  EXPECT_THAT(messages(), ElementsAre(HasSubstr("live.rawlog: write error; check the disk")));
  EXPECT_THROW(recorder.close(), InputError);
  EXPECT_GE(io::test::framesOf(path).size(), 1u);
}

TEST_F(ObservationRecorderTest, AnErrorOfTheFinalFlushIsOne) {
  ObservationRecorder recorder("/dev/full", say_);
  recorder.write(std::make_shared<mrpt::obs::CObservationOdometry>());
  EXPECT_THROW(recorder.close(), InputError);
}

TEST_F(ObservationRecorderTest, NamesThePathThatCannotBeWritten) {
  EXPECT_THROW(ObservationRecorder("/no/such/folder/live.rawlog", say_), InputError);
}

}  // namespace
}  // namespace headway::drivers
