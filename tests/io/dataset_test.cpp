// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/trajectory_file.h>
#include <headway_test/folders.h>

#include <opencv2/imgcodecs.hpp>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class DatasetTest : public ::testing::Test {
 protected:
  void write(const std::string& name, const std::string& text) {
    test::writeContent(folder_ / name, text);
  }
  void writeImage(const std::string& name, const cv::Mat& image) {
    fs::create_directories((folder_ / name).parent_path());
    cv::imwrite(folder_ / name, image);
  }
  void writeKittiImages(const std::string& left, const std::string& right, int frames) {
    for (int i = 0; i < frames; ++i) {
      const std::string name = "/00000" + std::to_string(i) + ".png";
      writeImage("sequences/07/" + left + name, test::wall(i).left);
      writeImage("sequences/07/" + right + name, test::wall(i).right);
    }
  }

  headway::test::TemporaryFolder folder_;
  std::string root_ = folder_.path();
};

constexpr char kKittiCalibration[] =
    "P0: 100 0 80 0 0 100 60 0 0 0 1 0\n"
    "P1: 100 0 80 -50 0 100 60 0 0 0 1 0\n"
    "P2: 110 0 81 6 0 110 61 0.2 0 0 1 0.003\n"
    "P3: 110 0 81 -49 0 110 61 0.9 0 0 1 0.002\n"
    "R0_rect: 1 0 0 0 1 0 0 0 1\n";

TEST_F(DatasetTest, KittiOdometryIsReadWithTimesAndTruth) {
  writeKittiImages("image_0", "image_1", 3);
  write("sequences/07/calib.txt", kKittiCalibration);
  write("sequences/07/times.txt", "0\n0.1\n0.25\n");
  write("poses/07.txt",
        "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.1 0 1 0 0.2 0 0 1 3\n1 0 0 0 0 1 0 0 0 0 1 6\n");
  const auto dataset = openKittiOdometry(root_, "07");
  ASSERT_EQ(3u, dataset->size());
  const auto frame = dataset->frame(1);
  EXPECT_EQ(0.1, frame.time);
  EXPECT_TRUE(test::sameImage(test::wall(1).left, frame.left));
  EXPECT_TRUE(test::sameImage(test::wall(1).right, frame.right));
  // Camera: 3 m ahead, 0.1 m right, 0.2 m down; the robot's axes are x forward, y left, z up.
  EXPECT_TRUE(frame.truth_T_map_robot->translation().isApprox(Eigen::Vector3d(3, -0.1, -0.2)));
  const auto camera = dataset->camera();
  EXPECT_EQ(100.0, camera->left.fx);
  EXPECT_EQ(160, camera->left.width);
  EXPECT_EQ(Eigen::Vector3d(0.5, 0, 0), camera->T_left_right.translation());
  EXPECT_TRUE(camera->T_robot_left.isApprox(robotFromOptical()));
}

TEST_F(DatasetTest, UsesKittiColourWithoutGrey) {
  writeKittiImages("image_2", "image_3", 2);
  write("sequences/07/calib.txt", kKittiCalibration);
  const auto dataset = openKittiOdometry(root_, "07");
  EXPECT_EQ(0.1, dataset->frame(1).time);  // no times given
  EXPECT_FALSE(dataset->frame(1).truth_T_map_robot);
  const auto camera = dataset->camera();
  EXPECT_EQ(110.0, camera->left.fx);
  EXPECT_NEAR(0.5, camera->T_left_right.translation().x(), 1e-3);
  EXPECT_EQ(0.0, camera->T_left_right.translation().y());
  // Camera 2 stands left of camera 0: a positive offset in P2 is a centre at negative x.
  EXPECT_GT(camera->T_robot_left.translation().y(), 0.04);
}

TEST_F(DatasetTest, CountsUnpairedKittiImages) {
  writeKittiImages("image_0", "image_1", 3);
  fs::remove(folder_ / "sequences/07/image_1/000001.png");
  write("sequences/07/calib.txt", kKittiCalibration);
  const auto dataset = openKittiOdometry(root_, "07");
  EXPECT_EQ(2u, dataset->size());
  EXPECT_EQ(0.2, dataset->frame(1).time);
  EXPECT_THAT(dataset->dropped(), ElementsAre(Pair("unpaired_image", 1u)));
}

