// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "run_program.h"

namespace headway::eval {
namespace {

using testing::HasSubstr;

/// A car that drives away, as a label (`score` empty) or a result row in each frame.
std::string carRows(int frames, int id, double x, const std::string& score) {
  std::ostringstream rows;
  for (int k = 0; k < frames; ++k) {
    rows << k << " " << id << " Car 0 0 0 100 100 200 160 1.5 1.6 4.0 " << x << " 1.6 " << 10 + k
         << " -1.57 " << score << "\n";
  }
  return rows.str();
}

class TracksCommandTest : public testing::Test {
 protected:
  std::string file(const std::string& name, const std::string& content) {
    const auto path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    std::ofstream(path) << content;
    return path;
  }
  ProgramRun run(const std::string& truth, const std::string& estimate,
                 const std::string& more = "") {
    return runEval("tracks --truth " + truth + " --estimate " + estimate + " " + more);
  }
  test::TemporaryFolder folder_;
};

TEST_F(TracksCommandTest, ComparesTheTracksOfAReplayWithASimulationsObjects) {
  const std::string header =
      "frame,time,track_id,class,status,moving,x,y,z,yaw,length,width,height,vx,vy,vz,var_x,var_y,"
      "cov_xy";
  std::string objects = header + ",visible\n";
  std::string tracks = header + "\n";
  for (int k = 0; k < 10; ++k) {
    const std::string start = std::to_string(k) + "," + std::to_string(0.1 * k);
    const auto row = [&](int id, double y) {
      return start + "," + std::to_string(id) + ",Car,confirmed,1," + std::to_string(10 + k) + "," +
             std::to_string(y) + ",0.75,0,4,1.8,1.5,10,0,0,0.1,0.1,0";
    };
    objects += row(1, 2.0) + ",1.0\n" + row(2, -6.0) + ",0.05\n";
    tracks += row(7, 2.3) + "\n";
  }
  const auto truth = file("objects.csv", objects);
  const auto estimate = file("out/tracks.csv", tracks);
  const std::string out = folder_ / "t.json";
  const auto result = run(truth, estimate, "-q --json " + out);
  ASSERT_EQ(0, result.status) << result.error;
  const auto car = nlohmann::json::parse(contentOf(out)).at("Car");
  EXPECT_NEAR(0.3, car.at("rmse_m").get<double>(), 1e-9);
  EXPECT_EQ(1.0, car.at("recall")) << "hidden objects are no part of the truth";
  EXPECT_EQ(1.0, car.at("precision"));
  const auto mixed = run(file("0001.txt", carRows(10, 1, 0.0, "")), estimate);
  EXPECT_EQ(1, mixed.status);
  EXPECT_THAT(mixed.error, HasSubstr("one is in the map and one in the camera"));
}

TEST_F(TracksCommandTest, FilesAndFoldersGiveTheDocumentedKeys) {
  const std::string dont_care =
      "0 -1 DontCare -1 -1 -10 0 0 50 50 -1000 -1000 -1000 -10 -1 -1 -1\n";
  file("truth/0001.txt", carRows(10, 1, 0.0, "") + dont_care);
  file("truth/0002.txt", carRows(10, 1, 0.0, ""));
  file("truth/0003.txt", carRows(10, 1, 0.0, ""));
  file("tracks/0001.txt", carRows(10, 5, 0.3, "0.9"));
  file("tracks/0002.txt", carRows(5, 5, 0.3, "0.8"));
  const std::string out = folder_ / "t.json";
  const auto result = run(folder_ / "truth", folder_ / "tracks",
                          "--json " + out + " --plot " + std::string(folder_ / "t.png"));
  EXPECT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("ignored: 0003"));
  const auto figures = nlohmann::json::parse(contentOf(out));
  for (const auto& part : {figures, figures.at("sequences").at("0001")}) {
    for (const char* name : {"Car", "Pedestrian", "Cyclist", "all"}) {
      for (const char* key : {"rmse_m", "precision", "recall", "f1", "mota", "motp", "idsw", "frag",
                              "hota", "deta", "assa", "samota", "amota"}) {
        EXPECT_TRUE(part[name].contains(key)) << name << " " << key;
      }
    }
  }
  EXPECT_NEAR(0.3, figures.at("Car").at("rmse_m").get<double>(), 1e-9);
  EXPECT_NEAR(0.75, figures.at("Car").at("mota").get<double>(), 1e-9);
  EXPECT_NEAR(1.0, figures.at("sequences").at("0001").at("Car").at("mota").get<double>(), 1e-9);
  EXPECT_NEAR(0.5, figures.at("sequences").at("0002").at("Car").at("mota").get<double>(), 1e-9);
  EXPECT_TRUE(figures.at("Cyclist").at("mota").is_null());
  EXPECT_THAT(contentOf(folder_ / "t.png"), testing::StartsWith("\x89PNG"));
}

TEST_F(TracksCommandTest, ImageBoxesOnRequest) {
  const auto truth = file("a.txt", carRows(4, 1, 0.0, ""));
  const auto far_off = file("b.txt", carRows(4, 1, 30.0, "1"));
  const std::string out = folder_ / "t.json";
  EXPECT_EQ(0, run(truth, far_off, "--metric 2d --classes Car --json " + out).status);
  const auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_NEAR(1.0, figures.at("Car").at("mota").get<double>(), 1e-9);
  EXPECT_FALSE(figures.contains("Cyclist"));
}

TEST_F(TracksCommandTest, DetectionsWithoutIdsAreSeparateTracks) {
  const auto truth = file("a.txt", carRows(6, 1, 0.0, ""));
  const auto boxes = file("b.txt", carRows(6, -1, 0.1, "1"));
  const std::string out = folder_ / "t.json";
  EXPECT_EQ(0, run(truth, boxes, "--json " + out).status);
  const auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_EQ(5, figures.at("Car").at("idsw"));
  EXPECT_NEAR(1.0, figures.at("Car").at("recall").get<double>(), 1e-9);
}

TEST_F(TracksCommandTest, EvaluatesRawDetectionsAndTracks) {
  file("truth/0001.txt", carRows(10, 1, 0.0, ""));
  file("tracks/0001.txt", carRows(10, 5, 0.2, "0.9"));
  // A detector's folder has one folder for each class: frame,type,box,score,h,w,l,x,y,z,ry,alpha.
  std::string rows;
  for (int k = 0; k < 5; ++k) {
    const auto z = std::to_string(10 + k);
    rows += std::to_string(k) + ",2,100,100,200,160,0.7,1.5,1.6,4.0,0.6,1.6," + z + ",-1.57,0\n";
  }
  file("raw/Car/0001.txt", rows);
  std::string poses;
  for (int k = 0; k < 10; ++k) poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  file("poses/0001.txt", poses);
  const std::string out = folder_ / "t.json";
  const auto result =
      run(folder_ / "truth", folder_ / "tracks",
          "--raw " + std::string(folder_ / "raw") + " --poses " + std::string(folder_ / "poses") +
              " --json " + out + " --plot " + std::string(folder_ / "t.png"));
  EXPECT_EQ(0, result.status) << result.error;
  EXPECT_THAT(result.out, HasSubstr("0.600 / 0.200"));
  EXPECT_THAT(result.out, HasSubstr("50.00 / 100.00"));
  const auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_NEAR(0.6, figures.at("raw").at("Car").at("rmse_m").get<double>(), 1e-6);
  EXPECT_NEAR(0.5, figures.at("raw").at("Car").at("recall").get<double>(), 1e-9);
  EXPECT_TRUE(figures.at("raw").at("Car").at("mota").is_null());
  EXPECT_THAT(contentOf(folder_ / "t.png"), testing::StartsWith("\x89PNG"));
  const auto missing = run(folder_ / "truth", folder_ / "tracks",
                           "--raw " + std::string(folder_ / "poses") + "/none");
  EXPECT_EQ(1, missing.status);
}

TEST_F(TracksCommandTest, FileErrorsAreOneLine) {
  const auto labels = file("truth/0001.txt", carRows(4, 1, 0.0, ""));
  const auto twice = file("twice.txt", carRows(4, 1, 0.0, "1") + carRows(1, 1, 9.0, "1"));
  const auto not_finite = file("nan.txt", "0 1 Car 0 0 0 1 1 9 9 1 1 nan 0 0 9 0 1\n");
  const auto empty = file("empty.txt", "");
  file("other/0007.txt", carRows(4, 1, 0.0, "1"));
  const auto only_2d = file("2d.txt", "0 1 Car 0 0 0 1 1 9 9 -1 -1 -1 -1000 -1000 -1000 -10 1\n");
  const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {labels, twice, "frame 0: id 1 occurs twice"},
      {labels, not_finite, "nan.txt: frame 0: a number is not finite"},
      {not_finite, labels, "nan.txt: frame 0: a number is not finite"},
      {labels, empty, "contains no 3d boxes"},
      {empty, labels, "contains no labels"},
      {labels, only_2d, "contains no 3d boxes"},
      {labels, folder_ / "none.txt", "no such file or folder"},
      {labels, folder_ / "other", "must be two files or two folders"},
      {folder_ / "truth", folder_ / "other", "0007.txt: no file named"}};
  for (const auto& [truth, estimate, reason] : cases) {
    const auto result = run(truth, estimate);
    EXPECT_EQ(1, result.status) << reason;
    EXPECT_THAT(result.error, HasSubstr(reason));
    EXPECT_EQ(1, std::count(result.error.begin(), result.error.end(), '\n')) << result.error;
  }
}

