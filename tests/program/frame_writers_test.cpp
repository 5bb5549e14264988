// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/track_file.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>

#include <cmath>

#include "result_files.h"

namespace headway::replay {
namespace {

TEST(FrameWritersTest, BoxesThatAreNotFiniteAreNoRows) {
  const test::TemporaryFolder folder;
  pipeline::PerceptionUpdate update;
  update.detections.emplace();
  Detection good;
  good.box2d = Box2d{1, 2, 3, 4};
  good.box3d = Box3d{{1, 2, 10}, 4, 2, 1.5, 0};
  update.detections->items.assign(6, good);
  auto& items = update.detections->items;
  items[1].score = std::nan("");
  items[2].box2d->left = std::nan("");
  items[3].box3d->centre.z() = INFINITY;
  items[4].velocity = MeasuredVelocity{{NAN, 0, 0}, Eigen::Matrix3d::Identity()};
  FrameWriters writers(folder.path());
  writers.write(update, nullptr);
  writers.finish();
  std::map<std::string, std::size_t> dropped;
  EXPECT_EQ(2u, io::readDetections(folder / "detections.csv", dropped).at(0).items.size());
  EXPECT_TRUE(dropped.empty());
}

}  // namespace
}  // namespace headway::replay
