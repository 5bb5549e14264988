// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway_test/folders.h>

#include <cmath>
#include <cstdio>
#include <iomanip>
#include <opencv2/imgcodecs.hpp>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

constexpr char kDrive[] = "2011_09_26_drive_0001_sync";
constexpr double kEarthRadius_m = 6378137.0;
constexpr double kStart_s = 1317042272.0;  // 2011-09-26 13:04:32 UTC

/// A lidar with a robot's axes 1 m behind camera 0, and a unit 0.5 m above the lidar.
constexpr char kCameras[] =
    "calib_time: 09-Jan-2012 13:57:47\n"
    "S_rect_00: 160 120\n"
    "R_rect_00: 1 0 0 0 1 0 0 0 1\n"
    "P_rect_00: 100 0 80 0 0 100 60 0 0 0 1 0\n"
    "P_rect_01: 100 0 80 -50 0 100 60 0 0 0 1 0\n";
constexpr char kLidarToCamera[] = "R: 0 -1 0 0 0 -1 1 0 0\nT: 0 0 -1\n";
constexpr char kUnitToLidar[] = "R: 1 0 0 0 1 0 0 0 1\nT: 0 0 0.5\n";

std::string tracklet(const std::string& type, int first_frame, const std::string& poses) {
  return "<item class_id=\"1\"><objectType>" + type +
         "</objectType><h>2</h><w>1.8</w><l>4</l><first_frame>" + std::to_string(first_frame) +
         "</first_frame><poses><count>1</count>" + poses + "</poses><finished>1</finished></item>";
}

std::string trackletPose(double x, double y, double yaw, int truncation) {
  std::ostringstream text;
  text << std::setprecision(15) << "<item>\n<tx>" << x << "</tx><ty>" << y
       << "</ty><tz>-1.7</tz><rx>0</rx><ry>0</ry><rz>" << yaw
       << "</rz><state>2</state><occlusion>0</occlusion><truncation>" << truncation
       << "</truncation></item>\n";
  return text.str();
}

/// Four frames at 10 Hz, driving north at 10 m/s; OXTS packets come 0.02 s after the images.
class KittiRawTest : public ::testing::Test {
 protected:
  void SetUp() override {
    write("2011_09_26/calib_cam_to_cam.txt", kCameras);
    write("2011_09_26/calib_velo_to_cam.txt", kLidarToCamera);
    write("2011_09_26/calib_imu_to_velo.txt", kUnitToLidar);
    writeTimes("image_00/timestamps.txt", 0.0);
    writeTimes("oxts/timestamps.txt", 0.02);
    for (int k = 0; k < kFrames; ++k) {
      for (const auto& [camera, image] : {std::pair("image_00", test::wall(k).left),
                                          std::pair("image_01", test::wall(k).right)}) {
        const std::string name = inDrive(std::string(camera) + "/data/" + number(k) + ".png");
        fs::create_directories((folder_ / name).parent_path());
        cv::imwrite(folder_ / name, image);
      }
      writePacket(k, 1.0 * k);
    }
  }

  void writeTracklets(const std::string& items) {
    write(inDrive("tracklet_labels.xml"),
          "<?xml version=\"1.0\"?>\n<!DOCTYPE boost_serialization>\n<boost_serialization>\n"
          "<tracklets version=\"0\"><count>2</count><item_version>1</item_version>\n" +
              items + "</tracklets>\n</boost_serialization>\n");
  }

  /// A packet `north` metres north of 49 degrees, heading north, level.
  void writePacket(int k, double north) {
    const double latitude = 49.0 + north / kEarthRadius_m * 180.0 / M_PI;
    char text[400];
    std::snprintf(text, sizeof text,
                  "%.12f 8.4 110 0 0 %.12f 12 0 12 0 0 0.1 0.2 9.8 0.1 0.2 9.8 0.01 0.02 0.03 0.01 "
                  "0.02 0.03 0.5 0.1 4 9 4 4 0\n",
                  latitude, M_PI / 2.0);
    write(inDrive("oxts/data/" + number(k) + ".txt"), text);
  }

  void writeTimes(const std::string& name, double delay) {
    std::string text;
    for (int k = 0; k < kFrames; ++k) {
      char row[64];
      std::snprintf(row, sizeof row, "2011-09-26 13:04:%012.9f\n", 32.0 + 0.1 * k + delay);
      text += row;
    }
    write(inDrive(name), text);
  }

  void write(const std::string& name, const std::string& text) {
    test::writeContent(folder_ / name, text);
  }
  static std::string number(int k) { return "000000000" + std::to_string(k); }
  static std::string inDrive(const std::string& name) {
    return std::string("2011_09_26/") + kDrive + "/" + name;
  }
  std::unique_ptr<Dataset> open(OxtsPath path = OxtsPath::kPositions) {
    return openKittiRaw(folder_.path(), kDrive, path);
  }
  std::string message() {
    return test::errorOf([&] { (void)open(); });
  }

