#include "blob_follower.h"

#include <headway/core/assignment.h>

#include <algorithm>
#include <cmath>

#include "over_ground.h"

namespace headway::detect {
namespace {

constexpr double kGate = 0.6;           // between a blob and its expected place [m]
constexpr double kGatePerMetre = 0.02;  // growth with depth [m/m]
constexpr double kGateDisparity = 1.0;  // and, along the line of sight, by this much disparity [px]
constexpr double kEdge = 0.5;           // error of a blob's middle [px]
constexpr double kEdgeShare = 0.03;     // and share of its width
constexpr double kDisparitySigma = 0.3;  // [px]
constexpr double kRowSigma = 30.0;       // rows say little: feet and head come and go [px]
constexpr double kFastest = 8.0;         // of what is followed as a blob [m/s]
constexpr int kLeastSightings = 4;
constexpr int kMostMissed = 3;         // frames without a blob
constexpr double kGoodFit = 3.0;       // squared error to a degree of freedom
constexpr std::size_t kMostFlows = 5;  // kept of a body
constexpr double kLeastWay = 0.3;      // moved within the window [m]

SightingNoise noiseOf(const UprightBlob& blob) {
  return {kEdge + kEdgeShare * blob.width_px, kRowSigma, kDisparitySigma};
}

Eigen::Vector3d placeOf(const UprightBlob& blob, const CameraPath& path,
                        const StereoCamera& camera) {
  return path.T_cam_world(path.newest()).inverse() * *triangulate(blob.uvd, camera);
}

Eigen::Vector3d expectedPlace(const BlobTrack& track, const CameraPath& path,
                              const Eigen::Vector3d& up) {
  if (!track.track.motion || track.track.sightings.size() < 3) return track.last_place;
  return track.last_place + (path.timeOf(path.newest()) - path.timeOf(track.last_frame)) *
                                overGround(track.track.motion->velocity, up);
}

// How far off a blob is, gates: stereo errs along the line of sight, the more the farther it sees.
class Gate {
 public:
  Gate(const Eigen::Vector3d& expected, const CameraPath& path, const StereoCamera& camera,
       const Eigen::Vector3d& up)
      : expected_(expected), up_(up) {
    const Pose& T_cam_world = path.T_cam_world(path.newest());
    const double depth = (T_cam_world * expected).z();
    ray_ = overGround(expected - T_cam_world.inverse().translation(), up).normalized();
    across_ = kGate + kGatePerMetre * depth;
    along_ = across_ + kGateDisparity * depth * depth / (camera.fx * camera.baseline_m);
  }

  [[nodiscard]] double distanceOf(const Eigen::Vector3d& place) const {
    const Eigen::Vector3d off = overGround(place - expected_, up_);
    const double along = ray_.dot(off);
    return std::hypot(along / along_, (off - along * ray_).norm() / across_);
  }

 private:
  Eigen::Vector3d expected_, up_, ray_;
  double across_, along_;  ///< [m]
};

}  // namespace

void BlobFollower::follow(std::vector<UprightBlob> blobs, const CameraPath& path,
                          const Eigen::Vector3d& up) {
  const auto forgotten = [&](const BlobTrack& track) {
    return track.last_frame < path.oldest() || path.newest() - track.last_frame > kMostMissed;
  };
  tracks_.erase(std::remove_if(tracks_.begin(), tracks_.end(), forgotten), tracks_.end());
  std::vector<CandidatePair> candidates;
  for (std::size_t t = 0; t < tracks_.size(); ++t) {
    const Gate gate(expectedPlace(tracks_[t], path, up), path, camera_, up);
    for (std::size_t b = 0; b < blobs.size(); ++b) {
      const double off = gate.distanceOf(placeOf(blobs[b], path, camera_));
      if (off < 1.0) candidates.push_back({t, b, off});
    }
  }
  std::vector<bool> taken(blobs.size(), false);
  for (const auto& pair : assignPairs(std::move(candidates))) {
    extend(tracks_[pair.row], std::move(blobs[pair.column]), path);
    taken[pair.column] = true;
  }
  for (std::size_t b = 0; b < blobs.size(); ++b) {
    if (taken[b]) continue;
    BlobTrack track;
    track.track.id = next_id_++;
    extend(track, std::move(blobs[b]), path);
    tracks_.push_back(std::move(track));
  }
}

void BlobFollower::extend(BlobTrack& track, UprightBlob blob, const CameraPath& path) const {
  auto& sightings = track.track.sightings;
  const auto old = [&](const Sighting& sighting) { return sighting.frame < path.oldest(); };
  sightings.erase(sightings.begin(), std::find_if_not(sightings.begin(), sightings.end(), old));
  if (!blob.hidden) sightings.push_back({path.newest(), blob.uvd});
  if (blob.across) track.across.push_back(*blob.across);
  if (track.across.size() > kMostFlows) track.across.pop_front();
  track.last_frame = path.newest();
  track.last_place = placeOf(blob, path, camera_);
  track.track.motion = fitMotion(sightings, path, camera_, noiseOf(blob), 2.0);
  track.blob = std::move(blob);
}

std::optional<PointMotion> BlobFollower::outlineMotion(const BlobTrack& track) {
  const auto& motion = track.track.motion;
  if (!motion || motion->sightings < kLeastSightings) return std::nullopt;
  return motion->movingFit() < kGoodFit ? motion : std::nullopt;
}

bool BlobFollower::moves(const BlobTrack& track, const Eigen::Vector3d& up,
                         const VerdictParams& params, double window_s) {
  if (!track.track.motion) return false;
  VerdictParams strict = params;
  strict.least_sightings = kLeastSightings;
  strict.most_speed = kFastest;
  if (verdictOn(track.track, up, strict) != PointVerdict::kMoving) return false;
  return overGround(track.track.motion->velocity, up).norm() * window_s > kLeastWay;
}

}  // namespace headway::detect
