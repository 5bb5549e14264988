// SPDX-License-Identifier: BSD-3-Clause
// What recordings differ in: encodings, lenses, missing transforms and times, selections.
#include <gmock/gmock.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationStereoImages.h>

#include <fstream>
#include <opencv2/core.hpp>

#include "imported_bag.h"

namespace headway::bags {
namespace {

using mrpt::img::DistortionModel;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr test::BagFormat kRos1 = {"bag", "lz4"};
constexpr test::BagFormat kMcap = {"mcap", "zstd"};

class BagVariantsTest : public test::BagTest {
 protected:
  [[nodiscard]] auto pairs() const { return observations<mrpt::obs::CObservationStereoImages>(); }
};

TEST_F(BagVariantsTest, CompressedAndColourImages) {
  HEADWAY_WRITE_BAG(kRos1, "compressed", at("b.bag"));
  ASSERT_EQ(0, import(at("b.bag") + " -o " + at("x.rawlog")).status);
  ASSERT_EQ(12u, pairs().size());
  EXPECT_TRUE(test::sameImage(test::recordedPicture(4, 11), pairs()[4]->imageRight.asCvMatRef()));
  HEADWAY_WRITE_BAG(kRos1, "rgb", at("b.bag"));
  ASSERT_EQ(0, import(at("b.bag") + " -w -o " + at("x.rawlog")).status);
  ASSERT_EQ(12u, pairs().size());
  const int red = test::recordedPicture(4).at<std::uint8_t>(9, 8);
  const cv::Mat image = pairs()[4]->imageLeft.asCvMatRef();
  EXPECT_EQ(red, image.at<cv::Vec3b>(9, 8)[2]);
  EXPECT_EQ(17, image.at<cv::Vec3b>(9, 8)[0]);
}

TEST_F(BagVariantsTest, FisheyesAndRationalLenses) {
  HEADWAY_WRITE_BAG(kRos1, "fisheye", at("b.bag"));
  ASSERT_EQ(0, import(at("b.bag") + " -o " + at("x.rawlog")).status);
  EXPECT_EQ(DistortionModel::kannala_brandt, pairs()[0]->leftCamera.distortion);
  EXPECT_EQ(0.002, pairs()[0]->rightCamera.k4());
  HEADWAY_WRITE_BAG(kRos1, "rational", at("b.bag"));
  ASSERT_EQ(0, import(at("b.bag") + " -w -o " + at("x.rawlog")).status);
  EXPECT_EQ(DistortionModel::plumb_bob, pairs()[0]->leftCamera.distortion);
  EXPECT_EQ(0.6, pairs()[0]->leftCamera.k6());
}

TEST_F(BagVariantsTest, DepthInMetresAndCompressed) {
  for (const auto& [format, form] :
       {std::pair(kMcap, "rgbd_float"), std::pair(kRos1, "rgbd_compressed")}) {
    const std::string bag = at(std::string("b.") + format.ending);
    HEADWAY_WRITE_BAG(format, form, bag);
    const auto result = import(bag + " -w -o " + at("x.rawlog"));
    ASSERT_EQ(0, result.status) << result.output;
    const auto frames = observations<mrpt::obs::CObservation3DRangeScan>();
    ASSERT_EQ(12u, frames.size());
    const cv::Mat expected = test::recordedDepth(5);
    for (const auto& [u, v] : {std::pair(0, 0), std::pair(3, 3), std::pair(63, 47)}) {
      EXPECT_EQ(expected.at<std::uint16_t>(v, u), frames[5]->rangeImage(v, u)) << form;
    }
  }
}

TEST_F(BagVariantsTest, WithoutTransformsTheRobotIsAtTheCamera) {
  HEADWAY_WRITE_BAG(kRos1, "no_tf", at("b.bag"));
  const auto result = import(at("b.bag") + " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, AllOf(HasSubstr("note: the mounting of the camera is unknown"),
                                   HasSubstr("skipped no_tf_of_frame_base_link 11"),
                                   HasSubstr("no_tf_of_frame_imu_link 120"),
                                   HasSubstr("no_tf_of_frame_laser 12")));
  EXPECT_TRUE(fromMrpt(pairs()[0]->cameraPose).isApprox(robotFromOptical(), 1e-6));
  EXPECT_TRUE(observations<mrpt::obs::CObservationIMU>().empty());
}

TEST_F(BagVariantsTest, AnotherFrameOfTheRobot) {
  HEADWAY_WRITE_BAG(kRos1, "mono", at("b.bag"));
  ASSERT_EQ(0, import(at("b.bag") + " --base base_footprint -o " + at("x.rawlog")).status);
  EXPECT_NEAR(0.6, pairs()[0]->cameraPose.z(), 1e-6);
  const auto unknown = import(at("b.bag") + " --base wheel -w -o " + at("x.rawlog"));
  EXPECT_EQ(1, unknown.status);
  EXPECT_THAT(unknown.output, HasSubstr("tf does not connect it with 'left_optical'"));
}

TEST_F(BagVariantsTest, MissingTimesAreThoseOfTheRecording) {
  HEADWAY_WRITE_BAG(kRos1, "no_stamps", at("b.bag"));
  const auto result = import(at("b.bag") + " -o " + at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("header_without_time 24"));
  EXPECT_NEAR(test::kRecordedStart + 0.12, io::timeFrom(pairs()[1]->timestamp), 1e-6);
}

TEST_F(BagVariantsTest, RefusalsNameTheCause) {
  HEADWAY_WRITE_BAG(kRos1, "mono16", at("b.bag"));
  const std::string call = at("b.bag") + " -w -o " + at("x.rawlog");
  EXPECT_THAT(import(call).output, HasSubstr("image_encoding_mono16 24"));
  HEADWAY_WRITE_BAG(kRos1, "unsynchronised", at("b.bag"));
  const auto unsynchronised = import(call);
  EXPECT_EQ(1, unsynchronised.status);
  EXPECT_THAT(unsynchronised.output, HasSubstr("differ by 30 ms or more, allowed are 10 ms"));
  HEADWAY_WRITE_BAG(kRos1, "mono", at("b.bag"));
  EXPECT_THAT(import(call + " --left /nowhere").output,
              AllOf(HasSubstr("no topic /nowhere"), HasSubstr("/stereo/left/image_raw")));
  EXPECT_THAT(import(call + " --imu /scan").output,
              HasSubstr("/scan has the type sensor_msgs/LaserScan, must be sensor_msgs/Imu"));
  EXPECT_THAT(import(call + " --from-index 99").output, HasSubstr("has only 12 frames"));
  std::ofstream(at("c.yaml")) << "image_size: [640, 480]\nleft: [500, 500, 320, 240]\n"
                                 "baseline_m: 0.1\n";
  EXPECT_THAT(import(call + " --calibration " + at("c.yaml")).output,
              AllOf(HasSubstr("64x48"), HasSubstr("640x480")));
  EXPECT_FALSE(std::filesystem::exists(at("x.rawlog")));
  EXPECT_EQ(2, import(at("b.bag")).status);
  EXPECT_EQ(1, import("/nowhere.bag --list").status);
}

TEST_F(BagVariantsTest, SensorsAndFramesCanBeLeftOut) {
  HEADWAY_WRITE_BAG(kRos1, "mono", at("b.bag"));
  const auto result = import(at("b.bag") +
                             " --imu none --scan none --gps none --odom none --from-index 2 "
                             "--to-index 4 -o " +
                             at("x.rawlog"));
  ASSERT_EQ(0, result.status) << result.output;
  EXPECT_THAT(result.output, HasSubstr("x.rawlog: 3 frames\n"));
  ASSERT_EQ(3u, allObservations().size());
  EXPECT_NEAR(test::kRecordedStart + 0.2, io::timeFrom(pairs()[0]->timestamp), 1e-6);
  const auto part = import(at("b.bag") + " --from-index 2 --to-index 4 -w -o " + at("x.rawlog"));
  const auto samples = observations<mrpt::obs::CObservationIMU>().size();
  EXPECT_EQ(40u, samples) << "those between frame 1 and frame 5";
  EXPECT_THAT(part.output, HasSubstr("3 frames, " + std::to_string(samples) + " inertial samples"));
}

TEST_F(BagVariantsTest, APartCountsWhatWasSkippedInItAlone) {
  HEADWAY_WRITE_BAG(kRos1, "no_tf", at("b.bag"));
  const auto part = import(at("b.bag") + " --from-index 2 --to-index 4 -o " + at("x.rawlog"));
  EXPECT_THAT(part.output,
              AllOf(HasSubstr("x.rawlog: 3 frames"), HasSubstr("no_tf_of_frame_imu_link 30"),
                    HasSubstr("no_tf_of_frame_laser 3"), Not(HasSubstr("unpaired"))))
      << "a second was read beyond frame 4, to put observations in order";
}

TEST_F(BagVariantsTest, FilesOfASplitBagAreReadInOrder) {
  std::filesystem::create_directories(at("split"));
  HEADWAY_WRITE_BAG(kMcap, "mono", at("split/b_0.mcap"));
  std::filesystem::copy(at("split/b_0.mcap"), at("split/b_1.mcap"));
  EXPECT_THAT(import(at("split") + " --list").output, HasSubstr("/imu/data  sensor_msgs/Imu  240"));
  const auto result = import(at("split") + " -o " + at("x.rawlog"));
  EXPECT_THAT(result.output, HasSubstr("24 frames, 240 inertial samples"));
  std::filesystem::create_directories(at("empty"));
  EXPECT_THAT(import(at("empty") + " --list").output, HasSubstr("contains no .mcap and no .db3"));
}

TEST_F(BagVariantsTest, TheTenthFileOfASplitBagFollowsTheNinth) {
  std::filesystem::create_directories(at("split"));
  HEADWAY_WRITE_BAG(kMcap, "mono", at("split/b_9.mcap"));
  HEADWAY_WRITE_BAG(kMcap, "rgbd", at("split/b_10.mcap"));
  const std::string topics = import(at("split") + " --list").output;
  const auto of_9 = topics.find("/stereo/left/image_raw");
  const auto of_10 = topics.find("/camera/color/image_raw");
  ASSERT_NE(std::string::npos, of_10) << topics;
  EXPECT_LT(of_9, of_10) << "topics are listed as they come";
}

TEST_F(BagVariantsTest, ACalibrationFileReplacesCameraInfo) {
  HEADWAY_WRITE_BAG(kMcap, "mono", at("b.mcap"));
  std::ofstream(at("c.yaml")) << "image_size: [64, 48]\nleft: [60, 60, 32, 24]\nbaseline_m: 0.2\n";
  const std::string call = at("b.mcap") + " --calibration " + at("c.yaml") + " -o ";
  ASSERT_EQ(0, import(call + at("x.rawlog")).status);
  EXPECT_EQ(60.0, pairs()[0]->leftCamera.fx());
  EXPECT_NEAR(0.2, pairs()[0]->rightCameraPose.x(), 1e-9);
  EXPECT_NEAR(0.5, pairs()[0]->cameraPose.z(), 1e-6) << "the mounting is still that of tf";
}

}  // namespace
}  // namespace headway::bags