TEST_F(DatasetTest, KittiErrorsNameTheFile) {
  const auto message = [&] { return test::errorOf([&] { (void)openKittiOdometry(root_, "07"); }); };
  EXPECT_THAT(message(), HasSubstr("sequences/07: is not a folder"));
  writeKittiImages("image_0", "image_1", 2);
  EXPECT_THAT(message(), HasSubstr("calib.txt: cannot be opened"));
  write("sequences/07/calib.txt", "P0: 1 2 3\n");
  EXPECT_THAT(message(), HasSubstr("calib.txt: is not a KITTI calibration"));
  write("sequences/07/calib.txt", kKittiCalibration);
  write("sequences/07/times.txt", "0\n");
  EXPECT_THAT(message(), HasSubstr("times.txt: has 1 times, none for image 1"));
  write("sequences/07/times.txt", "0\n0.1\n");
  test::writeContent(folder_ / "sequences/07/image_1/000001.png", "no picture");
  EXPECT_THAT(test::errorOf([&] { (void)openKittiOdometry(root_, "07")->frame(1); }),
              HasSubstr("image_1/000001.png: missing, broken"));
}

TEST_F(DatasetTest, KittiTrackingJoinsPosesBoxesAndTruth) {
  write("training/pose_orbslam3/0001.txt",
        "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 2\n1 0 0 0 0 1 0 0 0 0 1 4\n");
  write("training/label_02/0001.txt",
        "0 5 Car 0 0 0 1 2 3 4 1.5 1.6 4 1 1.7 20 0\n"
        "0 -1 DontCare -1 -1 -10 1 2 3 4 -1000 -1000 -1000 -10 -1 -1 -1\n");
  write("training/det3d_pointrcnn/Car/0001.txt", "1,2,1,2,3,4,9,1.5,1.6,4,1,1.7,20,0,0\n");
  write("training/det3d_pointrcnn/Pedestrian/0001.txt",
        "1,1,1,2,3,4,8,1.8,0.6,0.8,1,1.7,10,0,0\n7,1,1,2,3,4,8,1.8,0.6,0.8,1,1.7,10,0,0\n");
  write("training/det2d_rrc/Car/0001.txt", "2,1,2,3,4,0.9\n");
  const auto dataset = openKittiTracking(root_, "0001", kittiBoxesFrom("det3d_pointrcnn"));
  ASSERT_EQ(3u, dataset->size());
  EXPECT_FALSE(dataset->camera());
  const auto frame = dataset->frame(1);
  EXPECT_NEAR(0.1, frame.time, 1e-12);
  EXPECT_TRUE(frame.T_map_robot->translation().isApprox(Eigen::Vector3d(2, 0, 0)));
  EXPECT_FALSE(frame.truth_T_map_robot);  // the poses are estimates
  EXPECT_EQ(2u, frame.detections->items.size());
  EXPECT_NEAR(0.1, frame.detections->time, 1e-12);
  EXPECT_TRUE(dataset->frame(0).detections->items.empty());
  EXPECT_EQ(1u, dataset->frame(0).truth_objects->items.size());
  EXPECT_EQ(5, dataset->frame(0).truth_objects->items[0].detector_id);
  EXPECT_THAT(dataset->dropped(), ElementsAre(Pair("frame_without_pose", 1u)));

  const auto flat = openKittiTracking(root_, "0001", kittiBoxesFrom("det2d_rrc"));
  EXPECT_EQ(ObjectClass::kCar, flat->frame(2).detections->items.at(0).object_class);
  const auto labels = openKittiTracking(root_, "0001", kittiBoxesFrom("label_02"));
  EXPECT_EQ(1u, labels->frame(0).detections->items.size());
  EXPECT_THAT(test::errorOf([] { (void)kittiBoxesFrom("mine"); }), HasSubstr("det2d_rrc"));
  fs::remove_all(folder_ / "training/det2d_rrc");
  EXPECT_THROW((void)openKittiTracking(root_, "0001", KittiBoxes::kRrc2d), InputError);
  EXPECT_THROW((void)openKittiTracking(root_, "0002", KittiBoxes::kLabels), InputError);
}

