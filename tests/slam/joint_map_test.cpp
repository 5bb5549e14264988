// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/slam/joint_map.h>
#include <headway_test/textured_world.h>

#include <map>
#include <memory>
#include <utility>

#include "joint_sparse_map.h"

namespace headway::slam {
namespace {

using testing::ElementsAre;
using testing::SizeIs;

/// The way along a wall that is seen sideways: what one part of it shows, another does not.
Pose alongTheWall(int i) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.0, 0.0, 0.6 + 0.1 * std::sin(0.1 * i)});
  pose.translation() << 0.08 * i, 0.1 * std::sin(0.07 * i), 0.0;
  return pose;
}

/// A wall and a floor of four parts, each from another part of the texture.
test::TexturedWorld gallery(int seed) {
  test::TexturedWorld world(test::smallCamera(), seed);
  using V = Eigen::Vector3d;
  constexpr double kPart = 4.8;
  for (int part = 0; part < 4; ++part) {
    const double x = kPart * part - 2.0;
    const Eigen::Vector2d texture(part % 2 * 5.1, part / 2 * 5.1);
    world.boards.push_back({V(x, 3.0, -2.0), V::UnitX(), V::UnitZ(), kPart, 4.0, texture});
    world.boards.push_back({V(x, -1.5, -1.0), V::UnitY(), V::UnitX(), 4.5, kPart, texture});
  }
  return world;
}

constexpr int kSeed = 4;  ///< of the gallery; others are elsewhere

/// What is seen from a place of the way; rendered once for all tests.
StereoFrame seenFrom(int place, int seed) {
  static std::map<int, test::TexturedWorld> worlds;
  static std::map<std::pair<int, int>, StereoFrame> frames;
  const auto world =
      worlds.count(seed) > 0 ? worlds.find(seed) : worlds.emplace(seed, gallery(seed)).first;
  const auto [frame, is_new] = frames.try_emplace({seed, place});
  if (is_new) frame->second = world->second.frame(0, 0.0, alongTheWall(place));
  return frame->second;
}

/// One run: the frames of the way from one place up to another, in a frame of its own.
struct Drive {
  Drive(int first, int end, Time start, int seed = kSeed) : first_place(first) {
    SlamParams params;
    params.features = 300;
    slam =
        std::make_unique<StereoSlam>(std::make_shared<StereoCamera>(test::smallCamera()), params);
    for (int place = first; place < end; ++place) {
      StereoFrame frame = seenFrom(place, seed);
      frame.index = static_cast<std::size_t>(place - first);
      frame.time = start + 0.1 * static_cast<double>(frame.index);
      EXPECT_EQ(slam->process(frame, {}).status, TrackingStatus::kTracked) << place;
    }
    slam->finish();
  }

  /// Greatest distance to the true position, in the frame of the pose at a place [m].
  [[nodiscard]] double error(int origin) const {
    const Pose T_origin_world = alongTheWall(origin).inverse();
    double worst = 0.0;
    for (const auto& estimate : slam->trajectory()) {
      const Pose truth =
          T_origin_world * alongTheWall(first_place + static_cast<int>(estimate.frame));
      worst = std::max(worst, (estimate.T_map_robot.translation() - truth.translation()).norm());
    }
    return worst;
  }

  int first_place;
  std::unique_ptr<StereoSlam> slam;
};

/// Joins runs in an order and corrects each.
std::vector<JointMap> join(const std::vector<Drive*>& drives) {
  std::vector<const StereoSlam*> runs;
  for (const Drive* drive : drives) runs.push_back(drive->slam.get());
  auto maps = joinMaps(runs);
  for (const JointMap& map : maps) {
    for (const JointMember& member : map.members) drives[member.run]->slam->correct(member.poses);
  }
  return maps;
}

std::vector<std::size_t> runsOf(const JointMap& map) {
  std::vector<std::size_t> runs;
  for (const auto& member : map.members) runs.push_back(member.run);
  return runs;
}

constexpr double kMaxErrorM = 0.03;  ///< (0.01)

