// SPDX-License-Identifier: BSD-3-Clause
// Folders of depth cameras: the TUM RGB-D benchmark, and images with depth.
#include <gmock/gmock.h>
#include <headway/io/dataset.h>
#include <headway/io/rawlog_source.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>

#include <opencv2/imgcodecs.hpp>

#include "processes.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

class DepthDatasetTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& content) {
    test::writeContent(folder_ / name, content);
  }
  void writePng(const std::string& name, const cv::Mat& image) {
    fs::create_directories((folder_ / name).parent_path());
    cv::imwrite(folder_ / name, image);
  }
  std::string at(const std::string& name) { return folder_ / name; }
  test::ProcessResult import(const std::string& arguments) {
    return test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-import " + arguments);
  }

  /// A sequence of images 0.1 s apart, with depth 5 ms later.
  void writeTum(const std::string& folder, int frames) {
    std::string images = "# color images\n", depths = "# depth maps\n", truth = "# ground truth\n";
    for (int i = 0; i < frames; ++i) {
      const std::string number = std::to_string(i);
      writePng(folder + "/rgb/" + number + ".png", test::wall(i, 8, {640, 480}).left);
      writePng(folder + "/depth/" + number + ".png",
               cv::Mat(480, 640, CV_16U, cv::Scalar(5000.0 * (1 + i))));
      const double time = 1305031102.0 + 0.1 * i;
      images += std::to_string(time) + " rgb/" + number + ".png\n";
      depths += std::to_string(time + 0.005) + " depth/" + number + ".png\n";
      // The camera looks along the world's x axis and moves along it.
      truth += std::to_string(time) + " " + number + ".0 0 1.5 -0.5 0.5 -0.5 0.5\n";
    }
    write(folder + "/rgb.txt", images);
    write(folder + "/depth.txt", depths);
    write(folder + "/groundtruth.txt", truth);
  }

  headway::test::TemporaryFolder folder_;
};

TEST_F(DepthDatasetTest, ATumSequenceIsPairedByTime) {
  writeTum("rgbd_dataset_freiburg3_hall", 4);
  const auto dataset = openTumRgbd(at("rgbd_dataset_freiburg3_hall"), "");
  ASSERT_EQ(4u, dataset->size());
  const DatasetFrame frame = dataset->frame(2);
  EXPECT_NEAR(1305031102.2, frame.time, 1e-6);
  EXPECT_TRUE(test::sameImage(test::wall(2, 8, {640, 480}).left, frame.left));
  EXPECT_EQ(15000, frame.depth.at<std::uint16_t>(7, 7));
  ASSERT_TRUE(frame.truth_T_map_robot);
  // The robot has its axes at the camera: x forward.
  Pose expected = Pose::Identity();
  expected.translation() = Eigen::Vector3d(2.0, 0.0, 1.5);
  EXPECT_LT((frame.truth_T_map_robot->matrix() - expected.matrix()).norm(), 1e-6);
  const auto camera = dataset->depthCamera();
  ASSERT_TRUE(camera);
  EXPECT_EQ(535.4, camera->color.fx);
  EXPECT_EQ(0.0002, camera->metres_per_unit);
  EXPECT_TRUE(dataset->dropped().empty());
}

TEST_F(DepthDatasetTest, EachOfTumsCamerasHasItsLens) {
  const std::map<std::string, double> focal = {
      {"freiburg1_x", 517.306408}, {"freiburg2_x", 520.908620}, {"freiburg3_x", 535.4}, {"x", 525}};
  for (const auto& [name, fx] : focal) {
    writeTum(name, 1);
    EXPECT_EQ(fx, openTumRgbd(at(name), "")->depthCamera()->color.fx) << name;
  }
}

TEST_F(DepthDatasetTest, ImagesWithoutDepthAreCounted) {
  writeTum("t", 4);
  write("t/depth.txt",
        "1305031102.030 depth/0.png\n1305031102.110 depth/1.png\n1305031102.190 depth/2.png\n"
        "1305031102.205 depth/3.png\n");
  const auto dataset = openTumRgbd(at("t"), "");
  EXPECT_EQ(2u, dataset->size());
  EXPECT_EQ((std::map<std::string, std::size_t>{{"no_depth", 2}}), dataset->dropped());
  EXPECT_EQ(20000, dataset->frame(1).depth.at<std::uint16_t>(0, 0)) << "the nearest";
  write("t/depth.txt", "7.0 depth/0.png\n");
  EXPECT_THAT(test::errorOf([&] { (void)openTumRgbd(at("t"), ""); }),
              HasSubstr("no image of rgb.txt has a depth image within 0.02 s"));
}

