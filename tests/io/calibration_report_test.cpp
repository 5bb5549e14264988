// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>

#include "frame_decoder.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

/// The image moved down by some rows; its upper rows repeat.
cv::Mat movedDown(const cv::Mat& image, int rows) {
  cv::Mat result = image.clone();
  image.rowRange(0, image.rows - rows).copyTo(result.rowRange(rows, image.rows));
  return result;
}

TEST(CalibrationReportTest, MeasuresBothDisparities) {
  for (const int disparity : {0, 3, 15, -12}) {
    const auto [left, right] = test::wall(5, disparity, {320, 240});
    const auto report = measureCalibration(left, right, test::smallCamera());
    EXPECT_GT(report.matches, 50u) << disparity;
    EXPECT_NEAR(disparity, report.median_disparity_px, 0.1);
    EXPECT_NEAR(0.0, report.vertical_disparity_px, 0.1);
  }
  const auto [left, right] = test::wall(5, 10, {320, 240});
  const auto report = measureCalibration(left, movedDown(right, 2), test::smallCamera());
  EXPECT_NEAR(2.0, report.vertical_disparity_px, 0.1);
}

TEST(CalibrationReportTest, UniformImagesGiveNoMatches) {
  const cv::Mat blank(120, 160, CV_8UC1, cv::Scalar(128));
  const auto report = measureCalibration(blank, blank, test::smallCamera());
  EXPECT_EQ(0u, report.matches);
  EXPECT_EQ(0.0, report.median_disparity_px);
  EXPECT_EQ(0.2, report.baseline_m);
  EXPECT_NO_THROW(requireNotSwapped(report));
}

TEST(CalibrationReportTest, ImagesSmallerThanAPatchGiveNoMatches) {
  const cv::Mat tiny(4, 6, CV_8UC1, cv::Scalar(0));
  EXPECT_EQ(0u, measureCalibration(tiny, tiny, test::smallCamera()).matches);
}

TEST(CalibrationReportTest, RequiresClearEvidenceForSwappedImages) {
  CalibrationReport report;
  report.matches = 100;
  report.median_disparity_px = -5.0;
  EXPECT_THROW(requireNotSwapped(report), InputError);
  report.median_disparity_px = -0.5;  // a far scene
  EXPECT_NO_THROW(requireNotSwapped(report));
  report.median_disparity_px = -5.0;
  report.matches = 5;
  EXPECT_NO_THROW(requireNotSwapped(report));
}

}  // namespace
}  // namespace headway::io
