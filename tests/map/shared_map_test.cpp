// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/map/map_query.h>
#include <headway/map/shared_map.h>

#include <atomic>
#include <thread>

#include "example_world.h"

namespace headway::map {
namespace {

TEST(SharedMapTest, SnapshotsDoNotChangeWithTheMap) {
  SharedMap shared;
  EXPECT_TRUE(shared.snapshot()->layers().isEmpty());
  PerceptionMap map;
  map.update(exampleStaticMap(25));
  map.update(1.0, {exampleTrack(1, ObjectClass::kCar, {1, 2, 3}, 0.0)});
  shared.publish(map);
  const auto before = shared.snapshot();
  map.update(2.0, {});
  shared.publish(map);
  EXPECT_EQ(before->movingObjects().time(), 1.0);
  EXPECT_EQ(before->movingObjects().tracks().size(), 1u);
  EXPECT_EQ(shared.snapshot()->movingObjects().time(), 2.0);
  shared.reset();
  EXPECT_EQ(shared.snapshot()->at(2.0).status(), QueryStatus::kEmptyMap);
  EXPECT_EQ(before->landmarks().size(), 25u);
}

TEST(SharedMapTest, ReadersGetCompleteMapsDuringWrites) {
  SharedMap shared;
  std::atomic<bool> done{false};
  // Frame k has k % 7 tracks and, since the last keyframe, as many landmarks as its tens.
  std::thread writer([&] {
    PerceptionMap map;
    for (int k = 1; k <= 400; ++k) {
      if (k % 10 == 0) map.update(exampleStaticMap(k));
      std::vector<Track> tracks;
      for (int i = 0; i < k % 7; ++i) {
        tracks.push_back(exampleTrack(k, ObjectClass::kCar, {1.0 * k, 2.0, 0.75}, 0.0));
      }
      map.update(k, std::move(tracks));
      if (k % 50 == 25) {
        shared.reset();
      } else {
        shared.publish(map);
      }
    }
    done = true;
  });
  const auto read = [&] {
    Time latest = 0.0;
    while (!done) {
      const auto map = shared.snapshot();
      const Time time = map->movingObjects().time();
      if (map->layers().isEmpty()) {
        EXPECT_EQ(map->at(time).status(), QueryStatus::kEmptyMap);
        continue;
      }
      EXPECT_GE(time, latest) << "maps come in order";
      latest = time;
      const int k = static_cast<int>(time);
      ASSERT_EQ(map->movingObjects().tracks().size(), static_cast<std::size_t>(k % 7));
      EXPECT_EQ(map->landmarks().size(), static_cast<std::size_t>(k / 10 * 10));
      EXPECT_EQ(map->staticMap()->landmarks.size(), map->landmarks().size());
      EXPECT_TRUE(k < 10 ||
                  map->landmarks().boundingBox().max.x == static_cast<float>(k / 10 * 10 - 1));
      for (const auto& track : map->movingObjects().tracks()) ASSERT_EQ(track.id, TrackId{k});
      const auto obstacles = map->at(time).obstaclesAt(time + 1.0);
      EXPECT_EQ(obstacles.items.size(), 2u * static_cast<std::size_t>(k % 7));
    }
  };
  std::thread reader(read);
  read();
  reader.join();
  writer.join();
}

}  // namespace
}  // namespace headway::map