TEST_F(DepthDatasetTest, PartOfASequenceCountsWhatIsMissingInIt) {
  writeTum("t", 6);
  write("t/depth.txt",
        "1305031102.005 depth/0.png\n1305031102.205 depth/2.png\n1305031102.305 depth/3.png\n");
  const std::string call = "tum-rgbd " + at("t") + " -w -o " + at("x.rawlog");
  EXPECT_THAT(import(call).output, HasSubstr("x.rawlog: 3 frames, skipped no_depth 3\n"));
  EXPECT_THAT(import(call + " --to-index 1").output, HasSubstr(": 2 frames, skipped no_depth 1\n"));
  EXPECT_THAT(import(call + " --to-index 0").output, HasSubstr(": 1 frames\n"));
  EXPECT_THAT(import(call + " --from-index 2").output,
              HasSubstr(": 1 frames, skipped no_depth 2\n"));
  EXPECT_EQ(2, import(call + " --from-index 2 --to-index 1").status);
}

TEST_F(DepthDatasetTest, TheAccelerometerOfATumSequenceIsInertialData) {
  writeTum("t", 3);
  // The first sample of freiburg1_desk, whose camera looks 43 degrees down.
  std::string rows = "# timestamp ax ay az\n";
  for (int i = 0; i < 30; ++i) {
    rows += std::to_string(1305031101.9 + 0.01 * i) + " -0.083818 7.244229 -6.657506\n";
  }
  write("t/accelerometer.txt", rows);
  const auto samples = openTumRgbd(at("t"), "")->inertial();
  ASSERT_EQ(30u, samples.size());
  EXPECT_FALSE(samples[0].angular_velocity);
  EXPECT_NEAR(1305031101.9, samples[0].time, 1e-6);
  const Eigen::Vector3d expected(-6.657506, -0.083818, 7.244229);  // robot: forward, left, up
  EXPECT_LT((samples[0].acceleration - expected).norm(), 1e-9) << samples[0].acceleration;
  ASSERT_EQ(0, import("tum-rgbd " + at("t") + " -o " + at("x.rawlog")).status);
  RawlogSource source(at("x.rawlog"), {});
  const auto frame = source.next();
  ASSERT_TRUE(frame && frame->stereo);
  ASSERT_TRUE(frame->stereo->motion_prior.specific_force);
  EXPECT_LT((*frame->stereo->motion_prior.specific_force - expected).norm(), 1e-6);
  EXPECT_FALSE(frame->stereo->motion_prior.velocity_increment);
  write("t/accelerometer.txt", "1305031102.0 0 9.8\n");
  EXPECT_THAT(test::errorOf([&] { (void)openTumRgbd(at("t"), ""); }),
              HasSubstr("accelerometer.txt:1"));
}

TEST_F(DepthDatasetTest, TumFoldersOfLinksAreReadAndPointersAreNamed) {
  writeTum("t", 2);
  fs::rename(folder_ / "t/rgb", folder_ / "elsewhere");
  fs::create_directories(folder_ / "t/rgb");
  for (const char* name : {"0.png", "1.png"}) {
    fs::create_symlink(folder_ / "elsewhere" / name, folder_ / "t/rgb" / name);
  }
  EXPECT_TRUE(
      test::sameImage(test::wall(1, 8, {640, 480}).left, openTumRgbd(at("t"), "")->frame(1).left));
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:1\nsize 9\n";
  for (const char* name : {"elsewhere/0.png", "t/depth/1.png", "x.rawlog"}) write(name, pointer);
  for (const std::size_t index : {0U, 1U}) {
    EXPECT_THAT(test::errorOf([&] { (void)openTumRgbd(at("t"), "")->frame(index); }),
                HasSubstr("is a Git-LFS pointer"));
  }
  EXPECT_THAT(test::errorOf([&] { RawlogSource source(at("x.rawlog"), {}); }),
              HasSubstr("x.rawlog: is a Git-LFS pointer"));
}

TEST_F(DepthDatasetTest, BrokenTumSequencesNameTheFile) {
  const auto message = [&] {
    return test::errorOf([&] { (void)openTumRgbd(at("t"), "")->frame(0); });
  };
  EXPECT_THAT(message(), HasSubstr("rgb.txt"));
  writeTum("t", 2);
  write("t/rgb.txt", "1305031102.0\n");
  EXPECT_THAT(message(), HasSubstr("rgb.txt:1"));
  write("t/rgb.txt", "1305031102.0 ../../etc/passwd\n");
  EXPECT_THAT(message(), AllOf(HasSubstr("rgb.txt:1"), HasSubstr("outside of the folder")));
  write("t/rgb.txt", "soon rgb/0.png\n");
  EXPECT_THAT(message(), HasSubstr("rgb.txt:1"));
  writeTum("t", 2);
  writePng("t/depth/0.png", cv::Mat(480, 640, CV_8U, cv::Scalar(9)));
  EXPECT_THAT(message(), AllOf(HasSubstr("depth/0.png"), HasSubstr("16 bits")));
  writePng("t/depth/0.png", cv::Mat(48, 64, CV_16U, cv::Scalar(9)));
  EXPECT_THAT(message(), AllOf(HasSubstr("has 64x48 px"), HasSubstr("640x480")));
  write("t/depth/0.png", test::contentOf(at("t/depth/1.png")).substr(0, 60));
  EXPECT_THAT(message(), HasSubstr("depth/0.png"));
  fs::remove(folder_ / "t/rgb/0.png");
  EXPECT_THAT(message(), HasSubstr("rgb/0.png"));
}