TEST_F(TracksCommandTest, UsageErrorsHaveStatusTwo) {
  const auto labels = file("a.txt", carRows(4, 1, 0.0, ""));
  EXPECT_EQ(2, run(labels, labels, "--metric 4d").status);
  EXPECT_EQ(2, run(labels, labels, "--classes Horse").status);
  EXPECT_EQ(2, run(labels, labels, "--iou 0").status);
}

TEST_F(TracksCommandTest, RealLabelsAgainstThemselvesArePerfect) {
  HEADWAY_REQUIRE_DATA(data);
  const std::string labels = data / "kitti_tracking/training/label_02";
  const std::string out = folder_ / "t.json";
  EXPECT_EQ(0, run(labels, labels, "--json " + out).status);
  const auto figures = nlohmann::json::parse(contentOf(out));
  EXPECT_EQ(19u, figures.at("sequences").size());
  for (const char* name : {"Car", "Pedestrian", "Cyclist", "all"}) {
    EXPECT_EQ(0.0, figures[name].at("rmse_m").get<double>());
    EXPECT_NEAR(1.0, figures[name].at("samota").get<double>(), 1e-9);
    EXPECT_NEAR(1.0, figures[name].at("hota").get<double>(), 1e-9);
    EXPECT_EQ(0, figures[name].at("idsw"));
  }
}

}  // namespace
}  // namespace headway::eval