/// A drone whose body x points up and z forward; cameras face body z.
void writeEurocSensors(const std::function<void(const std::string&, const std::string&)>& write) {
  for (const auto& [camera, y] : {std::pair("cam0", "0.0"), std::pair("cam1", "0.1")}) {
    write(std::string("mav0/") + camera + "/sensor.yaml",
          std::string("# a comment\nsensor_type: camera\nT_BS:\n  cols: 4\n  rows: 4\n") +
              "  data: [0.0, -1.0, 0.0, 0.5,\n         1.0, 0.0, 0.0, " + y +
              ",\n         0.0, 0.0, 1.0, 0.0,\n         0.0, 0.0, 0.0, 1.0]\n"
              "resolution: [160, 120]\ncamera_model: pinhole\n"
              "intrinsics: [100, 101, 80, 60] #fu, fv, cu, cv\n"
              "distortion_model: radial-tangential\n"
              "distortion_coefficients: [-0.1, 0.01, 0.001, 1.0e-05]\n");
  }
}

TEST_F(DatasetTest, EurocIsReadWithTheRobotLookingForward) {
  const auto writer = [&](const std::string& name, const std::string& text) { write(name, text); };
  writeEurocSensors(writer);
  write("mav0/cam0/data.csv",
        "#timestamp [ns],filename\n1403636579763555584,a.png\n1403636579813555456,b.png\n");
  write("mav0/cam1/data.csv",
        "#timestamp [ns],filename\n1403636579763555584,a.png\n1403636579863555456,c.png\n");
  writeImage("mav0/cam0/data/a.png", test::wall(0).left);
  writeImage("mav0/cam1/data/a.png", test::wall(0).right);
  write("mav0/state_groundtruth_estimate0/data.csv",
        "#timestamp,x,y,z,qw,qx,qy,qz,vx\n1403636579713555584,1,0,0,1,0,0,0,9\n"
        "1403636579813555584,3,0,0,1,0,0,0,9\n");
  write("mav0/imu0/sensor.yaml",
        "T_BS:\n  cols: 4\n  rows: 4\n  data: [1,0,0,0, 0,1,0,0, 0,0,1,0, "
        "0,0,0,1]\n");
  write("mav0/imu0/data.csv", "#t,wx,wy,wz,ax,ay,az\n1403636579763555584,0.1,0.2,0.3,9.81,0,0\n");
  const auto dataset = openEuroc(root_);
  ASSERT_EQ(1u, dataset->size());
  EXPECT_THAT(dataset->dropped(), ElementsAre(Pair("unpaired_image", 2u)));
  const auto frame = dataset->frame(0);
  EXPECT_NEAR(1403636579.763555584, frame.time, 1e-6);
  EXPECT_TRUE(test::sameImage(test::wall(0).left, frame.left));
  const auto camera = dataset->camera();
  EXPECT_NEAR(0.1, camera->T_left_right.translation().x(), 1e-12);
  EXPECT_EQ(-0.1, camera->left.distortion[0]);
  EXPECT_EQ(101.0, camera->right.fy);
  // The camera faces the robot's x, its right is the robot's -y; the lever arm of 0.5 m along
  // body x is upwards.
  EXPECT_TRUE(camera->T_robot_left.linear().isApprox(robotFromOptical().linear(), 1e-12));
  EXPECT_TRUE(camera->T_robot_left.translation().isApprox(Eigen::Vector3d(0, 0, 0.5), 1e-12));
  // Truth half way between its samples, turned with the body.
  ASSERT_TRUE(frame.truth_T_map_robot);
  EXPECT_NEAR(2.0, frame.truth_T_map_robot->translation().x(), 1e-5);
  EXPECT_TRUE(frame.truth_T_map_robot->linear().col(0).isApprox(Eigen::Vector3d::UnitZ(), 1e-9));
  // Gravity on body x is up for the robot.
  ASSERT_EQ(1u, dataset->inertial().size());
  EXPECT_TRUE(dataset->inertial()[0].acceleration.isApprox(Eigen::Vector3d(0, 0, 9.81), 1e-9));
}

TEST_F(DatasetTest, EurocErrorsNameTheFile) {
  const auto message = [&] { return test::errorOf([&] { (void)openEuroc(root_); }); };
  EXPECT_THAT(message(), HasSubstr("mav0: is not a folder"));
  const auto writer = [&](const std::string& name, const std::string& text) { write(name, text); };
  writeEurocSensors(writer);
  EXPECT_THAT(message(), HasSubstr("cam0/data.csv: cannot be opened"));
  write("mav0/cam0/data.csv", "12,a.png\n");
  write("mav0/cam1/data.csv", "13,a.png\n");
  EXPECT_THAT(message(), HasSubstr("no common time stamp"));
  write("mav0/cam1/data.csv", "one,a.png\n");
  EXPECT_THAT(message(), HasSubstr("data.csv:1: 'one' is not a time"));
  write("mav0/cam1/sensor.yaml", "resolution: [1, 2]\n");
  EXPECT_THAT(message(), HasSubstr("cam1/sensor.yaml: key 'intrinsics' is missing"));
}

