// SPDX-License-Identifier: BSD-3-Clause
#include "messages.h"

#include <cmath>
#include <cstdio>

namespace headway::replay {
namespace {

// Explanations of a recording without tracked frames.
constexpr std::size_t kMinMatches = 20;        // of points between the first images
constexpr double kMaxVerticalDisparity = 2.0;  // [px]
constexpr double kMinDisparity = 0.1;          // [px]
constexpr double kMinDepthRatio = 0.1;         // of the first image's pixels

}  // namespace

void printCalibration(const io::CalibrationReport& report) {
  if (report.is_depth_camera) {
    std::printf("depth camera: focal length %.2f px%s; depth in %.0f %% of the first image\n",
                report.focal_px, report.rectified_here ? " (rectified here)" : "",
                100.0 * report.depth_ratio);
    return;
  }
  std::printf(
      "calibration: baseline %.4f m, focal length %.2f px%s; vertical disparity %.2f px, "
      "median disparity %.1f px (%zu matches)\n",
      report.baseline_m, report.focal_px, report.rectified_here ? " (rectified here)" : "",
      report.vertical_disparity_px, report.median_disparity_px, report.matches);
}

std::string causeOfNoTracking(const std::optional<io::CalibrationReport>& calibration) {
  std::string cause = "too few points of the images were tracked";
  if (calibration && calibration->is_depth_camera) {
    if (calibration->depth_ratio < kMinDepthRatio) {
      cause = "only " + std::to_string(std::lround(100.0 * calibration->depth_ratio)) +
              " % of the first image have depth; check the depth camera's projector, its reach and "
              "the unit of its images (rangeUnits)";
    }
  } else if (calibration && calibration->matches < kMinMatches) {
    cause = "only " + std::to_string(calibration->matches) +
            " points of the first left image were found in the right one; check focus, exposure "
            "and lens covers, and that both images are of one stereo pair";
  } else if (calibration && calibration->vertical_disparity_px > kMaxVerticalDisparity) {
    cause = "the rows of the images differ by " +
            std::to_string(calibration->vertical_disparity_px) + " px; calibrate the cameras";
  } else if (calibration && std::abs(calibration->median_disparity_px) < kMinDisparity) {
    cause =
        "left and right images show the same, at a disparity of 0 px; check that the right "
        "camera was recorded";
  }
  return cause;
}

std::string textOf(const std::exception_ptr& failure) {
  try {
    std::rethrow_exception(failure);
  } catch (const std::exception& error) {
    return error.what();
  } catch (...) {
    return "unknown error";
  }
}

}  // namespace headway::replay
