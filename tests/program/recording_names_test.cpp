// SPDX-License-Identifier: BSD-3-Clause
#include "recording_names.h"

#include <gmock/gmock.h>

namespace headway::replay {
namespace {

using testing::ElementsAre;

TEST(RecordingNamesTest, AreTheFilesUpToTheirKind) {
  EXPECT_THAT(recordingNames({"/data/monday.rawlog", "/data/tuesday.rawlog.zst"}),
              ElementsAre("monday", "tuesday"));
}

TEST(RecordingNamesTest, OfEqualFilesContainTheirFolders) {
  EXPECT_THAT(recordingNames({"/a/mon/r.rawlog", "/a/tue/r.rawlog", "/a/s.rawlog"}),
              ElementsAre("mon-r", "tue-r", "s"));
  EXPECT_THAT(recordingNames({"/a/s.rawlog", "/a/tue/r.rawlog", "/a/mon/r.rawlog"}),
              ElementsAre("s", "tue-r", "mon-r"))
      << "in any order";
  EXPECT_THAT(recordingNames({"/x/a/r.rawlog", "/y/a/r.rawlog"}), ElementsAre("x-a-r", "y-a-r"));
}

TEST(RecordingNamesTest, DifferFromTheNamesOfTheMap) {
  EXPECT_THAT(recordingNames({"/a/map.rawlog", "/a/unfinished.rawlog"}),
              ElementsAre("recording-map", "recording-unfinished"));
}

}  // namespace
}  // namespace headway::replay