TEST_F(DatasetTest, EurocRowsThatAreShortOrNoNumbersNameTheLine) {
  const auto writer = [&](const std::string& name, const std::string& text) { write(name, text); };
  writeEurocSensors(writer);
  for (const char* camera : {"cam0", "cam1"}) {
    write(std::string("mav0/") + camera + "/data.csv", "12,a.png\n");
  }
  write("mav0/imu0/sensor.yaml", "T_BS: {data: [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}\n");
  const std::string state = "mav0/state_groundtruth_estimate0/data.csv",
                    inertial = "mav0/imu0/data.csv";
  const auto expectError = [&](const std::string& file, const std::string& row) {
    write(state, "12,1,0,0,1,0,0,0\n" + (file == state ? row : ""));
    write(inertial, "12,0,0,0,0,0,9.8\n" + (file == inertial ? row : ""));
    EXPECT_THAT(test::errorOf([&] { (void)openEuroc(root_); }),
                row.empty() ? HasSubstr("no error") : HasSubstr(file + ":2: "))
        << row;
  };
  expectError(state, "");
  for (const char* row : {"13", "13,1,0", "13,1,0,0,1,0,0", "13,1,x,0,1,0,0,0", "13,1,0,0,1,0,0,",
                          "13,1,0,0,0,0,0,0", "x,1,0,0,1,0,0,0"}) {
    expectError(state, std::string(row) + "\n");
  }
  for (const char* row : {"13", "13,0,0,0", "13,0,0,0,0,0", "13,0,x,0,0,0,9.8", "13,0,0,0,0,,9.8",
                          "x,0,0,0,0,0,9.8"}) {
    expectError(inertial, std::string(row) + "\n");
  }
}

TEST_F(DatasetTest, PairsImageFoldersByTheOrderOfNames) {
  for (int i = 0; i < 3; ++i) {
    const std::string number = std::to_string(8 + i);  // 10 follows 9
    writeImage("l/left" + number + ".png", test::wall(i).left);
    writeImage("r/right" + number + ".png", test::wall(i).right);
  }
  write("l/notes.txt", "not an image");
  const std::string calibration =
      "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n";
  write("c.yaml", calibration + "frame_rate_hz: 20\n");
  const auto open = [&] {
    return openImageFolders(folder_ / "l", folder_ / "r", folder_ / "c.yaml");
  };
  EXPECT_EQ(3u, open()->size());
  EXPECT_EQ(0.1, open()->frame(2).time);
  EXPECT_TRUE(test::sameImage(test::wall(2).right, open()->frame(2).right));
  EXPECT_EQ(0.2, open()->camera()->T_left_right.translation().x());
  write("c.yaml", calibration + "times: t.txt\n");
  write("t.txt", "5.5\n5.6\n5.75\n");
  EXPECT_EQ(5.75, open()->frame(2).time);
  write("t.txt", "5.5\n");
  EXPECT_THAT(test::errorOf([&] { (void)open(); }), HasSubstr("t.txt: has 1 times for 3 images"));
  write("c.yaml", calibration + "frame_rate_hz: 0\n");
  EXPECT_THAT(test::errorOf([&] { (void)open(); }), HasSubstr("frame_rate_hz"));
  write("c.yaml", calibration);
  fs::remove(folder_ / "l/left8.png");
  EXPECT_THAT(test::errorOf([&] { (void)open(); }), HasSubstr("must contain the same number"));
  EXPECT_THAT(test::errorOf([&] {
                (void)openImageFolders(folder_ / "nowhere", folder_ / "r", folder_ / "c.yaml");
              }),
              HasSubstr("nowhere: is not a readable folder"));
}

/// Times of the frames of two folders.
std::vector<Time> timesOf(const Dataset& dataset) {
  std::vector<Time> times;
  for (std::size_t i = 0; i < dataset.size(); ++i) times.push_back(dataset.frame(i).time);
  return times;
}

