// SPDX-License-Identifier: BSD-3-Clause
// Calibrations as other programs write them: the same camera in each format.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/raw_camera.h>
#include <headway_test/folders.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/img/TStereoCamera.h>

#include <opencv2/core/eigen.hpp>
#include <opencv2/core/persistence.hpp>
#include <opencv2/imgcodecs.hpp>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

/// The camera that all files describe.
RawStereoCamera describedPair() {
  RawStereoCamera camera;
  camera.left.width = camera.right.width = 752;
  camera.left.height = camera.right.height = 480;
  camera.left.fx = 458.75;
  camera.left.fy = 457.25;
  camera.left.cx = 367.5;
  camera.left.cy = 248.5;
  camera.left.distortion = {-0.25, 0.0625, 0.0005, 0.00025, 0.0};
  camera.right = camera.left;
  camera.right.fx = 457.5;
  camera.right.cx = 380.25;
  camera.T_left_right.linear() = expSo3({0.0, 0.0, 0.01});
  camera.T_left_right.translation() << 0.11, 0.001, -0.002;
  return camera;
}

void expectSameLens(const RawCamera& expected, const RawCamera& lens) {
  EXPECT_EQ(expected.width, lens.width);
  EXPECT_EQ(expected.height, lens.height);
  EXPECT_NEAR(expected.fx, lens.fx, 1e-9);
  EXPECT_NEAR(expected.fy, lens.fy, 1e-9);
  EXPECT_NEAR(expected.cx, lens.cx, 1e-9);
  EXPECT_NEAR(expected.cy, lens.cy, 1e-9);
  EXPECT_EQ(expected.is_fisheye, lens.is_fisheye);
  for (int i = 0; i < 5; ++i) EXPECT_NEAR(expected.distortion[i], lens.distortion[i], 1e-9) << i;
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(expected.rational[i], lens.rational[i], 1e-9) << i;
}

void expectSameCamera(const RawStereoCamera& expected, const RawStereoCamera& camera) {
  expectSameLens(expected.left, camera.left);
  expectSameLens(expected.right, camera.right);
  EXPECT_TRUE(expected.T_left_right.isApprox(camera.T_left_right, 1e-6))
      << camera.T_left_right.matrix();
}

/// Rows of numbers, separated by commas.
template <typename Matrix>
std::string rowsOf(const Matrix& matrix) {
  static const Eigen::IOFormat format(12, Eigen::DontAlignCols, ", ", ", ");
  std::ostringstream text;
  text << matrix.format(format);
  return "[" + text.str() + "]";
}

std::string kalibr(const std::string& model = "radtan", const std::string& intrinsics = "",
                   double unit = 1.0) {
  std::ostringstream T;
  static const Eigen::IOFormat row(12, Eigen::DontAlignCols, ", ", "\n", "  - [", "]");
  Pose T_right_left = describedPair().T_left_right.inverse();
  T_right_left.translation() *= unit;
  T << T_right_left.matrix().format(row);
  return "cam0:\n  cam_overlaps: [1]\n  camera_model: pinhole\n"
         "  distortion_coeffs: [-0.25, 0.0625, 0.0005, 0.00025]\n  distortion_model: " +
         model +
         "\n  intrinsics: " + (intrinsics.empty() ? "[458.75, 457.25, 367.5, 248.5]" : intrinsics) +
         "\n  resolution: [752, 480]\n  rostopic: /cam0/image_raw\n"
         "cam1:\n  T_cn_cnm1:\n" +
         T.str() +
         "\n  camera_model: pinhole\n"
         "  distortion_coeffs: [-0.25, 0.0625, 0.0005, 0.00025]\n  distortion_model: " +
         model +
         "\n  intrinsics: [457.5, 457.25, 380.25, 248.5]\n"
         "  resolution: [752, 480]\n";
}

