// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::io {
namespace {

std::vector<Stamped<Pose>> wavyPath() {
  std::vector<Stamped<Pose>> path;
  for (int i = 0; i < 20; ++i) {
    Pose pose = Pose::Identity();
    pose.linear() = expSo3({0.1 * i, -0.2 * i, 0.3 * i});
    pose.translation() << 1.0 * i, -2.5 * i, 0.01 * i;
    path.push_back({1403636584.763555 + 0.05 * i, pose});
  }
  return path;
}

std::string written(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path) << text;
  return path.string();
}

TEST(TrajectoryFileTest, TumSurvivesTheRoundTrip) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "path.tum";
  const auto expected = wavyPath();
  writeTum(path, expected);
  const auto read = readTum(path);
  ASSERT_EQ(expected.size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_NEAR(expected[i].time, read[i].time, 1e-6);
    EXPECT_TRUE(expected[i].value.isApprox(read[i].value, 1e-8)) << i;
  }
}

TEST(TrajectoryFileTest, KittiSurvivesTheRoundTrip) {
  const test::TemporaryFolder folder;
  const std::string path = folder / "path.txt";
  std::vector<Pose> expected;
  for (const auto& stamped : wavyPath()) expected.push_back(stamped.value);
  writeKittiPoses(path, expected);
  const auto read = readKittiPoses(path);
  ASSERT_EQ(expected.size(), read.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_TRUE(expected[i].isApprox(read[i], 1e-11)) << i;
  }
}

TEST(TrajectoryFileTest, CommentsAndCommasAreAccepted) {
  const test::TemporaryFolder folder;
  const auto path = written(folder / "x.tum", "# t x y z\n\n1,2,3,4,0,0,0,1 # end\n");
  const auto read = readTum(path);
  ASSERT_EQ(1u, read.size());
  EXPECT_EQ(1.0, read[0].time);
  EXPECT_EQ(Eigen::Vector3d(2, 3, 4), read[0].value.translation());
}

TEST(TrajectoryFileTest, ErrorsNameFileAndLine) {
  const test::TemporaryFolder folder;
  const auto message = [&](const std::string& text) -> std::string {
    try {
      (void)readTum(written(folder / "bad.tum", text));
    } catch (const InputError& error) {
      return error.what();
    }
    return "accepted";
  };
  using ::testing::HasSubstr;
  EXPECT_THAT(message("0 0 0 0 0 0 0 1\n1 0 0\n"), HasSubstr("bad.tum:2: has 3 fields"));
  EXPECT_THAT(message("0 0 0 zero 0 0 0 1\n"), HasSubstr("'zero' in field 4 is not a number"));
  EXPECT_THAT(message("0 0 0 nan 0 0 0 1\n"), HasSubstr("not finite"));
  EXPECT_THAT(message("nan 0 0 0 0 0 0 1\n"), HasSubstr("time is not finite"));
  EXPECT_THAT(message("0 0 0 0 0 0 0 0\n"), HasSubstr("quaternion"));
  EXPECT_THROW((void)readTum(folder / "nowhere.tum"), InputError);
  EXPECT_THROW((void)readTum(folder.path()), InputError);
}

TEST(TrajectoryFileTest, RefusesAMatrixThatIsNoRotation) {
  const test::TemporaryFolder folder;
  const auto scaled = written(folder / "a.txt", "2 0 0 0 0 2 0 0 0 0 2 0\n");
  const auto mirrored = written(folder / "b.txt", "1 0 0 0 0 1 0 0 0 0 -1 0\n");
  EXPECT_THROW((void)readKittiPoses(scaled), InputError);
  EXPECT_THROW((void)readKittiPoses(mirrored), InputError);
}

TEST(TrajectoryFileTest, ThrowsForUnwritablePaths) {
  const test::TemporaryFolder folder;
  written(folder / "file", "x");
  EXPECT_THROW(writeTum(folder / "file/path.tum", {}), InputError);
  EXPECT_THROW(writeTum("/dev/full", wavyPath()), InputError);
  EXPECT_THROW(writeKittiPoses(folder / "nowhere/path.txt", {}), InputError);
}

TEST(TrajectoryFileTest, RealPosesAreRead) {
  HEADWAY_REQUIRE_DATA(data);
  EXPECT_EQ(51u, readKittiPoses(data / "kitti_odometry/poses/06.txt").size());
  EXPECT_GT(readTum(data / "euroc/MH_01_easy/groundtruth.tum").size(), 1000u);
}

}  // namespace
}  // namespace headway::io