TEST_F(DatasetTest, TimesOfImagesAreTakenInTheDocumentedOrder) {
  const std::string calibration =
      "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n";
  // Microseconds; the names are not in the order of the numbers' digits.
  for (const char* name : {"f_1700000000000000", "f_1700000000100000", "f_1700000000050000"}) {
    for (const char* side : {"n/l/", "n/r/"}) {
      writeImage(side + std::string(name) + ".png", test::wall(0).left);
    }
  }
  const auto open = [&](const ImageTimes& times = {}) {
    return openImageFolders(folder_ / "n/l", folder_ / "n/r", folder_ / "c.yaml", times);
  };
  using Times = std::vector<Time>;
  write("c.yaml", calibration);
  EXPECT_THAT(timesOf(*open()), ::testing::Pointwise(::testing::DoubleNear(1e-6),
                                                     Times{1.7e9, 1.7e9 + 0.05, 1.7e9 + 0.1}));
  EXPECT_TRUE(open()->warnings().empty());
  write("n/times.txt", "4\n5\n6\n");
  EXPECT_EQ((Times{4, 5, 6}), timesOf(*open())) << "beside both folders";
  write("c.yaml", calibration + "times: stated.txt\n");
  write("stated.txt", "7\n8\n9\n");
  EXPECT_EQ((Times{7, 8, 9}), timesOf(*open())) << "the calibration's rather than times.txt";
  write("c.yaml", calibration + "frame_rate_hz: 4\n");
  EXPECT_EQ((Times{0, 0.25, 0.5}), timesOf(*open()));
  EXPECT_EQ((Times{0, 0.5, 1}), timesOf(*open({2.0, ""})));
  write("n/times.txt", "4\n5\n");
  EXPECT_EQ((Times{0, 0.5, 1}), timesOf(*open({2.0, ""}))) << "what is not used may be short";
  EXPECT_EQ((Times{0, 0.25, 0.5}), timesOf(*open()));
  write("c.yaml", calibration);
  EXPECT_THAT(test::errorOf([&] { (void)open(); }), HasSubstr("times.txt: has 2 times for 3"));
  write("n/times.txt", "");
  EXPECT_THAT(test::errorOf([&] { (void)open(); }), HasSubstr("times.txt: has 0 times for 3"));
  write("t", "1\n3\n7\n");
  EXPECT_EQ((Times{1, 3, 7}), timesOf(*open({0.0, folder_ / "t"})));
  write("t", "1\nnan\n7\n");
  EXPECT_THAT(test::errorOf([&] { (void)open({0.0, folder_ / "t"}); }), HasSubstr("t:2"));
}

TEST_F(DatasetTest, NamesAreTimesInSecondsOrNanoseconds) {
  write("c.yaml", "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n");
  const std::map<std::string, std::vector<std::string>> units = {
      {"s", {"1700000000.25", "1700000000.5", "1700000001"}},
      {"ns", {"1700000000250000000", "1700000000500000000", "1700000001000000000"}}};
  for (const auto& [unit, names] : units) {
    for (const auto& name : names) {
      for (const char* side : {"/l/", "/r/"}) {
        writeImage(unit + side + name + ".png", test::wall(0).left);
      }
    }
    const auto dataset =
        openImageFolders(folder_ / (unit + "/l"), folder_ / (unit + "/r"), folder_ / "c.yaml");
    EXPECT_THAT(timesOf(*dataset),
                ::testing::Pointwise(::testing::DoubleNear(1e-6),
                                     std::vector<Time>{1.7e9 + 0.25, 1.7e9 + 0.5, 1.7e9 + 1.0}))
        << unit;
    EXPECT_TRUE(dataset->warnings().empty()) << unit;
  }
}

TEST_F(DatasetTest, ImagesWithoutTimesGetARateAndAWarning) {
  // Counters, numbers before the year 2000, and two units are no times.
  for (const auto& [first, second] : {std::pair("1", "2"), std::pair("900000000", "900000001"),
                                      std::pair("1700000000", "1700000000100")}) {
    const std::string folder = std::string("f") + first;
    for (const char* side : {"/l/", "/r/"}) {
      writeImage(folder + side + first + ".png", test::wall(0).left);
      writeImage(folder + side + second + ".png", test::wall(0).right);
    }
    write("c.yaml", "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n");
    const auto dataset =
        openImageFolders(folder_ / (folder + "/l"), folder_ / (folder + "/r"), folder_ / "c.yaml");
    EXPECT_EQ((std::vector<Time>{0.0, 0.1}), timesOf(*dataset)) << folder;
    EXPECT_EQ(1u, dataset->warnings().count("times_assumed")) << folder;
    RawlogSink sink(folder_ / "x.rawlog", ImageStorage::kEmbeddedRaw);
    sink.writeTimesAssumed(0.0);
    sink.writeStereo(0.1, test::wall(0).left, test::wall(0).right, *dataset->camera());
    sink.close();
    RawlogSource source(folder_ / "x.rawlog", {});
    EXPECT_EQ(1u, source.warnings().count("times_assumed"));
    EXPECT_TRUE(source.skipped().empty());
  }
}

