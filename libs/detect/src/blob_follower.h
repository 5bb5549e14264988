#pragma once

#include <deque>
#include <vector>

#include "motion_verdict.h"
#include "upright_blobs.h"

namespace headway::detect {

/// A blob followed from frame to frame, as if it were a single fat point.
struct BlobTrack {
  PointTrack track;    ///< its middles; `motion` fitted in every frame in which it is seen
  UprightBlob blob;    ///< as seen last
  int last_frame = 0;  ///< in which it was seen
  std::deque<AcrossSpeed> across;  ///< in the frames in which its flow was measured, newest last
  Eigen::Vector3d last_place = Eigen::Vector3d::Zero();  ///< then, world of the path [m]
};

/// Follows things of a person's size as wholes.
///
/// People wear what they like: where their clothes show no corners, their outline in the disparity
/// image still moves. A blob continues the track next to whose expected place it lies; while it is
/// partly hidden its outline tells nothing, for it moves with the edge of what hides it.
class BlobFollower {
 public:
  explicit BlobFollower(const StereoCamera& camera) : camera_(camera) {}

  /// Pairs the blobs of a frame with the tracks and fits the motion of each.
  void follow(std::vector<UprightBlob> blobs, const CameraPath& path, const Eigen::Vector3d& up);

  /// What the outline tells of a track's motion; nullopt where it was hidden or seen too rarely.
  [[nodiscard]] static std::optional<PointMotion> outlineMotion(const BlobTrack& track);

  /// Whether by its outline alone a track surely moves, and farther than that is uncertain.
  ///
  /// @param window_s  in which it must have gone a good way [s]
  [[nodiscard]] static bool moves(const BlobTrack& track, const Eigen::Vector3d& up,
                                  const VerdictParams& params, double window_s);

  [[nodiscard]] std::vector<BlobTrack>& tracks() { return tracks_; }
  void clear() { tracks_.clear(); }

 private:
  void extend(BlobTrack& track, UprightBlob blob, const CameraPath& path) const;

  StereoCamera camera_;
  std::vector<BlobTrack> tracks_;
  std::int64_t next_id_ = 0;
};

}  // namespace headway::detect
