#include "body_flow.h"

#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::detect {
namespace {

constexpr float kMoves = 3.5F;           // sigmas from which a cell moves
constexpr float kStill = 2.0F;           // and up to which it stands
constexpr double kLeastAcross = 0.25;    // speed of a moving cell across the line of sight [m/s]
constexpr std::size_t kLeastKnown = 12;  // cells that tell of a body
constexpr double kCommonSigma = 0.3;     // of all cells of a body together [px]
constexpr double kSurely = 4.0;          // sigmas from which a body surely moves
constexpr double kMostClaimed = 0.5;     // share of cells that another body has already
const cv::Size kGaps(5, 5);              // between moving cells that are closed [cells]

// Speed across the line of sight, to the right, of a flow [m/s].
double acrossOf(double flow_px, double disparity, double seconds, const StereoCamera& camera) {
  return flow_px * camera.baseline_m / disparity / seconds;
}

std::optional<AcrossSpeed> acrossSpeed(const UprightBlob& blob, const ResidualFlow& flow,
                                       const StereoCamera& camera) {
  std::vector<double> flows;
  std::vector<double> sigmas;
  for (const auto& cell : blob.cells) {
    const float residual = flow.columns.at<float>(cell.place);
    if (std::isnan(residual)) continue;
    flows.push_back(residual);
    sigmas.push_back(flow.sigmas.at<float>(cell.place));
  }
  if (flows.size() < kLeastKnown) return std::nullopt;
  const double middle = median(flows);
  std::vector<double> off;
  for (const double residual : flows) off.push_back(std::abs(residual - middle));
  const double sigma = std::hypot(kCommonSigma, std::max(median(off), median(sigmas)));
  return AcrossSpeed{acrossOf(middle, blob.uvd.z(), flow.seconds, camera),
                     acrossOf(sigma, blob.uvd.z(), flow.seconds, camera), flow.seconds};
}

// Cells that move to one side (+1 right, -1 left), with the gaps between them.
cv::Mat movingCells(const stereo::DisparityImage& disparity, const ResidualFlow& flow,
                    const StereoCamera& camera, float side) {
  const cv::Size size = flow.columns.size();
  cv::Mat moving(size, CV_8U);
  cv::Mat still(size, CV_8U);
  for (int row = 0; row < size.height; ++row) {
    const auto* residuals = flow.columns.ptr<float>(row);
    const auto* sigmas = flow.sigmas.ptr<float>(row);
    const auto* d = disparity.values.ptr<float>(row);
    auto* moves = moving.ptr<unsigned char>(row);
    auto* stands = still.ptr<unsigned char>(row);
    for (int column = 0; column < size.width; ++column) {
      const float residual = side * residuals[column];  // where it is unknown, neither holds
      stands[column] = residual < kStill * sigmas[column];
      moves[column] = residual > kMoves * sigmas[column] &&
                      acrossOf(residual, d[column], flow.seconds, camera) > kLeastAcross;
    }
  }
  cv::dilate(moving, moving, cv::getStructuringElement(cv::MORPH_RECT, kGaps));
  moving.setTo(0, still);
  return moving;
}

}  // namespace

std::vector<UprightBlob> bodiesByFlow(const stereo::DisparityImage& disparity,
                                      const ResidualFlow& flow, const StereoCamera& camera,
                                      const stereo::GroundPlane& ground, double range_m) {
  const StandingCells standing = standingCells(disparity, camera, ground, range_m);
  auto bodies = uprightBlobs(standing, disparity, camera);
  if (flow.empty()) return bodies;
  cv::Mat claimed(flow.columns.size(), CV_8U, cv::Scalar(0));
  for (auto& body : bodies) {
    body.across = acrossSpeed(body, flow, camera);
    if (!body.across || std::abs(body.across->speed) < kSurely * body.across->sigma) continue;
    for (const auto& cell : body.cells) claimed.at<unsigned char>(cell.place) = 1;
  }
  for (const float side : {1.0F, -1.0F}) {
    StandingCells moving{{}, standing.heights};
    standing.disparities.copyTo(moving.disparities, movingCells(disparity, flow, camera, side));
    for (auto& body : uprightBlobs(moving, disparity, camera)) {
      const auto taken = std::count_if(
          body.cells.begin(), body.cells.end(),
          [&](const ObjectCell& cell) { return claimed.at<unsigned char>(cell.place) != 0; });
      if (static_cast<double>(taken) > kMostClaimed * static_cast<double>(body.cells.size())) {
        continue;
      }
      body.across = acrossSpeed(body, flow, camera);
      body.cut_by_flow = true;
      body.hidden = true;  // its outline is that of its flow
      bodies.push_back(std::move(body));
    }
  }
  return bodies;
}

}  // namespace headway::detect
