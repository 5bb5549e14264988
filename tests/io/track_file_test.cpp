// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/track_file.h>
#include <headway_test/folders.h>

#include <cmath>
#include <sstream>

#include "synthetic_recording.h"

namespace headway::io {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

constexpr char kCarLabel[] = "3 7 Car 0 1 -1.5 100.5 120.25 200 180 1.5 1.6 4.2 2 1.7 20 -1.57";
constexpr char kDontCare[] = "0 -1 DontCare -1 -1 -10 1 2 3 4 -1000 -1000 -1000 -10 -1 -1 -1";

class TrackFileTest : public ::testing::Test {
 protected:
  std::string written(const std::string& name, const std::string& text) {
    const auto path = folder_ / name;
    test::writeContent(path, text);
    return path;
  }
  std::map<std::size_t, Detections> detections(const std::string& name, const std::string& text) {
    dropped_.clear();
    return readDetections(written(name, text), dropped_);
  }

  headway::test::TemporaryFolder folder_;
  std::map<std::string, std::size_t> dropped_;
};

TEST_F(TrackFileTest, KittiLabelsAreReadFieldByField) {
  const auto rows = readKittiRows(written("l.txt", std::string(kCarLabel) + "\n" + kDontCare));
  ASSERT_EQ(2u, rows.size());
  EXPECT_EQ(3u, rows[0].frame);
  EXPECT_EQ(7, rows[0].id);
  EXPECT_EQ("Car", rows[0].type);
  EXPECT_EQ(1, rows[0].occlusion);
  EXPECT_EQ(120.25, rows[0].box2d.top);
  EXPECT_EQ(1.5, rows[0].height);
  EXPECT_EQ(4.2, rows[0].length);
  EXPECT_EQ(Eigen::Vector3d(2, 1.7, 20), rows[0].bottom_centre);
  EXPECT_EQ(-1.57, rows[0].rotation_y);
  EXPECT_EQ("DontCare", rows[1].type);
}

TEST_F(TrackFileTest, PersonInLabelsIsASittingPerson) {
  const auto found = detections("p.txt", "0 4 Person 0 0 0 1 2 3 4 1.3 0.6 0.8 1 1.7 9 0\n");
  EXPECT_TRUE(dropped_.empty());
  EXPECT_EQ(ObjectClass::kPersonSitting, found.at(0).items.at(0).object_class);
}

TEST_F(TrackFileTest, DetectionsSurviveTheRoundTrip) {
  Detection whole;
  whole.object_class = ObjectClass::kVan;
  whole.score = 0.625;
  whole.detector_id = 12;
  whole.box2d = Box2d{1.5, 2.5, 30.25, 40.0};
  whole.box3d = Box3d{{1.0, 0.5, 12.25}, 5.0, 2.0, 2.25, -1.5};
  whole.centre_covariance = Eigen::Vector3d(0.25, 0.5, 2.0).asDiagonal();
  Detection flat;
  flat.box2d = Box2d{5, 6, 7, 8};
  std::ostringstream text;
  text << detectionCsvHeader() << '\n';
  writeDetectionCsv(text, 4, whole);
  writeDetectionCsv(text, 4, flat);
  const auto frames = detections("boxes.csv", text.str());
  EXPECT_TRUE(dropped_.empty());
  ASSERT_EQ(2u, frames.at(4).items.size());
  const Detection& read = frames.at(4).items[0];
  EXPECT_EQ(whole.object_class, read.object_class);
  EXPECT_EQ(whole.score, read.score);
  EXPECT_EQ(whole.detector_id, read.detector_id);
  EXPECT_EQ(whole.box2d->right, read.box2d->right);
  EXPECT_EQ(whole.box3d->centre, read.box3d->centre);
  EXPECT_EQ(whole.box3d->yaw, read.box3d->yaw);
  EXPECT_EQ(*whole.centre_covariance, *read.centre_covariance);
  EXPECT_FALSE(frames.at(4).items[1].box3d);
  EXPECT_FALSE(frames.at(4).items[1].detector_id);
}

TEST_F(TrackFileTest, KittiRowsSurviveTheRoundTrip) {
  auto row = readKittiRows(written("l.txt", kCarLabel)).front();
  row.score = 12.5;
  row.visible = 0.75;
  std::ostringstream result, label, plain;
  writeKittiResult(result, row);
  writeKittiLabel(label, row, true);
  writeKittiLabel(plain, row, false);
  EXPECT_EQ(12.5, readKittiRows(written("r.txt", result.str())).front().score);
  EXPECT_EQ(0.75, readKittiRows(written("v.txt", label.str())).front().visible);
  const auto again = readKittiRows(written("p.txt", plain.str())).front();
  EXPECT_EQ(row.bottom_centre, again.bottom_centre);
  EXPECT_EQ(row.box2d.left, again.box2d.left);
  EXPECT_EQ(row.alpha, again.alpha);
  EXPECT_EQ(1.0, again.visible);
}

TEST_F(TrackFileTest, KittiErrorsNameFileAndLine) {
  const auto message = [&](const std::string& text) {
    return test::errorOf([&] { (void)readKittiRows(written("bad.txt", text)); });
  };
  EXPECT_THAT(message(std::string(kCarLabel) + "\n1 2 Car\n"),
              HasSubstr("bad.txt:2: has 3 fields"));
  EXPECT_THAT(message("-1" + std::string(kCarLabel + 1)), HasSubstr("negative"));
  EXPECT_THAT(message("x" + std::string(kCarLabel + 1)), HasSubstr("'x' in field 1"));
}

TEST_F(TrackFileTest, BoxOfARowIsCentredInItsVolume) {
  const auto detection = detectionFrom(readKittiRows(written("l.txt", kCarLabel)).front());
  ASSERT_TRUE(detection && detection->box3d && detection->box2d);
  EXPECT_EQ(ObjectClass::kCar, detection->object_class);
  EXPECT_TRUE(detection->box3d->centre.isApprox(Eigen::Vector3d(2, 1.7 - 0.75, 20)));
  EXPECT_EQ(4.2, detection->box3d->length);
  EXPECT_EQ(1.6, detection->box3d->width);
  EXPECT_EQ(-1.57, detection->box3d->yaw);
  EXPECT_EQ(7, detection->detector_id);
  EXPECT_EQ(1.0, detection->score);
  EXPECT_FALSE(detectionFrom(readKittiRows(written("d.txt", kDontCare)).front()));
}

TEST_F(TrackFileTest, RowsWithoutA3dBoxHaveNone) {
  const auto row = readKittiRows(
      written("r.txt", "0 1 Car -1 -1 -10 1 2 3 4 -1 -1 -1 -1000 -1000 -1000 -10 0.9"));
  const auto detection = detectionFrom(row.front());
  ASSERT_TRUE(detection);
  EXPECT_FALSE(detection->box3d);
  EXPECT_TRUE(detection->box2d);
}

TEST_F(TrackFileTest, TrackCsvSurvivesTheRoundTrip) {
  TrackSample sample;
  sample.frame = 12;
  sample.time = 1403636584.5;
  sample.track.id.value = 4;
  sample.track.object_class = ObjectClass::kPersonSitting;
  sample.track.status = TrackStatus::kCoasting;
  sample.track.motion_state = MotionState::kMoving;
  sample.track.position = {1.5, -2.25, 0.125};
  sample.track.velocity = {0.5, -0.5, 0.25};
  sample.track.yaw = -3.0;
  sample.track.size = {4, 2, 1.5};
  sample.track.position_covariance << 0.25, 0.0625, 0, 0.0625, 0.5, 0, 0, 0, 1;
  sample.track.velocity_covariance << 0.5, -0.125, -0.125, 2.0;
  std::ostringstream text;
  text << trackCsvHeader() << "\n";
  writeTrackCsv(text, sample);
  const auto read = readTrackCsv(written("tracks.csv", text.str()));
  ASSERT_EQ(1u, read.size());
  EXPECT_EQ(12u, read[0].frame);
  EXPECT_EQ(sample.time, read[0].time);
  EXPECT_EQ(sample.track.id, read[0].track.id);
  EXPECT_EQ(sample.track.object_class, read[0].track.object_class);
  EXPECT_EQ(sample.track.status, read[0].track.status);
  EXPECT_TRUE(isMoving(read[0].track));
  EXPECT_EQ(sample.track.position, read[0].track.position);
  EXPECT_EQ(sample.track.velocity, read[0].track.velocity);
  EXPECT_EQ(sample.track.size, read[0].track.size);
  EXPECT_EQ(sample.track.position_covariance, read[0].track.position_covariance);
  EXPECT_EQ(sample.track.velocity_covariance, read[0].track.velocity_covariance);
}

TEST_F(TrackFileTest, TrackCsvMayHaveFurtherColumnsInAnyOrder) {
  const auto read = readTrackCsv(
      written("objects.csv",
              "visible,frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,"
              "vz,var_x,var_y,cov_xy\n0.5,1,0.1,2,Car,confirmed,0,1,2,3,0,4,5,6,0,0,0,1,1,0\n"));
  ASSERT_EQ(1u, read.size());
  EXPECT_EQ(3.0, read[0].track.position.z());
  EXPECT_TRUE(read[0].track.velocity_covariance.isZero()) << "files of older versions";
}

TEST_F(TrackFileTest, TrackCsvErrorsNameFileAndLine) {
  const auto message = [&](const std::string& text) {
    return test::errorOf([&] { (void)readTrackCsv(written("t.csv", text)); });
  };
  const std::string header = objectCsvHeader() + "\n";
  EXPECT_THAT(message(""), HasSubstr("header line is missing"));
  EXPECT_THAT(message("frame,time\n"), HasSubstr("t.csv:1: column 'track_id' is missing"));
  EXPECT_THAT(message(header + "1,2\n"), HasSubstr("t.csv:2: has 2 fields"));
  EXPECT_THAT(message(header + "1,0,2,Dog,confirmed,0,1,2,3,0,4,5,6,0,0,0,1,1,0\n"),
              HasSubstr("'Dog' is not a class"));
  EXPECT_THAT(message(header + "1,0,2,Car,asleep,0,1,2,3,0,4,5,6,0,0,0,1,1,0\n"),
              HasSubstr("'asleep' is not a track status"));
}

TEST_F(TrackFileTest, PredictionCsvSurvivesTheRoundTrip) {
  PredictionRow row;
  row.frame = 3;
  row.time = 0.5;
  row.id.value = 9;
  row.object_class = ObjectClass::kCyclist;
  row.mode = 2;
  row.probability = 0.25;
  row.point.horizon_s = 1.1;
  row.point.position = {1, 2, 3};
  row.point.covariance << 1, 0.5, 0.5, 2;
  std::ostringstream text;
  text << predictionCsvHeader() << "\n";
  writePredictionCsv(text, row);
  const auto read = readPredictionCsv(written("p.csv", text.str()));
  ASSERT_EQ(1u, read.size());
  EXPECT_EQ(row.id, read[0].id);
  EXPECT_EQ(2, read[0].mode);
  EXPECT_EQ(1.1, read[0].point.horizon_s);
  EXPECT_EQ(row.point.position, read[0].point.position);
  EXPECT_EQ(row.point.covariance, read[0].point.covariance);
}

TEST_F(TrackFileTest, PredictionsAreVisitedAtMultiplesOfAHorizon) {
  std::ostringstream text;
  text << predictionCsvHeader() << "\n";
  for (int i = 1; i <= 30; ++i) {
    PredictionRow row;
    row.point.horizon_s = 0.1 * i;
    writePredictionCsv(text, row);
  }
  const std::string path = written("p.csv", text.str());
  std::vector<double> horizons;
  const auto add = [&](const PredictionRow& row) { horizons.push_back(row.point.horizon_s); };
  visitPredictionCsv(path, add, 0.5);
  EXPECT_THAT(horizons, ElementsAre(0.5, 1.0, 1.5, 2.0, 2.5, 3.0));
  horizons.clear();
  visitPredictionCsv(path, add);
  EXPECT_EQ(30u, horizons.size());
}

TEST_F(TrackFileTest, ObjectsHaveTheirVisibleRatio) {
  const std::string row = "0,1.5,7,Car,confirmed,1,1,2,3,0,4,2,1.5,0,0,0,0.1,0.1,0";
  const auto with =
      readObjectCsv(written("o.csv", objectCsvHeader() + ",visible\n" + row + ",0.25\n"));
  ASSERT_EQ(1u, with.size());
  EXPECT_EQ(0.25, with[0].visible);
  EXPECT_EQ(7, with[0].object.track.id.value);
  EXPECT_EQ(1.0, readObjectCsv(written("t.csv", objectCsvHeader() + "\n" + row + "\n"))[0].visible);
}

TEST_F(TrackFileTest, DistinguishesDetectionFormats) {
  const auto kitti = detections("k.txt", std::string(kCarLabel) + "\n" + kDontCare + "\n" +
                                             "3 8 Dog 0 1 0 1 2 3 4 1 1 1 0 0 5 0\n");
  ASSERT_THAT(kitti, ElementsAre(Pair(3u, ::testing::_)));
  EXPECT_THAT(dropped_, UnorderedElementsAre(Pair("dont_care", 1u), Pair("unknown_class", 1u)));

  const auto det3d = detections("d.txt",
                                "2,2,1,2,3,4,9.5,1.5,1.6,4.2,2,1.7,20,0.5,0\n"
                                "2,1,1,2,3,4,-3,1.7,0.6,0.8,1,1.6,9,0.1,0\n"
                                "2,9,1,2,3,4,-3,1.7,0.6,0.8,1,1.6,9,0.1,0\n");
  ASSERT_EQ(2u, det3d.at(2).items.size());
  EXPECT_EQ(ObjectClass::kCar, det3d.at(2).items[0].object_class);
  EXPECT_EQ(9.5, det3d.at(2).items[0].score);
  EXPECT_NEAR(1.7 - 0.75, det3d.at(2).items[0].box3d->centre.y(), 1e-12);
  EXPECT_EQ(ObjectClass::kPedestrian, det3d.at(2).items[1].object_class);
  EXPECT_THAT(dropped_, ElementsAre(Pair("unknown_class", 1u)));

  const auto det2d = detections("Cyclist/d.txt", "4,1,2,3,4,0.9\n");
  EXPECT_EQ(ObjectClass::kCyclist, det2d.at(4).items[0].object_class);
  EXPECT_FALSE(det2d.at(4).items[0].box3d);
  EXPECT_THAT(test::errorOf([&] { (void)detections("somewhere/d.txt", "4,1,2,3,4,0.9\n"); }),
              HasSubstr("folder 'somewhere'"));
}

TEST_F(TrackFileTest, CsvDetectionsHaveNamedColumns) {
  const auto read =
      detections("d.csv",
                 "frame,class,score,id,x,y,z,length,width,height,yaw,left,top,right,bottom,"
                 "cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz\n"
                 "0,Car,0.5,3,1,2,3,4,1.5,1.6,0.1,10,20,30,40,10,2,3,40,5,60\n"
                 "0,Pedestrian,,,,,,,,,,10,20,30,40,,,,,,\n"
                 "1,Car,0.5,,,,,,,,,,,,,,,,,,\n"
                 "2,Dog,0.5,,1,2,3,4,1,1,0,,,,,,,,,,\n"
                 "3,Car,zero,,1,2,3,4,1,1,0,,,,,,,,,,\n"
                 "3,Car\n");
  ASSERT_THAT(read, ElementsAre(Pair(0u, ::testing::_)));
  const auto& [car, person] = std::tie(read.at(0).items[0], read.at(0).items[1]);
  EXPECT_EQ(3, car.detector_id);
  EXPECT_EQ(Eigen::Vector3d(1, 2, 3), car.box3d->centre);
  EXPECT_EQ(40.0, car.box2d->bottom);
  EXPECT_EQ(5.0, (*car.centre_covariance)(2, 1));
  EXPECT_EQ(1.0, person.score);
  EXPECT_FALSE(person.detector_id);
  EXPECT_FALSE(person.box3d);
  EXPECT_TRUE(person.box2d);
  EXPECT_THAT(dropped_, UnorderedElementsAre(Pair("no_box", 1u), Pair("unknown_class", 1u),
                                             Pair("bad_row", 2u)));
}

TEST_F(TrackFileTest, ReadsFilesOfSpreadsheets) {
  EXPECT_EQ(1u, detections("d.csv",
                           "\xEF\xBB\xBF"
                           "frame,class,left,top,right,bottom\r\n"
                           "0,Car,1,2,3,4\r\n")
                    .size());
}

TEST_F(TrackFileTest, NumbersThatAreNotFiniteArePassedOn) {
  const auto read = detections("d.csv",
                               "frame,class,x,y,z,length,width,height,yaw\n"
                               "0,Car,nan,1,10,4,2,1.5,0\n0,Car,inf,1,10,4,2,1.5,0\n");
  ASSERT_EQ(2u, read.at(0).items.size());
  EXPECT_TRUE(std::isnan(read.at(0).items[0].box3d->centre.x()));
  EXPECT_TRUE(dropped_.empty());
}

TEST_F(TrackFileTest, CovariancesAndNumbersThatCannotBeAreCounted) {
  const std::string box = "0,Car,1,1,10,4,2,1.5,0,";
  const auto read = detections(
      "d.csv",
      "frame,class,x,y,z,length,width,height,yaw,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz\n" +
          box + "-1,0,0,1,0,1\n" + box + "1e154,0,0,1e154,0,1e154\n" + box + "1,9,0,1,0,1\n" + box +
          "nan,0,0,1,0,1\n" + box + "1,0,0,1,0,1\n" + box +
          "0,0,0,0,0,0\n0,Car,1e300,1,10,4,2,1.5,0,1,0,0,1,0,1\n");
  ASSERT_EQ(6u, read.at(0).items.size());
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(read.at(0).items[i].centre_covariance) << i;
  EXPECT_TRUE(read.at(0).items[4].centre_covariance);
  EXPECT_TRUE(read.at(0).items[5].centre_covariance) << "exact";
  EXPECT_THAT(dropped_,
              UnorderedElementsAre(Pair("bad_covariance", 4u), Pair("implausible_box", 1u)));
}

TEST_F(TrackFileTest, UnknownFormatsAreRefused) {
  const auto message = [&](const std::string& text) {
    return test::errorOf([&] { (void)detections("x.csv", text); });
  };
  EXPECT_THAT(message("hello world\n"), HasSubstr("x.csv:1"));
  EXPECT_THAT(message("class,x\nCar,1\n"), HasSubstr("column 'frame' is missing"));
  EXPECT_THAT(message("frame,class,colour\n0,Car,red\n"), HasSubstr("'colour' is unknown"));
  EXPECT_THAT(message("1,2,3\n"), HasSubstr("has 3 fields"));
  EXPECT_TRUE(detections("empty.csv", "").empty());
}

TEST_F(TrackFileTest, RealDetectionsAreReadWithoutLoss) {
  HEADWAY_REQUIRE_DATA(data);
  const auto training = data / "kitti_tracking/training";
  std::size_t count = 0;
  for (const auto& [frame, one] :
       readDetections(training / "det3d_pointrcnn/Car/0001.txt", dropped_)) {
    count += one.items.size();
  }
  EXPECT_GT(count, 1000u);
  EXPECT_TRUE(dropped_.empty());
  EXPECT_FALSE(readDetections(training / "det2d_rrc/Car/0001.txt", dropped_).empty());
  EXPECT_TRUE(dropped_.empty());
  EXPECT_FALSE(readDetections(training / "label_02/0001.txt", dropped_).empty());
  EXPECT_THAT(dropped_, ElementsAre(Pair("dont_care", ::testing::Gt(0u))));
}

}  // namespace
}  // namespace headway::io