  static constexpr int kFrames = 4;
  headway::test::TemporaryFolder folder_;
};

TEST_F(KittiRawTest, ReadsImagesCalibrationAndTimes) {
  const auto dataset = open();
  ASSERT_EQ(4u, dataset->size());
  EXPECT_TRUE(dataset->dropped().empty());
  const auto frame = dataset->frame(2);
  EXPECT_NEAR(kStart_s + 0.2, frame.time, 1e-6);
  EXPECT_TRUE(test::sameImage(test::wall(2).left, frame.left));
  EXPECT_TRUE(test::sameImage(test::wall(2).right, frame.right));
  EXPECT_FALSE(frame.T_map_robot);
  EXPECT_FALSE(frame.detections);
  EXPECT_FALSE(frame.truth_objects);  // the drive has no tracklets
  EXPECT_EQ(100.0, dataset->camera()->left.fx);
  EXPECT_NEAR(0.5, dataset->camera()->T_left_right.translation().x(), 1e-12);
}

TEST_F(KittiRawTest, TruePosesStartLevelAtTheFirstFrameAndFollowTheMercatorProjection) {
  const auto dataset = open();
  const auto first = dataset->frame(0).truth_T_map_robot;
  ASSERT_TRUE(first);
  EXPECT_TRUE(first->isApprox(Pose::Identity(), 1e-9));
  const auto third = dataset->frame(2).truth_T_map_robot;
  ASSERT_TRUE(third);  // north is forward
  EXPECT_TRUE(third->translation().isApprox(Eigen::Vector3d(2.0, 0.0, 0.0), 1e-6))
      << third->translation().transpose();
}

TEST_F(KittiRawTest, TruePosesMayComeFromVelocities) {
  const auto third = open(OxtsPath::kVelocities)->frame(2).truth_T_map_robot;
  ASSERT_TRUE(third);
  EXPECT_TRUE(third->translation().isApprox(Eigen::Vector3d(2.4, 0.0, 0.0), 1e-6));
  EXPECT_EQ(OxtsPath::kVelocities, oxtsPathFrom("velocities"));
  EXPECT_THAT(test::errorOf([] { (void)oxtsPathFrom("speed"); }), HasSubstr("velocities"));
}

TEST_F(KittiRawTest, SensorSamplesAreInTheRobotFrame) {
  const auto dataset = open();
  ASSERT_EQ(4u, dataset->inertial().size());
  EXPECT_NEAR(kStart_s + 0.12, dataset->inertial()[1].time, 1e-6);
  EXPECT_TRUE(dataset->inertial()[1].acceleration.isApprox(Eigen::Vector3d(0.1, 0.2, 9.8), 1e-9));
  ASSERT_EQ(4u, dataset->gnss().size());
  const auto sample = dataset->gnss()[1];
  EXPECT_NEAR(8.4, sample.longitude_deg, 1e-12);
  EXPECT_EQ(9, sample.satellites);
  EXPECT_TRUE(sample.velocity.isApprox(Eigen::Vector3d(0.0, 12.0, 0.0), 1e-12));
  EXPECT_TRUE(sample.T_robot_antenna.translation().isApprox(Eigen::Vector3d(-1.0, 0.0, 0.5), 1e-9));
}

TEST_F(KittiRawTest, TrackletsAreTrueObjectsInTheLeftCamera) {
  writeTracklets(
      tracklet("Van", 1, trackletPose(11.0, 2.0, M_PI / 2.0, 0) + trackletPose(12.0, 2.0, 0.0, 1)) +
      tracklet("Person (sitting)", 1, trackletPose(6.0, -1.0, 0.0, 0)));
  const auto dataset = open();
  EXPECT_TRUE(dataset->frame(0).truth_objects->items.empty());
  const auto objects = *dataset->frame(1).truth_objects;
  ASSERT_EQ(2u, objects.items.size());
  const auto& van = objects.items[0];
  EXPECT_EQ(ObjectClass::kVan, van.object_class);
  EXPECT_EQ(0, van.detector_id);
  // The tracklet's position is on the ground, 1.7 m below the lidar; the box is 2 m high.
  EXPECT_TRUE(van.box3d->centre.isApprox(Eigen::Vector3d(-2.0, 0.7, 10.0), 1e-9));
  EXPECT_EQ(4.0, van.box3d->length);
  EXPECT_NEAR(M_PI, std::abs(van.box3d->yaw), 1e-9);  // its front points left, along -x
  EXPECT_EQ(ObjectClass::kPersonSitting, objects.items[1].object_class);
  const auto next = dataset->frame(2).truth_objects->items.at(0);
  EXPECT_NEAR(-M_PI / 2.0, next.box3d->yaw, 1e-9);  // its front points away from the camera
}

