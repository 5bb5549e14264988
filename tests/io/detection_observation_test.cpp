// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/io/detection_observation.h>
#include <headway/io/rawlog_sink.h>
#include <headway_test/folders.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>

#include "object_bytes.h"
#include "observation_stream.h"
#include "processes.h"
#include "synthetic_recording.h"

#ifdef __SANITIZE_ADDRESS__  // by GCC
#define HEADWAY_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)  // by clang
#define HEADWAY_SANITIZED
#endif
#endif

namespace headway::io {
namespace {

using ::testing::HasSubstr;

Detections everyKindOfBox() {
  Detections detections;
  detections.time = 12.5;
  detections.T_robot_sensor.translation() << 1, 2, 3;
  detections.image_width = 640;
  detections.image_height = 480;
  Detection both;
  both.object_class = ObjectClass::kCar;
  both.score = 0.75;
  both.detector_id = 42;
  both.box2d = Box2d{1, 2, 3, 4};
  both.box3d = Box3d{{1.5, 2.5, 30.25}, 4, 2, 1.5, -1.25};
  both.centre_covariance = Eigen::Matrix3d::Identity();
  (*both.centre_covariance)(0, 1) = (*both.centre_covariance)(1, 0) = 0.5;
  Detection flat;
  flat.object_class = ObjectClass::kPedestrian;
  flat.box2d = Box2d{5, 6, 7, 8};
  Detection broken;
  broken.object_class = ObjectClass::kUnknown;
  broken.box3d = Box3d{{NAN, 0, -5}, 1, 1, 1, 0};
  detections.items = {both, flat, broken};
  return detections;
}

CObservationObjectDetections::Ptr throughArchive(const CObservationObjectDetections& observation) {
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << observation;
  stream.Seek(0);
  return archive.ReadObject<CObservationObjectDetections>();
}

TEST(DetectionObservationTest, KeepsEverythingThroughSerialisation) {
  registerClasses();
  const auto original = everyKindOfBox();
  const auto read = throughArchive(*observationFrom("detections", original));
  ASSERT_NE(nullptr, read);
  EXPECT_EQ("detections", read->sensorLabel);
  std::map<std::string, std::size_t> dropped;
  const auto copy = detectionsFrom(*read, dropped);
  EXPECT_TRUE(dropped.empty());
  EXPECT_EQ(original.time, copy.time);
  EXPECT_EQ(640, copy.image_width);
  EXPECT_TRUE(original.T_robot_sensor.isApprox(copy.T_robot_sensor, 1e-12));
  ASSERT_EQ(3u, copy.items.size());
  EXPECT_EQ(42, copy.items[0].detector_id);
  EXPECT_EQ(0.75, copy.items[0].score);
  EXPECT_EQ(4.0, copy.items[0].box2d->bottom);
  EXPECT_EQ(original.items[0].box3d->centre, copy.items[0].box3d->centre);
  EXPECT_EQ(-1.25, copy.items[0].box3d->yaw);
  EXPECT_EQ(*original.items[0].centre_covariance, *copy.items[0].centre_covariance);
  EXPECT_FALSE(copy.items[1].detector_id);
  EXPECT_FALSE(copy.items[1].box3d);
  EXPECT_EQ(ObjectClass::kUnknown, copy.items[2].object_class);
  EXPECT_TRUE(std::isnan(copy.items[2].box3d->centre.x()));
}

TEST(DetectionObservationTest, CountsUnknownClasses) {
  auto observation = observationFrom("detections", everyKindOfBox());
  observation->items[0].class_name = "Unicorn";
  std::map<std::string, std::size_t> dropped;
  EXPECT_EQ(2u, detectionsFrom(*observation, dropped).items.size());
  EXPECT_EQ(1u, dropped["unknown_class"]);
}

TEST(DetectionObservationTest, ANewerVersionIsRefused) {
  registerClasses();
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << *observationFrom("detections", everyKindOfBox());
  std::string bytes(static_cast<const char*>(stream.getRawBufferData()),
                    stream.getTotalBytesCount());
  const std::string name = "headway::CObservationObjectDetections";
  bytes.at(1 + name.size()) = 7;  // the version follows the length byte and the name
  mrpt::io::CMemoryStream newer;
  newer.Write(bytes.data(), bytes.size());
  newer.Seek(0);
  auto newer_archive = mrpt::serialization::archiveFrom(newer);
  EXPECT_THROW((void)newer_archive.ReadObject(), std::exception);
}

TEST(DetectionObservationTest, AFlagThatIsNeither0Nor1IsRefused) {
  registerClasses();
  const headway::test::TemporaryFolder folder;
  auto observation = observationFrom("detections", everyKindOfBox());
  observation->items.resize(1);
  const std::string bytes = test::mrptBytes(*observation);
  ASSERT_NE(nullptr, test::mrptRead(bytes));
  // From the end: an end mark; a covariance, a 3D and a 2D box, each after its flag.
  const std::size_t covariance = bytes.size() - 1 - 6 * sizeof(double) - 1;
  const std::size_t box3d = covariance - 7 * sizeof(double) - 1;
  for (const std::size_t flag : {covariance, box3d, box3d - 4 * sizeof(double) - 1}) {
    std::string broken = bytes;
    ASSERT_EQ('\1', broken[flag]);
    broken[flag] = '\2';
    EXPECT_THROW((void)test::mrptRead(broken), std::exception) << "by MRPT's programs";
    test::writeContent(folder / "x.rawlog", broken + bytes);
    std::map<std::string, std::size_t> skipped;
    ObservationStream stream(folder / "x.rawlog", skipped);
    EXPECT_NE(nullptr, stream.next()) << "the second one";
    EXPECT_EQ(nullptr, stream.next());
    EXPECT_EQ(1u, skipped["unreadable_CObservationObjectDetections"]);
  }
}

TEST(DetectionObservationTest, HasADescription) {
  const auto observation = observationFrom("detections", everyKindOfBox());
  EXPECT_THAT(observation->asString(),
              ::testing::AllOf(HasSubstr("Detections: 3"), HasSubstr("Car score 0.75 id 42"),
                               HasSubstr("box2d 5 6 7 8"), HasSubstr("640 x 480")));
  EXPECT_THAT(observation->exportTxtDataRow(), HasSubstr("3 Car 0.75 42 box2d 1 2 3 4 box3d 1.5"));
  EXPECT_FALSE(observation->exportTxtHeader().empty());
}

TEST(DetectionPluginTest, RawlogEditReadsTheObservations) {
#ifdef HEADWAY_SANITIZED
  GTEST_SKIP() << "stock programs cannot load a plug-in built with a sanitizer";
#endif
  if (!test::programExists("rawlog-edit")) GTEST_SKIP() << "rawlog-edit is not installed";
  const headway::test::TemporaryFolder folder;
  const std::string path = folder / "x.rawlog";
  {
    RawlogSink sink(path, ImageStorage::kEmbedded);
    sink.writeDetections("detections", everyKindOfBox());
    sink.writePose("pose", 12.5, Pose::Identity());
  }
  const auto without = test::runProcess("rawlog-edit --info -i " + path);
  EXPECT_THAT(without.output, HasSubstr("not registered"));
  const auto info =
      test::runProcess("rawlog-edit -p " + std::string(HEADWAY_PLUGIN) + " --info -i " + path);
  EXPECT_EQ(0, info.status) << info.output;
  EXPECT_THAT(info.output, ::testing::ContainsRegex("Overall number of objects +: 2"));
  EXPECT_THAT(info.output, HasSubstr("detections, pose"));
  const auto text = test::runProcess("cd " + folder.path().string() + " && rawlog-edit -p " +
                                     HEADWAY_PLUGIN + " --export-txt -i x.rawlog");
  EXPECT_EQ(0, text.status) << text.output;
  EXPECT_THAT(test::contentOf(folder / "x_detections.txt"), HasSubstr("Car 0.75 42"));
}

}  // namespace
}  // namespace headway::io
