// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/render/offscreen_renderer.h>
#include <mrpt/opengl/COpenGLScene.h>
#include <mrpt/opengl/CSetOfTriangles.h>

#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace headway::render {
namespace {

/// The face x = low.x() of a box, seen from -x.
mrpt::opengl::COpenGLScene sceneWithRedBox(const Eigen::Vector3d& low,
                                           const Eigen::Vector3d& high) {
  mrpt::opengl::COpenGLScene scene;
  scene.getViewport()->setCustomBackgroundColor({0.f, 0.f, 0.f});
  auto face = mrpt::opengl::CSetOfTriangles::Create();
  const auto corner = [&](double y, double z) {
    return mrpt::math::TPoint3Df(float(low.x()), float(y), float(z));
  };
  mrpt::opengl::TTriangle upper(corner(low.y(), low.z()), corner(low.y(), high.z()),
                                corner(high.y(), high.z()));
  mrpt::opengl::TTriangle lower(corner(low.y(), low.z()), corner(high.y(), high.z()),
                                corner(high.y(), low.z()));
  for (auto* triangle : {&upper, &lower}) {
    triangle->setColor(mrpt::img::TColor(255, 0, 0, 255));
    face->insertTriangle(*triangle);
  }
  face->enableLight(false);
  scene.insert(face);
  return scene;
}

PinholeView frontView(int width, int height) {
  return makeView(width, height, 1.0, lookAt({-10, 0, 0}, {0, 0, 0}));
}

cv::Rect extentOf(const cv::Mat& picture) {
  cv::Mat channels[3];
  cv::split(picture, channels);
  return cv::boundingRect(channels[2] > 100);
}

/// Where the near face (x = low) of a box from (-1,-1,-1)-like corners should appear.
void expectBoxAt(const cv::Mat& picture, const PinholeView& view, const Eigen::Vector3d& low,
                 const Eigen::Vector3d& high) {
  const auto top_left = project({low.x(), high.y(), high.z()}, view);
  const auto bottom_right = project({low.x(), low.y(), low.z()}, view);
  ASSERT_TRUE(top_left && bottom_right);
  const cv::Rect extent = extentOf(picture);
  EXPECT_NEAR(extent.x, top_left->x(), 1.0);
  EXPECT_NEAR(extent.y, top_left->y(), 1.0);
  EXPECT_NEAR(extent.x + extent.width - 1, bottom_right->x(), 1.0);
  EXPECT_NEAR(extent.y + extent.height - 1, bottom_right->y(), 1.0);
}

struct Size {
  int width, height, supersampling;
};
class OffscreenRendererSizesTest : public ::testing::TestWithParam<Size> {};

TEST_P(OffscreenRendererSizesTest, DrawARedBoxWhereItProjects) {
  const auto [width, height, supersampling] = GetParam();
  const Eigen::Vector3d low(0.0, 0.5, -1.0);
  const Eigen::Vector3d high(0.5, 2.0, 0.25);
  const auto scene = sceneWithRedBox(low, high);
  const auto view = frontView(width, height);
  OffscreenRenderer renderer(width, height, supersampling);
  const cv::Mat picture = renderer.draw(scene, view);
  ASSERT_EQ(picture.size(), cv::Size(width, height));
  ASSERT_EQ(picture.type(), CV_8UC3);
  expectBoxAt(picture, view, low, high);
  const auto inside = project({0.0, 1.25, -0.4}, view);
  EXPECT_EQ(picture.at<cv::Vec3b>(int(inside->y()), int(inside->x())), cv::Vec3b(0, 0, 255));
  EXPECT_EQ(picture.at<cv::Vec3b>(2, 2), cv::Vec3b(0, 0, 0));
}

INSTANTIATE_TEST_SUITE_P(AlsoOddOnes, OffscreenRendererSizesTest,
                         ::testing::Values(Size{640, 480, 1}, Size{637, 401, 1}, Size{318, 201, 2},
                                           Size{1241, 376, 1}, Size{101, 77, 3}));

TEST(OffscreenRendererTest, IsDeterministic) {
  const auto drawOnce = [] {
    OffscreenRenderer renderer(320, 240, 2);
    return renderer.draw(sceneWithRedBox({0, -1, -1}, {1, 1, 1}), frontView(320, 240));
  };
  const cv::Mat first = drawOnce();
  EXPECT_EQ(cv::norm(first, drawOnce(), cv::NORM_INF), 0.0);
}

TEST(OffscreenRendererTest, EarlierPicturesAreIndependent) {
  OffscreenRenderer renderer(320, 240);
  const auto view = frontView(320, 240);
  const cv::Mat with_box = renderer.draw(sceneWithRedBox({0, -1, -1}, {1, 1, 1}), view);
  const cv::Mat copy = with_box.clone();
  (void)renderer.draw(mrpt::opengl::COpenGLScene(), view);
  EXPECT_EQ(cv::norm(with_box, copy, cv::NORM_INF), 0.0);
}

TEST(OffscreenRendererDeathTest, NamesThePackagesWithoutOpenGl) {
  ::testing::FLAGS_gtest_death_test_style = "threadsafe";
  EXPECT_EXIT(
      {
        setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
        try {
          OffscreenRenderer renderer(64, 64);
        } catch (const RendererUnavailable& error) {
          std::fputs(error.what(), stderr);
          std::exit(7);
        }
        std::exit(0);
      },
      ::testing::ExitedWithCode(7), "install libegl1 and libgl1-mesa-dri");
}

}  // namespace
}  // namespace headway::render