TEST_F(KittiRawTest, SkippedItemsAreCountedByReason) {
  writeTracklets(tracklet("Van", 0, trackletPose(11, 2, 0, 2)) +
                 tracklet("Dog", 0, trackletPose(11, 2, 0, 0)) +
                 tracklet("Car", 9, trackletPose(11, 2, 0, 0)));
  fs::remove(folder_ / inDrive("image_01/data/" + number(1) + ".png"));
  for (const int k : {2, 3}) fs::remove(folder_ / inDrive("oxts/data/" + number(k) + ".txt"));
  const auto dataset = open();
  EXPECT_EQ(3u, dataset->size());
  EXPECT_THAT(dataset->dropped(),
              ElementsAre(Pair("frame_without_image", 1u), Pair("frame_without_truth", 2u),
                          Pair("tracklet_outside_image", 1u), Pair("unknown_class", 1u),
                          Pair("unpaired_image", 1u)));
  EXPECT_TRUE(dataset->frame(0).truth_T_map_robot);
  EXPECT_FALSE(dataset->frame(2).truth_T_map_robot);
}

TEST_F(KittiRawTest, ADriveWithoutOxtsHasNoTruth) {
  fs::remove_all(folder_ / inDrive("oxts"));
  const auto dataset = open();
  EXPECT_FALSE(dataset->frame(0).truth_T_map_robot);
  EXPECT_TRUE(dataset->gnss().empty());
}

TEST_F(KittiRawTest, ErrorsNameTheFile) {
  EXPECT_THAT(test::errorOf([&] {
                (void)openKittiRaw(folder_.path(), "2011_09_28_drive_0001_sync",
                                   OxtsPath::kPositions);
              }),
              HasSubstr("2011_09_28_drive_0001_sync: is not a folder"));
  write(inDrive("oxts/data/" + number(1) + ".txt"), "1 2 3\n");
  EXPECT_THAT(message(), HasSubstr(number(1) + ".txt:1: "));
  writePacket(1, 1.0);
  writeTracklets("<item><objectType>Car</objectType><h>x</h></item>");
  EXPECT_THAT(message(), HasSubstr("tracklet_labels.xml:5: </h> is not a number: 'x'"));
  writeTracklets("<item><objectType>Car</objectType><poses></poses></item>");
  EXPECT_THAT(message(), HasSubstr("the tracklet has no <h>"));
  writeTracklets(
      "<item><h>2</h><w>2</w><l>4</l><first_frame>1e30</first_frame><poses></poses></item>");
  EXPECT_THAT(message(), HasSubstr("<first_frame> is no index of a frame"));
  write(inDrive("tracklet_labels.xml"), "<tracklets><item>");
  EXPECT_THAT(message(), HasSubstr("ends within a tracklet"));
  write(inDrive("tracklet_labels.xml"), "nothing");
  EXPECT_THAT(message(), HasSubstr("contains no <tracklets>"));
  write(inDrive("image_00/timestamps.txt"), "2011-09-26 13:04:32.0\n");
  EXPECT_THAT(message(), HasSubstr("timestamps.txt: has 1 times, none for image 1"));
  write(inDrive("image_00/timestamps.txt"), "yesterday\n");
  EXPECT_THAT(message(), HasSubstr("timestamps.txt:1: is not a time"));
  write("2011_09_26/calib_cam_to_cam.txt", kCameras + std::string("S_rect_00: 1e30 120\n"));
  EXPECT_THAT(message(), HasSubstr("S_rect_00 is no size"));
  write("2011_09_26/calib_cam_to_cam.txt", "P_rect_00: 1 2 3\n");
  EXPECT_THAT(message(), HasSubstr("calib_cam_to_cam.txt: no line 'P_rect_00:' of 12 numbers"));
}

TEST_F(KittiRawTest, UnrectifiedDrivesAreRefused) {
  std::string calibration = kCameras;
  calibration.replace(calibration.find("160 120"), 7, "140 100");
  write("2011_09_26/calib_cam_to_cam.txt", calibration);
  EXPECT_THAT(message(), HasSubstr("has 160x120 pixels, but the calibration's rectified images "
                                   "have 140x100; only rectified drives"));
}