TEST_F(DatasetTest, ImagesWithTimesArePairedByTime) {
  write("c.yaml", "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n");
  for (int i = 0; i < 4; ++i) {
    const auto name = [i](const char* side, int ms) {
      return side + std::to_string(1700000000000 + 100 * i + ms) + ".jpg";
    };
    writeImage(name("l/", 0), test::wall(i).left);
    if (i != 1) writeImage(name("r/", 4), test::wall(i).right);
    writeImage(name("late/", 40), test::wall(i).right);
  }
  const auto dataset = openImageFolders(folder_ / "l", folder_ / "r", folder_ / "c.yaml");
  EXPECT_EQ(3u, dataset->size());
  EXPECT_NEAR(1.7e9 + 0.2, dataset->frame(1).time, 1e-6);
  EXPECT_EQ((std::map<std::string, std::size_t>{{"unpaired_image", 1}}), dataset->dropped());
  write("t", "1\n3\n7\n8\n");
  for (const auto& [stated, times] :
       {std::pair(ImageTimes{5.0, ""}, std::vector<Time>{0.0, 0.4, 0.6}),
        std::pair(ImageTimes{0.0, folder_ / "t"}, std::vector<Time>{1.0, 7.0, 8.0})}) {
    const auto timed = openImageFolders(folder_ / "l", folder_ / "r", folder_ / "c.yaml", stated);
    EXPECT_THAT(timesOf(*timed), ::testing::Pointwise(::testing::DoubleNear(1e-9), times));
    EXPECT_EQ(dataset->dropped(), timed->dropped());
    EXPECT_TRUE(test::sameImage(dataset->frame(1).right, timed->frame(1).right));
    EXPECT_TRUE(test::sameImage(dataset->frame(1).left, timed->frame(1).left));
  }
  EXPECT_THAT(test::errorOf([&] {
                (void)openImageFolders(folder_ / "l", folder_ / "late", folder_ / "c.yaml");
              }),
              HasSubstr("0.04 s apart or more, allowed are 0.01 s: the cameras are not "
                        "synchronised"));
}

TEST_F(DatasetTest, ImagesSideBySideAreSplit) {
  write("c.yaml", "image_size: [160, 120]\nleft: [100, 100, 80, 60]\nbaseline_m: 0.2\n");
  cv::Mat both;
  cv::hconcat(test::wall(3).left, test::wall(3).right, both);
  writeImage("b/0.png", both);
  const auto dataset = openStereoImages(imagesOfFolder(folder_ / "b"), nullptr, folder_ / "c.yaml");
  EXPECT_TRUE(test::sameImage(test::wall(3).left, dataset->frame(0).left));
  EXPECT_TRUE(test::sameImage(test::wall(3).right, dataset->frame(0).right));
  EXPECT_THAT(test::errorOf([&] {
                (void)openImageFolders(folder_ / "b", folder_ / "b", folder_ / "c.yaml");
              }),
              HasSubstr("--side-by-side"));
}

TEST_F(DatasetTest, RealEurocCamerasLookForwardAndTruthIsLevel) {
  HEADWAY_REQUIRE_DATA(data);
  const auto dataset = openEuroc(data / "euroc/MH_01_easy");
  EXPECT_EQ(100u, dataset->size());
  const auto camera = dataset->camera();
  // Viewing direction within a few degrees of the robot's x, right of the image to the robot's -y.
  EXPECT_GT(camera->T_robot_left.linear()(0, 2), 0.99);
  EXPECT_LT(camera->T_robot_left.linear()(1, 0), -0.99);
  std::size_t with_truth = 0;
  for (std::size_t i = 0; i < dataset->size(); i += 20) {
    const auto truth = dataset->frame(i).truth_T_map_robot;
    if (!truth) continue;
    ++with_truth;
    EXPECT_GT(truth->linear()(2, 2), 0.6) << i;  // the drone's up is mostly up
  }
  EXPECT_EQ(5u, with_truth);
}

}  // namespace
}  // namespace headway::io