constexpr char kCalibration[] =
    "image_size: [160, 120]\nleft: [100, 100, 80, 60]\ndepth_unit_m: 0.0005\n"
    "depth_range_m: 6\nframe_rate_hz: 20\n";

TEST_F(DepthDatasetTest, ImagesWithDepthArePairedByTheOrderOfNames) {
  for (int i = 0; i < 3; ++i) {
    writePng("l/" + std::to_string(i) + ".png", test::colourWall(i).left);
    writePng("d/" + std::to_string(i) + ".png", cv::Mat(120, 160, CV_16U, cv::Scalar(1000 + i)));
  }
  write("c.yaml", kCalibration);
  const auto dataset = openDepthFolders(at("l"), at("d"), at("c.yaml"));
  ASSERT_EQ(3u, dataset->size());
  EXPECT_EQ(0.1, dataset->frame(2).time);
  EXPECT_EQ(1002, dataset->frame(2).depth.at<std::uint16_t>(5, 5));
  EXPECT_EQ(0.0005, dataset->depthCamera()->metres_per_unit);
  EXPECT_EQ(6.0, dataset->depthCamera()->max_range_m);
  fs::remove(folder_ / "d/0.png");
  EXPECT_THAT(test::errorOf([&] { (void)openDepthFolders(at("l"), at("d"), at("c.yaml")); }),
              HasSubstr("must contain the same number"));
}

TEST_F(DepthDatasetTest, CalibrationsOfDepthCamerasNameTheKey) {
  writePng("l/0.png", test::wall(0).left);
  writePng("d/0.png", cv::Mat(120, 160, CV_16U, cv::Scalar(1000)));
  const auto with = [&](const std::string& more) {
    write("c.yaml", kCalibration + more);
    return test::errorOf([&] { (void)openDepthFolders(at("l"), at("d"), at("c.yaml")); });
  };
  EXPECT_EQ("no error", with("depth: [50, 50, 40, 30]\ndepth_size: [80, 60]\n"));
  EXPECT_EQ("no error", with("range_is_depth: false\n"));
  EXPECT_THAT(with("baseline_m: 0.1\n"), HasSubstr("baseline_m"));
  EXPECT_THAT(with("depth_size: [80, 60]\n"), HasSubstr("needs the key 'depth'"));
  EXPECT_THAT(with("depth: [0, 50, 40, 30]\n"), HasSubstr("depth"));
  EXPECT_THAT(with("range_is_depth: maybe\n"), HasSubstr("must be true or false"));
  EXPECT_THAT(with("T_left_depth: [1,0,0,50, 0,1,0,0, 0,0,1,0]\n"), HasSubstr("in metres?"));
  write("c.yaml", "image_size: [160, 120]\nleft: [100, 100, 80, 60]\ndepth_unit_m: 5000\n");
  EXPECT_THAT(test::errorOf([&] { (void)openDepthFolders(at("l"), at("d"), at("c.yaml")); }),
              HasSubstr("rangeUnits"));
}

TEST_F(DepthDatasetTest, TheImporterWritesRawlogsOfDepthCameras) {
  writeTum("freiburg3", 3);
  const auto tum = import("tum-rgbd " + at("freiburg3") + " -o " + at("tum.rawlog"));
  EXPECT_EQ(0, tum.status) << tum.output;
  RawlogSource source(at("tum.rawlog"), {});
  EXPECT_TRUE(source.camera()->isDepthCamera());
  const auto frames = test::framesOf(source);
  ASSERT_EQ(3u, frames.size());
  const auto& camera = *source.camera();
  const float fb = static_cast<float>(camera.fx * camera.baseline_m);
  EXPECT_NEAR(fb / 3.0F, frames[2].stereo->disparity.at<float>(100, 100), 1e-3);
  EXPECT_EQ(3u, readTruth(at("tum.rawlog")).poses.size());

  writePng("l/0.png", test::wall(0).left);
  writePng("d/0.png", cv::Mat(120, 160, CV_16U, cv::Scalar(4000)));
  write("c.yaml", kCalibration);
  const std::string images =
      "images --left " + at("l") + " --calibration " + at("c.yaml") + " -o " + at("i.rawlog");
  EXPECT_EQ(2, import(images).status);
  EXPECT_EQ(2, import(images + " --right " + at("l") + " --depth " + at("d")).status);
  EXPECT_EQ(0, import(images + " --depth " + at("d")).status);
  EXPECT_EQ(1u, test::framesOf(at("i.rawlog")).size());
  const auto exported =
      test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-export kitti-odometry " +
                       at("i.rawlog") + " -o " + at("kitti"));
  EXPECT_EQ(1, exported.status);
  EXPECT_THAT(exported.output, HasSubstr("depth camera"));
}

}  // namespace
}  // namespace headway::io
