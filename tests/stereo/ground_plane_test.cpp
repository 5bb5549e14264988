#include <gtest/gtest.h>
#include <headway/stereo/ground_plane.h>

#include <cmath>

namespace headway::stereo {
namespace {

StereoCamera testCamera() {
  StereoCamera camera;
  camera.width = 620;
  camera.height = 240;
  camera.fx = camera.fy = 360.0;
  camera.cx = 309.5;
  camera.cy = 100.0;
  camera.baseline_m = 0.54;
  return camera;
}

/// Disparities of a plane below the camera, pitched, with a wall at 30 m.
DisparityImage street(const StereoCamera& camera, double height, double pitch) {
  DisparityImage image;
  image.reduce = 2;
  image.values = cv::Mat(camera.height / 2, camera.width / 2, CV_32F, cv::Scalar(0));
  const double fb = camera.fx * camera.baseline_m;
  for (int row = 0; row < image.values.rows; ++row) {
    const double y = (image.pixelOf(row) - camera.cy) / camera.fy;
    const double down = y * std::cos(pitch) + std::sin(pitch);
    const double depth = down > 0.0 ? std::min(30.0, height / down) : 30.0;
    image.values.row(row).setTo(fb / depth);
  }
  return image;
}

TEST(FindGroundTest, FindsHeightAndPitchOfTheCamera) {
  const auto camera = testCamera();
  for (const double pitch : {-0.05, 0.0, 0.08}) {
    const auto ground = findGround(street(camera, 1.6, pitch), camera, std::nullopt);
    ASSERT_TRUE(ground);
    EXPECT_NEAR(ground->camera_height, 1.6, 0.05);
    EXPECT_NEAR(ground->up.y(), -std::cos(pitch), 0.01);
    EXPECT_NEAR(ground->up.z(), -std::sin(pitch), 0.02);
  }
}

TEST(FindGroundTest, AWallIsNoGround) {
  const auto camera = testCamera();
  DisparityImage wall = street(camera, 1.6, 0.0);
  wall.values.setTo(camera.fx * camera.baseline_m / 10.0);
  EXPECT_FALSE(findGround(wall, camera, std::nullopt));
  wall.values.setTo(0.0F);
  EXPECT_FALSE(findGround(wall, camera, std::nullopt));
}

}  // namespace
}  // namespace headway::stereo
