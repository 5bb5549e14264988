#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/drivers/observation_recorder.h>
#include <headway_test/folders.h>

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

TEST(ObservationRecorderTest, NamesThePathThatCannotBeWritten) {
  EXPECT_THROW(ObservationRecorder("/no/such/folder/live.rawlog"), InputError);
}

}  // namespace
}  // namespace headway::drivers