std::string orbSlam(const std::string& type, const std::string& pose) {
  return "%YAML:1.0\n#---\nCamera.type: \"" + type +
         "\"\nCamera1.fx: 458.75\nCamera1.fy: 457.25\nCamera1.cx: 367.5\nCamera1.cy: 248.5\n"
         "Camera1.k1: -0.25\nCamera1.k2: 0.0625\nCamera1.p1: 0.0005\nCamera1.p2: 0.00025\n"
         "Camera2.fx: 457.5\nCamera2.fy: 457.25\nCamera2.cx: 380.25\nCamera2.cy: 248.5\n"
         "Camera2.k1: -0.25\nCamera2.k2: 0.0625\nCamera2.p1: 0.0005\nCamera2.p2: 0.00025\n"
         "Camera.width: 752\nCamera.height: 480\nCamera.fps: 20\n" +
         pose;
}

class ForeignCalibrationTest : public ::testing::Test {
 protected:
  std::string at(const std::string& name) { return folder_ / name; }
  StereoCalibrationFile read(const std::string& text) {
    test::writeContent(folder_ / "c.yaml", text);
    return readStereoCalibration(at("c.yaml"));
  }
  std::string errorOf(const std::string& text) {
    return test::errorOf([&] { (void)read(text); });
  }
  /// camera_info files of a rectified pair with a baseline of 0.11 m.
  void writeCameraInfos(const std::string& model, const std::string& coefficients) {
    for (const auto& [name, shift] : {std::pair("l.yaml", 0.0), std::pair("r.yaml", -44.0)}) {
      test::writeContent(
          folder_ / name,
          "image_width: 752\nimage_height: 480\ncamera_name: left\n"
          "camera_matrix: {rows: 3, cols: 3, data: [458.75, 0, 367.5, 0, 457.25, 248.5, 0, 0, 1]}\n"
          "distortion_model: " +
              model + "\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: " + coefficients +
              "\nrectification_matrix: {rows: 3, cols: 3, data: " +
              rowsOf(expSo3({0.0, shift == 0.0 ? 0.02 : 0.01, 0.0})) +
              "}\nprojection_matrix: {rows: 3, cols: 4, data: [400, 0, 370, " +
              std::to_string(shift) + ", 0, 400, 240, 0, 0, 0, 1, 0]}\n");
    }
  }
  headway::test::TemporaryFolder folder_;
};

TEST_F(ForeignCalibrationTest, ReadsKalibr) {
  const auto file = read(kalibr());
  EXPECT_EQ("Kalibr camchain", file.format);
  EXPECT_FALSE(file.is_mounted);
  expectSameCamera(describedPair(), file.camera);
  const auto fisheye = read(kalibr("equidistant")).camera;
  EXPECT_TRUE(fisheye.left.is_fisheye && fisheye.right.is_fisheye);
  EXPECT_EQ(0.00025, fisheye.right.distortion[3]);
  EXPECT_THAT(errorOf(kalibr("radtan", "", 1000.0)),
              AllOf(HasSubstr("key 'cam1.T_cn_cnm1': the baseline is 110"),
                    HasSubstr("in metres? 0.11"), HasSubstr("millimetres")));
  EXPECT_THAT(errorOf(kalibr("fov")), HasSubstr("key 'cam0.distortion_model' is 'fov'"));
  EXPECT_THAT(errorOf(kalibr("radtan", "[0.61, 0.95, 0.49, 0.52]")),
              AllOf(HasSubstr("key 'cam0.intrinsics'"), HasSubstr("in pixels?")));
}

TEST_F(ForeignCalibrationTest, ReadsOrbSlam) {
  const std::string T = rowsOf(describedPair().T_left_right.matrix());
  const std::string pose =
      "Stereo.T_c1_c2: !!opencv-matrix\n   rows: 4\n   cols: 4\n   dt: f\n   data: " + T + "\n";
  const auto file = read(orbSlam("PinHole", pose));
  EXPECT_EQ("ORB-SLAM settings", file.format);
  EXPECT_EQ(20.0, file.frame_rate);
  expectSameCamera(describedPair(), file.camera);
  EXPECT_TRUE(read(orbSlam("KannalaBrandt8", pose)).camera.left.is_fisheye);
  const auto rectified = read(orbSlam("Rectified", "Stereo.b: 0.12\n")).camera;
  EXPECT_EQ(0.0, rectified.left.distortion[0]);
  EXPECT_EQ(0.12, rectified.T_left_right.translation().x());
  EXPECT_THAT(errorOf(orbSlam("PinHole", "")), HasSubstr("Stereo.T_c1_c2"));
  const auto old = read(
      "%YAML:1.0\nCamera.fx: 435.2\nCamera.fy: 435.2\nCamera.cx: 367.4\nCamera.cy: 252.2\n"
      "Camera.width: 752\nCamera.height: 480\nCamera.bf: 47.9\n");
  EXPECT_NEAR(47.9 / 435.2, old.camera.T_left_right.translation().x(), 1e-12);
}

