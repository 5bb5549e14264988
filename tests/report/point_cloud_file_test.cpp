#include "point_cloud_file.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::report {
namespace {

class PointCloudFileTest : public ::testing::Test {
 protected:
  /// `count` announced, `written` there; point i is (i, 2 i, 3 i).
  std::string cloud(int count, int written, const std::string& format = "binary_little_endian") {
    const auto path = folder_ / "points.ply";
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat " << format << " 1.0\ncomment any\nelement vertex " << count
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float intensity\n"
         << "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n";
    for (int i = 0; i < written; ++i) {
      const float values[4] = {float(i), float(2 * i), float(3 * i), 0.5f};
      file.write(reinterpret_cast<const char*>(values), sizeof(values));
      file.write("rgb", 3);
    }
    return path;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(PointCloudFileTest, ReadsEveryPoint) {
  const auto points = readPoints(cloud(5, 5), 100);
  ASSERT_EQ(points.size(), 5u);
  EXPECT_EQ(points[4], Eigen::Vector3f(4, 8, 12));
}

TEST_F(PointCloudFileTest, TakesASampleOfMany) {
  const auto points = readPoints(cloud(1000, 1000), 300);
  EXPECT_LE(points.size(), 300u);
  EXPECT_GE(points.size(), 200u);
  EXPECT_EQ(points[1], Eigen::Vector3f(4, 8, 12));
}

TEST_F(PointCloudFileTest, HasNoPointsWhereThereAreNone) {
  EXPECT_TRUE(readPoints(cloud(0, 0), 100).empty());
}

TEST_F(PointCloudFileTest, SaysWhatIsWrong) {
  EXPECT_THROW((void)readPoints(cloud(5, 4), 100), InputError);
  EXPECT_THROW((void)readPoints(cloud(5, 5, "ascii"), 100), InputError);
  EXPECT_THROW((void)readPoints("/nonexistent.ply", 100), InputError);
}

}  // namespace
}  // namespace headway::report
