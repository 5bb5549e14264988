// SPDX-License-Identifier: BSD-3-Clause
#include "segment_flow.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr float kMovingSigmas = 3.5F;  // sigmas from which a cell is moving
constexpr float kStaticSigmas = 2.0F;  // and below which it is static
constexpr double kMinAcross = 0.25;    // speed of a moving cell across the line of sight [m/s]
constexpr std::size_t kMinKnown = 12;  // of a segment with measured flow
constexpr double kCommonSigma = 0.3;   // error common to all cells of a segment [px]
constexpr double kSurely = 4.0;        // sigmas from which a segment is moving for certain
constexpr double kMaxClaimed = 0.5;    // ratio of cells that belong to another segment already
const cv::Size kFlowGaps(5, 5);        // between moving cells that are closed [cells]

// Speed across the line of sight, to the right, of a flow [m/s].
double acrossOf(double flow_px, double disparity, double seconds, const StereoCamera& camera) {
  return flow_px * camera.baseline_m / disparity / seconds;
}

std::optional<LateralSpeed> acrossSpeed(const UprightSegment& segment, const ResidualFlow& flow,
                                        const StereoCamera& camera) {
  std::vector<double> flows;
  std::vector<double> sigmas;
  for (const auto& cell : segment.cells) {
    const float residual = flow.columns.at<float>(cell.place);
    if (std::isnan(residual)) continue;
    flows.push_back(residual);
    sigmas.push_back(flow.sigmas.at<float>(cell.place));
  }
  if (flows.size() < kMinKnown) return std::nullopt;
  const double middle = median(flows);
  std::vector<double> off;
  for (const double residual : flows) off.push_back(std::abs(residual - middle));
  const double sigma = std::hypot(kCommonSigma, std::max(median(off), median(sigmas)));
  return LateralSpeed{acrossOf(middle, segment.uvd.z(), flow.seconds, camera),
                      acrossOf(sigma, segment.uvd.z(), flow.seconds, camera), flow.seconds};
}

// Cells that move to one side (+1 right, -1 left), gaps between them closed.
cv::Mat movingCells(const stereo::DisparityImage& disparity, const ResidualFlow& flow,
                    const StereoCamera& camera, float side) {
  const cv::Size size = flow.columns.size();
  cv::Mat moving(size, CV_8U);
  cv::Mat fixed(size, CV_8U);
  for (int row = 0; row < size.height; ++row) {
    const auto* residuals = flow.columns.ptr<float>(row);
    const auto* sigmas = flow.sigmas.ptr<float>(row);
    const auto* d = disparity.values.ptr<float>(row);
    auto* moves = moving.ptr<unsigned char>(row);
    auto* rests = fixed.ptr<unsigned char>(row);
    for (int column = 0; column < size.width; ++column) {
      const float residual = side * residuals[column];  // NaN: neither moving nor static
      rests[column] = residual < kStaticSigmas * sigmas[column];
      moves[column] = residual > kMovingSigmas * sigmas[column] &&
                      acrossOf(residual, d[column], flow.seconds, camera) > kMinAcross;
    }
  }
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, kFlowGaps));
  moving.setTo(0, fixed);
  return moving;
}

}  // namespace

std::vector<UprightSegment> segmentsByFlow(const stereo::DisparityImage& disparity,
                                           const ResidualFlow& flow, const StereoCamera& camera,
                                           const stereo::GroundPlane& ground, double range_m) {
  const StandingCells standing = standingCells(disparity, camera, ground, range_m);
  auto segments = uprightSegments(standing, disparity, camera);
  if (flow.empty()) return segments;
  cv::Mat claimed(flow.columns.size(), CV_8U, cv::Scalar(0));
  for (auto& segment : segments) {
    segment.across = acrossSpeed(segment, flow, camera);
    if (!segment.across || std::abs(segment.across->speed) < kSurely * segment.across->sigma)
      continue;
    for (const auto& cell : segment.cells) claimed.at<unsigned char>(cell.place) = 1;
  }
  for (const float side : {1.0F, -1.0F}) {
    StandingCells moving{{}, standing.heights};
    standing.disparities.copyTo(moving.disparities, movingCells(disparity, flow, camera, side));
    for (auto& segment : uprightSegments(moving, disparity, camera)) {
      const auto taken = std::count_if(
          segment.cells.begin(), segment.cells.end(),
          [&](const ObjectCell& cell) { return claimed.at<unsigned char>(cell.place) != 0; });
      if (static_cast<double>(taken) > kMaxClaimed * static_cast<double>(segment.cells.size())) {
        continue;
      }
      segment.across = acrossSpeed(segment, flow, camera);
      segment.cut_by_flow = true;
      segment.hidden = true;  // its outline is where the flow ends
      segments.push_back(std::move(segment));
    }
  }
  return segments;
}

}  // namespace headway::detect