TEST_F(ForeignCalibrationTest, ReadsWhatOpenCvWrites) {
  const RawStereoCamera pair = describedPair();
  const auto matrixOf = [](const RawCamera& lens) {
    return cv::Mat(cv::Matx33d(lens.fx, 0, lens.cx, 0, lens.fy, lens.cy, 0, 0, 1));
  };
  cv::Mat R, T;
  const Pose T_right_left = pair.T_left_right.inverse();
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), R);
  cv::eigen2cv(Eigen::Vector3d(T_right_left.translation()), T);
  const auto write = [&](const std::string& name, const cv::Mat& coefficients, double scale) {
    cv::FileStorage inner(at(name + "_in.yml"), cv::FileStorage::WRITE);
    inner << "M1" << matrixOf(pair.left) << "D1" << coefficients << "M2" << matrixOf(pair.right)
          << "D2" << coefficients;
    cv::FileStorage outer(at(name + "_ex.yml"), cv::FileStorage::WRITE);
    outer << "R" << R << "T" << cv::Mat(scale * T) << "Q" << cv::Mat::eye(4, 4, CV_64F);
    return at(name + "_in.yml") + "," + at(name + "_ex.yml");
  };
  const cv::Mat five = (cv::Mat_<double>(1, 5) << -0.25, 0.0625, 0.0005, 0.00025, 0.0);
  const auto file = readStereoCalibration(write("a", five, 1.0), {752, 480});
  EXPECT_EQ("OpenCV", file.format);
  expectSameCamera(pair, file.camera);

  cv::Mat fourteen = cv::Mat::zeros(1, 14, CV_64F);
  fourteen.at<double>(0) = 4.5;
  fourteen.at<double>(7) = 0.125;
  EXPECT_EQ(0.125,
            readStereoCalibration(write("b", fourteen, 1.0), {752, 480}).camera.left.rational[2]);
  EXPECT_THAT(test::errorOf([&] {
                (void)readStereoCalibration(write("c", five, 1000), {752, 480});
              }),
              AllOf(HasSubstr("'T'"), HasSubstr("in metres? 0.11"), HasSubstr("millimetres")));
  EXPECT_THAT(test::errorOf([&] {
                (void)readStereoCalibration(at("a_in.yml"), {752, 480});
              }),
              HasSubstr("INTRINSICS.yml,EXTRINSICS.yml"));
  EXPECT_THAT(test::errorOf([&] { (void)readStereoCalibration(write("d", five, 1.0)); }),
              HasSubstr("size of the images is missing"));
}

