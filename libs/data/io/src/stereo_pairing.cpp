// SPDX-License-Identifier: BSD-3-Clause
#include "stereo_pairing.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/mrpt_time.h>

#include <algorithm>
#include <cmath>

#include "depth_registration.h"

namespace headway::io {
namespace {

constexpr std::size_t kMaxWaiting = 4;  // unpaired images of one side

RecordedPair pairOf(const mrpt::obs::CObservationStereoImages& stereo) {
  RecordedPair pair;
  pair.time = timeFrom(stereo.timestamp);
  pair.left = stereo.imageLeft;
  pair.right = stereo.imageRight;
  pair.left_camera = stereo.leftCamera;
  pair.right_camera = stereo.rightCamera;
  pair.T_robot_left = fromMrpt(stereo.cameraPose);
  pair.T_left_right = fromMrpt(stereo.rightCameraPose);
  return pair;
}

RecordedPair pairOf(const mrpt::obs::CObservationImage& left,
                    const mrpt::obs::CObservationImage& right) {
  RecordedPair pair;
  pair.time = timeFrom(left.timestamp);
  pair.left = left.image;
  pair.right = right.image;
  pair.left_camera = left.cameraParams;
  pair.right_camera = right.cameraParams;
  pair.T_robot_left = fromMrpt(left.cameraPose);
  pair.T_left_right = pair.T_robot_left.inverse() * fromMrpt(right.cameraPose);
  return pair;
}

/// The intensity image as the left one of a pair.
RecordedPair pairOf(const mrpt::obs::CObservation3DRangeScan& scan) {
  RecordedPair pair;
  pair.time = timeFrom(scan.timestamp);
  pair.left = scan.intensityImage;
  pair.left_camera = pair.right_camera = scan.cameraParamsIntensity;
  pair.depth = depthOf(scan);
  pair.T_robot_left = pair.depth->camera.T_robot_color;
  const double focal_px = scan.cameraParamsIntensity.fx();
  pair.T_left_right.translation().x() = equivalentBaseline(focal_px > 0.0 ? focal_px : 1.0);
  return pair;
}

}  // namespace

RawCamera rawCamera(const mrpt::img::TCamera& camera) {
  using mrpt::img::DistortionModel;
  RawCamera raw;
  raw.width = static_cast<int>(camera.ncols);
  raw.height = static_cast<int>(camera.nrows);
  raw.fx = camera.fx();
  raw.fy = camera.fy();
  raw.cx = camera.cx();
  raw.cy = camera.cy();
  if (camera.distortion == DistortionModel::plumb_bob) {
    const auto rational = camera.dist.begin() + raw.distortion.size();
    std::copy(camera.dist.begin(), rational, raw.distortion.begin());
    std::copy(rational, camera.dist.end(), raw.rational.begin());
  } else if (camera.distortion == DistortionModel::kannala_brandt) {
    raw.is_fisheye = true;
    raw.distortion = {camera.k1(), camera.k2(), camera.k3(), camera.k4(), 0.0};
  }
  return raw;
}

RawStereoCamera rawCameraOf(const RecordedPair& pair) {
  RawStereoCamera raw;
  raw.left = rawCamera(pair.left_camera);
  raw.right = rawCamera(pair.right_camera);
  raw.T_robot_left = pair.T_robot_left;
  raw.T_left_right = pair.T_left_right;
  return raw;
}

bool hasFiniteCalibration(const RecordedPair& pair) {
  for (const auto* camera : {&pair.left_camera, &pair.right_camera}) {
    const bool is_finite = std::isfinite(camera->fx()) && std::isfinite(camera->fy()) &&
                           std::isfinite(camera->cx()) && std::isfinite(camera->cy()) &&
                           std::all_of(camera->dist.begin(), camera->dist.end(),
                                       [](double k) { return std::isfinite(k); });
    if (!is_finite) return false;
  }
  return pair.T_robot_left.matrix().allFinite() && pair.T_left_right.matrix().allFinite();
}

bool StereoPairing::accepts(const mrpt::obs::CObservation& observation) const {
  const auto& label = observation.sensorLabel;
  switch (choice_.kind) {
    case CameraChoice::Kind::kStereo:
      return label == choice_.labels[0] &&
             dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation) != nullptr;
    case CameraChoice::Kind::kPair:
      return (label == choice_.labels[0] || label == choice_.labels[1]) &&
             dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr;
    case CameraChoice::Kind::kDepth:
      return label == choice_.labels[0] &&
             dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation) != nullptr;
    case CameraChoice::Kind::kNone:
      break;
  }
  return false;
}

std::optional<RecordedPair> StereoPairing::add(const mrpt::obs::CObservation::Ptr& observation) {
  if (choice_.kind == CameraChoice::Kind::kPair) {
    return addSingle(std::dynamic_pointer_cast<mrpt::obs::CObservationImage>(observation));
  }
  if (choice_.kind == CameraChoice::Kind::kDepth) {
    return addDepth(dynamic_cast<const mrpt::obs::CObservation3DRangeScan&>(*observation));
  }
  const auto stereo = std::dynamic_pointer_cast<mrpt::obs::CObservationStereoImages>(observation);
  if (stereo->hasImageRight) return pairOf(*stereo);
  ++skipped_["no_right_image"];
  return std::nullopt;
}

std::optional<RecordedPair> StereoPairing::addDepth(
    const mrpt::obs::CObservation3DRangeScan& scan) {
  if (scan.hasIntensityImage && scan.hasRangeImage) return pairOf(scan);
  ++skipped_[scan.hasIntensityImage ? "no_depth" : "no_intensity_image"];
  return std::nullopt;
}

std::optional<RecordedPair> StereoPairing::addSingle(const Image& image) {
  const std::size_t side = image->sensorLabel == choice_.labels[0] ? 0 : 1;
  auto& partners = waiting_[1 - side];
  const auto distance = [&image](const Image& other) {
    return std::abs(timeFrom(other->timestamp) - timeFrom(image->timestamp));
  };
  const auto nearest =
      std::min_element(partners.begin(), partners.end(),
                       [&](const Image& a, const Image& b) { return distance(a) < distance(b); });
  if (nearest == partners.end() || distance(*nearest) > tolerance_s_) {
    if (nearest != partners.end()) nearest_ = std::min(nearest_, distance(*nearest));
    auto& own = waiting_[side];
    own.push_back(image);
    if (own.size() > kMaxWaiting) {
      own.pop_front();
      countUnpaired(1);
    }
    return std::nullopt;
  }
  const Image partner = *nearest;
  countUnpaired(static_cast<std::size_t>(nearest - partners.begin()) + waiting_[side].size());
  partners.erase(partners.begin(), nearest + 1);
  waiting_[side].clear();  // older than this image, as are their counterparts
  return side == 0 ? pairOf(*image, *partner) : pairOf(*partner, *image);
}

void StereoPairing::finish() {
  for (auto& side : waiting_) {
    countUnpaired(side.size());
    side.clear();
  }
}

void StereoPairing::countUnpaired(std::size_t images) {
  if (images > 0) skipped_["unpaired_image"] += images;
}

}  // namespace headway::io