TEST(JointMapTest, RunsThatMeetHaveOneFrameWhoseOriginAloneDependsOnTheirOrder) {
  Drive first(0, 30, 0.0), second(18, 48, 100.0);
  const auto maps = join({&first, &second});
  ASSERT_THAT(maps, SizeIs(1));
  EXPECT_THAT(runsOf(maps[0]), ElementsAre(0, 1));
  EXPECT_GE(maps[0].links, 3U);
  EXPECT_LT(first.error(0), kMaxErrorM);
  EXPECT_LT(second.error(0), kMaxErrorM) << "without an alignment of its own";

  StereoSlam slam(std::make_shared<StereoCamera>(test::smallCamera()), {});
  slam.load(collected(maps[0].saved));
  for (const int place : {5, 44}) {
    StereoFrame frame = seenFrom(place, kSeed);
    frame.time = 300.0 + place;
    const auto update = slam.process(frame, {});
    ASSERT_EQ(update.status, TrackingStatus::kTracked) << "re-localised in the joint map";
    const Pose truth = alongTheWall(0).inverse() * alongTheWall(place);
    EXPECT_LT((update.T_map_robot.translation() - truth.translation()).norm(), kMaxErrorM);
  }

  Drive again_first(0, 30, 0.0), again_second(18, 48, 100.0);
  const auto backward = join({&again_second, &again_first});
  ASSERT_THAT(backward, SizeIs(1));
  EXPECT_EQ(backward[0].view.landmarks.size(), maps[0].view.landmarks.size());
  const auto path = second.slam->trajectory();
  const auto other = again_second.slam->trajectory();
  const Pose T_other_path = other[0].T_map_robot * path[0].T_map_robot.inverse();
  for (std::size_t i = 0; i < path.size(); ++i) {
    EXPECT_TRUE((T_other_path * path[i].T_map_robot).isApprox(other[i].T_map_robot, 1e-6)) << i;
  }
  EXPECT_LT(again_first.error(18), kMaxErrorM) << "in the frame of the run given first";
}

TEST(JointMapTest, RunsAreJoinedThroughOthersAndElsewhereStayApart) {
  Drive first(0, 40, 0.0), last(70, 110, 100.0), between(25, 85, 200.0);
  Drive elsewhere(0, 15, 300.0, 77);
  const auto maps = join({&first, &elsewhere, &last, &between});
  ASSERT_THAT(maps, SizeIs(2));
  EXPECT_THAT(runsOf(maps[0]), ElementsAre(0, 2, 3));
  EXPECT_THAT(runsOf(maps[1]), ElementsAre(1));
  EXPECT_EQ(maps[1].links, 0U);
  EXPECT_LT(first.error(0), kMaxErrorM);
  EXPECT_LT(last.error(0), 2.0 * kMaxErrorM);
  EXPECT_LT(elsewhere.error(0), kMaxErrorM) << "in its own frame";
}

TEST(JointMapTest, AnotherCameraIsRefused) {
  auto camera = test::smallCamera();
  camera.baseline_m *= 1.1;
  StereoSlam slam(std::make_shared<StereoCamera>(test::smallCamera()), {});
  StereoSlam other(std::make_shared<StereoCamera>(camera), {});
  EXPECT_THROW((void)joinMaps({&slam, &other}), InputError);
}

/// Two maps of ten keyframes each, one metre apart, on the same line.
SeparateMaps twoLines() {
  SeparateMaps maps;
  for (int i = 0; i < 20; ++i) {
    Pose pose = Pose::Identity();
    pose.translation().z() = i % 10;
    maps.all.addKeyframe(static_cast<std::size_t>(i), i, pose);
  }
  maps.first = {KeyframeId{0}, KeyframeId{10}};
  return maps;
}

MapLink linkOf(int keyframe, int place, double sideways) {
  MapLink link{KeyframeId{keyframe}, KeyframeId{place}, Pose::Identity(), {}};
  link.T_place_keyframe.translation().x() = sideways;
  return link;
}

TEST(ConsistentLinksTest, ThoseThatNobodyConfirmsAreLeftOut) {
  const auto maps = twoLines();
  EXPECT_THAT(consistentLinks({linkOf(10, 0, 1.0), linkOf(11, 1, 1.0)}, maps), SizeIs(0));
  EXPECT_THAT(consistentLinks({linkOf(10, 0, 1.0), linkOf(11, 1, 1.0), linkOf(12, 2, 1.1)}, maps),
              SizeIs(3));
}

TEST(ConsistentLinksTest, OfContradictingGroupsTheLargerOneRemains) {
  const auto maps = twoLines();
  const auto links = consistentLinks(
      {linkOf(10, 0, 1.0), linkOf(11, 1, 1.0), linkOf(12, 2, 1.0), linkOf(13, 3, 1.0),
       linkOf(14, 4, 9.0), linkOf(15, 5, 9.0), linkOf(16, 6, 9.0)},
      maps);
  ASSERT_THAT(links, SizeIs(4));
  for (const auto& link : links) EXPECT_EQ(link.T_place_keyframe.translation().x(), 1.0);
}

}  // namespace
}  // namespace headway::slam