TEST_F(ForeignCalibrationTest, ReadsWhatMrptWrites) {
  const RawStereoCamera pair = describedPair();
  const auto write = [&](const RawStereoCamera& camera) {
    mrpt::img::TStereoCamera stereo;
    stereo.leftCamera = mrptCamera(camera.left, "left");
    stereo.rightCamera = mrptCamera(camera.right, "right");
    stereo.rightCameraPose = toMrptQuat(camera.T_left_right).asTPose();
    mrpt::config::CConfigFileMemory ini;
    stereo.saveToConfigFile("CAMERA_PARAMS", ini);
    test::writeContent(folder_ / "stereo.ini", ini.getContent());
    return readStereoCalibration(at("stereo.ini"));
  };
  EXPECT_EQ("MRPT stereo .ini", write(pair).format);
  const auto near = [&](const RawStereoCamera& expected, const RawStereoCamera& camera) {
    EXPECT_NEAR(expected.left.fx, camera.left.fx, 1e-3);  // as many digits as MRPT writes
    EXPECT_NEAR(expected.right.cx, camera.right.cx, 1e-3);
    EXPECT_NEAR(expected.left.distortion[0], camera.left.distortion[0], 1e-4);
    EXPECT_NEAR(expected.left.distortion[3], camera.left.distortion[3], 1e-4);
    EXPECT_NEAR(expected.right.rational[2], camera.right.rational[2], 1e-4);
    EXPECT_EQ(expected.left.is_fisheye, camera.left.is_fisheye);
    EXPECT_TRUE(expected.T_left_right.isApprox(camera.T_left_right, 1e-4));
  };
  near(pair, write(pair).camera);
  RawStereoCamera fisheye = pair;
  fisheye.left.is_fisheye = fisheye.right.is_fisheye = true;
  near(fisheye, write(fisheye).camera);
  RawStereoCamera rational = pair;
  rational.left.rational = rational.right.rational = {0.25, 0.5, 0.125};
  near(rational, write(rational).camera);
  RawStereoCamera millimetres = pair;
  millimetres.T_left_right.translation() *= 1000.0;
  EXPECT_THAT(
      test::errorOf([&] { (void)write(millimetres); }),
      AllOf(HasSubstr("[CAMERA_PARAMS_LEFT2RIGHT_POSE], key 'pose_quaternion' is a baseline of "
                      "110"),
            HasSubstr("in metres?")));
}

TEST_F(ForeignCalibrationTest, ReadsCameraInfoPairs) {
  writeCameraInfos("plumb_bob", "[-0.25, 0.0625, 0.0005, 0.00025, 0]");
  const std::string both = at("l.yaml") + "," + at("r.yaml");
  const auto file = readStereoCalibration(both);
  EXPECT_EQ("ROS camera_info", file.format);
  expectSameLens(describedPair().left, file.camera.left);
  const Pose& T = file.camera.T_left_right;
  EXPECT_NEAR(0.11, T.translation().norm(), 1e-9);
  EXPECT_TRUE(T.linear().isApprox(expSo3({0.0, -0.01, 0.0}), 1e-6)) << T.matrix();
  // The right camera is where the rectified left one has its x axis.
  EXPECT_NEAR(std::sin(0.02) * 0.11, T.translation().z(), 1e-6);
  writeCameraInfos("equidistant", "[0.01, 0.02, 0.03, 0.04]");
  EXPECT_TRUE(readStereoCalibration(both).camera.right.is_fisheye);
  writeCameraInfos("rational_polynomial", "[4.5, 2, 0, 0, 0.1, 4.25, 3, 0.5]");
  EXPECT_EQ(0.5, readStereoCalibration(both).camera.right.rational[2]);
  writeCameraInfos("scaramuzza", "[0, 0]");
  EXPECT_THAT(test::errorOf([&] { (void)readStereoCalibration(both); }), HasSubstr("'scaramuzza'"));
  EXPECT_THAT(test::errorOf([&] { (void)readStereoCalibration(at("l.yaml")); }),
              HasSubstr("LEFT.yaml,RIGHT.yaml"));
  writeCameraInfos("plumb_bob", "[0, 0, 0, 0, 0]");
  EXPECT_THAT(
      test::errorOf([&] { (void)readStereoCalibration(at("r.yaml") + "," + at("l.yaml")); }),
      HasSubstr("swapped"));
  EXPECT_THAT(
      test::errorOf([&] { (void)readStereoCalibration(at("l.yaml") + "," + at("l.yaml")); }),
      HasSubstr("no baseline"));
}