class KittiTrackingImagesTest : public KittiRawTest {
 protected:
  void SetUp() override {
    KittiRawTest::SetUp();
    write("training/label_02/0001.txt",
          "1 5 Car 0 0 0 50 20 60 40 1.5 1.6 4 1 1.7 20 0\n"
          "1 -1 DontCare -1 -1 -10 1 2 3 4 -1000 -1000 -1000 -10 -1 -1 -1\n"
          "7 5 Car 0 0 0 50 20 60 40 1.5 1.6 4 1 1.7 20 0\n");
    write("training/calib/0001.txt",
          "P0: 100 0 80 0 0 100 60 0 0 0 1 0\nP1: 100 0 80 -50 0 100 60 0 0 0 1 0\n"
          "P2: 100 0 80 6 0 100 60 0.2 0 0 1 0.003\n");
  }
  std::unique_ptr<Dataset> openLabelled(std::optional<KittiBoxes> boxes = std::nullopt) {
    return openKittiTracking(folder_.path(), "0001", boxes,
                             folder_ / (std::string("2011_09_26/") + kDrive), OxtsPath::kPositions);
  }
};

TEST_F(KittiTrackingImagesTest, LabelsArePairedWithTheImagesOfTheDrive) {
  const auto dataset = openLabelled();
  ASSERT_EQ(4u, dataset->size());
  const auto frame = dataset->frame(1);
  EXPECT_TRUE(test::sameImage(test::wall(1).left, frame.left));
  EXPECT_NEAR(kStart_s + 0.1, frame.time, 1e-6);
  EXPECT_FALSE(frame.T_map_robot);  // SLAM is to run
  EXPECT_FALSE(frame.detections);
  EXPECT_TRUE(frame.truth_T_map_robot);
  ASSERT_EQ(1u, frame.truth_objects->items.size());
  // Camera 2 is 6 cm left of camera 0: at 20 m its image is displaced by 0.3 px.
  EXPECT_NEAR(49.7, frame.truth_objects->items[0].box2d->left, 1e-9);
  EXPECT_TRUE(dataset->frame(0).truth_objects->items.empty());
  EXPECT_EQ(4u, dataset->gnss().size());
  EXPECT_THAT(dataset->dropped(), ElementsAre(Pair("frame_without_image", 1u)));
}

TEST_F(KittiTrackingImagesTest, BoxesAreRecordedOnRequest) {
  const auto frame = openLabelled(KittiBoxes::kLabels)->frame(1);
  ASSERT_TRUE(frame.detections);
  EXPECT_EQ(1u, frame.detections->items.size());
}

TEST_F(KittiTrackingImagesTest, AnotherDrivesCameraAndMissingImagesAreErrors) {
  write("training/calib/0001.txt",
        "P0: 101 0 80 0 0 101 60 0 0 0 1 0\nP1: 101 0 80 -50 0 101 60 0 0 0 1 0\n");
  const auto text = [&] { return test::errorOf([&] { (void)openLabelled(); }); };
  EXPECT_THAT(text(), HasSubstr("calib/0001.txt: P0 is not the left camera of the drive"));
  fs::remove(folder_ / inDrive("image_00/data/" + number(1) + ".png"));
  EXPECT_THAT(text(), HasSubstr("image 1 is missing"));
}

TEST(KittiRawRealDataTest, TruthOfDrive5AgreesWithTheLabelsOfTracking0000) {
  HEADWAY_REQUIRE_DATA(data);
  const auto raw = openKittiRaw((data / "kitti_raw").string(), "2011_09_26_drive_0005_sync",
                                OxtsPath::kPositions);
  const auto labelled = openKittiTracking(
      (data / "kitti_tracking").string(), "0000", std::nullopt,
      (data / "kitti_raw/2011_09_26/2011_09_26_drive_0005_sync").string(), OxtsPath::kPositions);
  ASSERT_EQ(110u, raw->size());
  ASSERT_EQ(110u, labelled->size());
  EXPECT_THAT(raw->dropped(), Contains(Pair("tracklet_outside_image", 14u)));
  const auto truth = raw->frame(109).truth_T_map_robot;
  ASSERT_TRUE(truth);
  EXPECT_GT(truth->translation().norm(), 40.0);
  EXPECT_LT(std::abs(truth->translation().z()), 1.0);  // the street is level
  // Tracklets and labels are two versions of the same annotation.
  const auto tracklets = raw->frame(50).truth_objects->items;
  const auto labels = labelled->frame(50).truth_objects->items;
  std::size_t same = 0;
  for (const auto& label : labels) {
    for (const auto& tracklet : tracklets) {
      const bool is_near = (label.box3d->centre - tracklet.box3d->centre).norm() < 0.2;
      const bool same_heading = std::abs(wrapAngle(label.box3d->yaw - tracklet.box3d->yaw)) < 0.1;
      if (label.object_class == tracklet.object_class && is_near && same_heading) ++same;
    }
  }
  EXPECT_EQ(labels.size(), same);
  EXPECT_GE(same, 2u);
}

}  // namespace
}  // namespace headway::io
