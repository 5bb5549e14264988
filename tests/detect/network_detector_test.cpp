// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <headway/core/box_overlap.h>
#include <headway/core/error.h>
#include <headway/detect/detector_factory.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/stereo_sequence.h>

#include <cmath>
#include <fstream>

#include "network_boxes.h"

namespace headway::detect {
namespace {

std::string errorOf(const NetworkParams& params) {
  try {
    NetworkDetector detector(params);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(NetworkDetectorTest, SaysWhatIsMissing) {
  NetworkParams params;
  EXPECT_THAT(errorOf(params), testing::HasSubstr("model is not set"));
  params.model = "/nowhere/yolox.onnx";
  EXPECT_THAT(errorOf(params), testing::AllOf(testing::HasSubstr("/nowhere/yolox.onnx"),
                                              testing::HasSubstr("ONNX")));
}

TEST(NetworkDetectorTest, SaysThatAFileIsNoModel) {
  test::TemporaryFolder folder;
  NetworkParams params;
  params.model = folder / "text.onnx";
  std::ofstream(params.model) << "not a network";
  EXPECT_THAT(errorOf(params), testing::HasSubstr("cannot read it as an ONNX model"));
  params.family = NetworkParams::Family::kDarknet;
  EXPECT_THAT(errorOf(params), testing::HasSubstr("layout is not set"));
}

TEST(NetworkDetectorTest, RefusesALayoutByWhoseNumbersOpencvWouldDivide) {
  test::TemporaryFolder folder;
  NetworkParams params;
  params.family = NetworkParams::Family::kDarknet;
  params.model = folder / "net.weights";
  params.layout = folder / "net.cfg";
  std::ofstream(params.model) << std::string(100, '\0');
  for (const std::string line : {"stride = 0", "groups=0", "width=-1", "filters=999999999"}) {
    std::ofstream(params.layout) << "[net]\nheight=32\n# comment\n" << line << "\n";
    EXPECT_THAT(errorOf(params), testing::HasSubstr("net.cfg:4: " + line.substr(0, 5)));
  }
}

TEST(NetworkDetectorTest, TakesTheModelFromItsFolder) {
  test::TemporaryFolder folder;
  NetworkParams params;
  ::setenv("HEADWAY_MODELS", (folder / "").c_str(), 1);
  EXPECT_EQ("", findModel(params));
  std::ofstream(folder / "other.onnx") << "of unknown input size";
  EXPECT_EQ("", findModel(params));
  std::ofstream(folder / "yolox_tiny.onnx") << "model";
  EXPECT_EQ(folder / "yolox_tiny.onnx", findModel(params));
  std::ofstream(folder / "yolox_nano.onnx") << "model";
  EXPECT_EQ(folder / "yolox_nano.onnx", findModel(params));
  params.model = "my.onnx";
  EXPECT_EQ("my.onnx", findModel(params));
  params.model.clear();
  params.family = NetworkParams::Family::kDarknet;
  EXPECT_EQ("", findModel(params)) << "a .cfg belongs to the weights";
  ::unsetenv("HEADWAY_MODELS");
}

TEST(NetworkDetectorTest, SaysWhatOutputWasExpected) {
  HEADWAY_REQUIRE_DATA(data);
  NetworkParams params;
  params.model = data / "models" / "yolox_nano.onnx";
  params.classes = "Car,Pedestrian";
  EXPECT_THAT(errorOf(params), testing::HasSubstr("expected 3549 rows of 7"));
  params.classes = "coco";
  params.input_width_px = 400;
  EXPECT_THAT(errorOf(params), testing::HasSubstr("multiples of 32"));
}

TEST(DecodeRowsTest, YoloxPutsBoxesByCellAndStride) {
  NetworkParams params;
  params.input_width_px = params.input_height_px = 64;
  ASSERT_EQ(yoloxRows(64, 64), 64 + 16 + 4);
  cv::Mat rows(84, 7, CV_32F, cv::Scalar(0));
  // Stride 16, row 1, column 2 of 4: centre (2.5, 1.25) * 16, 32 x 16 px.
  float* row = rows.ptr<float>(64 + 1 * 4 + 2);
  row[0] = 0.5F;
  row[1] = 0.25F;
  row[2] = std::log(2.0F);
  row[3] = 0.0F;
  row[4] = 0.9F;
  row[6] = 0.8F;
  const auto boxes = decodeRows(rows, params, {0.5, 0.5});
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_EQ(boxes[0].network_class, 1u);
  EXPECT_NEAR(boxes[0].score, 0.72, 1e-6);
  EXPECT_NEAR(boxes[0].box.left, 2.0 * (40.0 - 16.0), 1e-4);
  EXPECT_NEAR(boxes[0].box.bottom, 2.0 * (20.0 + 8.0), 1e-4);
}

TEST(DecodeRowsTest, DarknetGivesRatiosOfTheInput) {
  NetworkParams params;
  params.family = NetworkParams::Family::kDarknet;
  params.input_width_px = params.input_height_px = 320;
  cv::Mat rows = (cv::Mat_<float>(1, 6) << 0.5F, 0.25F, 0.1F, 0.2F, 0.9F, 0.6F);
  const auto boxes = decodeRows(rows, params, {1.0, 0.5});
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].score, 0.6, 1e-6);
  EXPECT_NEAR(boxes[0].box.left, 144.0, 1e-3);
  EXPECT_NEAR(boxes[0].box.top, 96.0, 1e-3);
}

TEST(WithoutOverlapsTest, KeepsTheBetterOfOneClassAndBothOfTwo) {
  const Box2d box{0, 0, 100, 100};
  const Box2d near{5, 5, 105, 105};
  const auto kept = withoutOverlaps({{near, 0.5, 0}, {box, 0.9, 0}, {near, 0.4, 1}}, 0.5);
  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].score, 0.9);
  EXPECT_EQ(kept[1].network_class, 1u);
}