TEST_F(ForeignCalibrationTest, ImpossibleValuesAreRefusedWithKeyAndHint) {
  const std::string size = "image_size: [1226, 370]\n";
  const std::string lens = "left: [707.1, 707.1, 601.9, 183.1]\n";
  EXPECT_THAT(errorOf(size + lens + "baseline_m: 53.7\n"),
              AllOf(HasSubstr("baseline_m: 53.7: in metres? 0.0537"), HasSubstr("millimetres")));
  EXPECT_THAT(errorOf(size + lens + "baseline_m: 12\n"), HasSubstr("centimetres"));
  EXPECT_THAT(errorOf(size + "left: [0.58, 1.9, 0.49, 0.49]\nbaseline_m: 0.1\n"),
              AllOf(HasSubstr("key 'left'"), HasSubstr("in pixels?")));
  EXPECT_THAT(errorOf(size + "left: [601.9, 183.1, 5000, 707.1]\nbaseline_m: 0.1\n"),
              HasSubstr("fx, fy, cx, cy in this order"));
  EXPECT_THAT(
      errorOf(size + "left: [707.1, 707.1, 601.9, 183.1, 0.1, 0.1, 4.5]\nbaseline_m: 0.1\n"),
      HasSubstr("k1, k2, p1, p2, k3 in this order?"));
  EXPECT_THAT(errorOf("image_size: [0.1, 370]\n" + lens + "baseline_m: 0.1\n"),
              HasSubstr("'image_size'"));
  EXPECT_THAT(
      errorOf(size + lens + "baseline_m: 0.5\nT_robot_cam: [1,0,0,0, 0,1,0,0, 0,0,1,1500]\n"),
      AllOf(HasSubstr("T_robot_cam"), HasSubstr("in metres?")));
  EXPECT_THAT(errorOf(size + lens + "baseline_m: 0.5\nlens_model: omni\n"), HasSubstr("fisheye"));
  EXPECT_THAT(errorOf("pinhole: 1\n"), HasSubstr("is no stereo calibration that is known"));
  EXPECT_THAT(test::errorOf([&] { (void)readStereoCalibration(at("none.yaml")); }),
              HasSubstr("none.yaml: does not exist"));
}

TEST_F(ForeignCalibrationTest, OwnFilesDescribeFisheyesAndRationalLenses) {
  const auto file = read(
      "image_size: [752, 480]\nleft: [286, 286, 370, 240, 0.01, 0.02, 0.03, 0.04]\n"
      "lens_model: fisheye\nbaseline_m: 0.06\nframe_rate_hz: 30\n"
      "T_robot_cam: [0,0,1,0.5, -1,0,0,0, 0,-1,0,1.2]\n");
  EXPECT_TRUE(file.camera.right.is_fisheye);
  EXPECT_TRUE(file.is_mounted);
  EXPECT_EQ(30.0, file.frame_rate);
  EXPECT_EQ(0.04, file.camera.left.distortion[3]);
  EXPECT_EQ(0.5, read("image_size: [752, 480]\nbaseline_m: 0.06\n"
                      "left: [458, 457, 370, 240, 4, 2, 0, 0, 0.1, 4, 3, 0.5]\n")
                     .camera.left.rational[2]);
}

TEST_F(ForeignCalibrationTest, ImageFoldersUseTheirRateAndCheckTheirSize) {
  std::filesystem::create_directories(at("images"));
  for (const char* name : {"a.png", "b.png"}) {
    cv::imwrite(at("images/") + name, cv::Mat(480, 752, CV_8UC1, cv::Scalar(90)));
  }
  test::writeContent(folder_ / "c.yaml", orbSlam("PinHole", "Stereo.b: 0.1\n"));
  const auto dataset = openImageFolders(at("images"), at("images"), at("c.yaml"));
  EXPECT_NEAR(0.05, dataset->frame(1).time, 1e-12);
  expectSameLens(describedPair().left, dataset->camera()->left);
  cv::imwrite(at("images/a.png"), cv::Mat(240, 376, CV_8UC1, cv::Scalar(90)));
  EXPECT_THAT(
      test::errorOf([&] { (void)openImageFolders(at("images"), at("images"), at("c.yaml")); }),
      AllOf(HasSubstr("752x480"), HasSubstr("376x240")));
}

}  // namespace
}  // namespace headway::io
