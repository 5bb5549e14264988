// SPDX-License-Identifier: BSD-3-Clause
#include "frame_tracker.h"

#include <gtest/gtest.h>
#include <headway_test/textured_world.h>

#include <algorithm>

namespace headway::slam {
namespace {

/// As many landmarks as asked for, seen by one keyframe.
std::vector<TrackedLandmark> landmarksIn(SparseMap& map, std::size_t count) {
  const KeyframeId keyframe = map.addKeyframe(0, 0.0, Pose::Identity()).id;
  std::vector<TrackedLandmark> seen(count);
  for (std::size_t i = 0; i < count; ++i) {
    seen[i].measurement.uv.x() = static_cast<double>(i);
    seen[i].id = map.addLandmark(Eigen::Vector3d::UnitZ(), keyframe, seen[i].measurement).id;
  }
  return seen;
}

TEST(FrameTrackerTest, FollowsAsManyLandmarksAsThereAreUpToALimit) {
  SlamParams params;
  params.dynamic_rejection = DynamicRejection::kNone;  // all count as static
  const FrameTracker tracker(test::smallCamera(), params);
  for (const std::size_t count : {100u, 159u, 160u, 161u, 200u, 319u, 320u, 321u, 1000u}) {
    SparseMap map;
    const auto seen = landmarksIn(map, count);
    const auto followed = tracker.selectLandmarksToFollow(seen, false, map);
    ASSERT_EQ(followed.size(), std::min<std::size_t>(count, 160)) << count;
    const double step = static_cast<double>(count) / static_cast<double>(followed.size());
    for (std::size_t i = 0; i < followed.size(); ++i) {
      EXPECT_NEAR(followed[i].measurement.uv.x(), step * static_cast<double>(i), 1.0) << count;
    }
  }
}

}  // namespace
}  // namespace headway::slam