TEST(NetworkClassesTest, APersonOnABicycleIsOneCyclist) {
  const auto classes = networkClasses("coco");
  const NetworkBox rider{{100, 50, 140, 130}, 0.8, 0};
  const NetworkBox bicycle{{90, 90, 150, 150}, 0.7, 1};
  const NetworkBox walker{{300, 50, 330, 150}, 0.9, 0};
  const NetworkBox parked{{500, 90, 560, 150}, 0.9, 1};
  const auto detections = toDetections({rider, bicycle, walker, parked}, classes);
  ASSERT_EQ(detections.size(), 2u) << "a bicycle alone is nothing of ours";
  EXPECT_EQ(detections[0].object_class, ObjectClass::kCyclist);
  EXPECT_EQ(detections[0].box2d->bottom, 150);
  EXPECT_EQ(detections[1].object_class, ObjectClass::kPedestrian);
}

TEST(NetworkClassesTest, AVanThatIsACarAndATruckIsOneVehicle) {
  const auto classes = networkClasses("coco");
  const Box2d van{100, 50, 200, 120};
  const auto detections =
      toDetections({{van, 0.8, 7}, {van, 0.7, 2}, {{110, 60, 140, 120}, 0.6, 0}}, classes);
  ASSERT_EQ(detections.size(), 2u);
  EXPECT_EQ(detections[0].object_class, ObjectClass::kTruck);
  EXPECT_EQ(detections[1].object_class, ObjectClass::kPedestrian) << "beside it";
}

TEST(NetworkClassesTest, NamesAreKittisOthersAreLeftOut) {
  const auto classes = networkClasses("Car, dog ,Tram");
  ASSERT_EQ(classes.size(), 3u);
  EXPECT_EQ(classes[0].object_class, ObjectClass::kCar);
  EXPECT_FALSE(classes[1].object_class);
  EXPECT_EQ(classes[2].object_class, ObjectClass::kTram);
}

class RealNetworkTest : public testing::TestWithParam<const char*> {};

TEST_P(RealNetworkTest, FindsTheParkedCarOfARealStreet) {
  HEADWAY_REQUIRE_DATA(data);
  DetectParams params;
  Params registry;
  params.describe(registry);
  registry.loadFile(std::string(HEADWAY_SOURCE_DIR) + "/config/detectors/" + GetParam() + ".ini");
  const auto models = data / "models";
  if (params.network.family == NetworkParams::Family::kYolox) {
    params.network.model = models / "yolox_nano.onnx";
  } else {
    params.network.model = models / "yolo-fastest-1.1.weights";
    params.network.layout = models / "yolo-fastest-1.1.cfg";
  }
  const auto sequence = test::kittiSequence(data / "kitti_odometry", "06");
  const auto detector = makeDetector("dnn", params);
  const auto found = detector->detect(sequence.frame(20));
  const Box2d car{723, 178, 858, 264};
  double best = 0.0;
  for (const auto& item : found.items) {
    EXPECT_FALSE(item.box3d) << "networks see in 2D";
    if (item.object_class == ObjectClass::kCar) best = std::max(best, overlap2d(*item.box2d, car));
  }
  EXPECT_GT(best, 0.6);
}

INSTANTIATE_TEST_SUITE_P(Families, RealNetworkTest, testing::Values("yolox_nano", "yolo_fastest"),
                         [](const auto& name) { return std::string(name.param); });

}  // namespace
}  // namespace headway::detect
