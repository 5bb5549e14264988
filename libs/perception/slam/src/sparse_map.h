// SPDX-License-Identifier: BSD-3-Clause
// The sparse map: keyframes, landmarks and their observations.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/pose.h>
#include <headway/core/stereo_camera.h>
#include <headway/stereo/patch.h>
#include <headway/stereo/pose_refiner.h>
#include <headway/stereo/rectification.h>

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "keypoints.h"

namespace headway::slam {

/// Where one keyframe sees a landmark.
struct LandmarkObservation {
  KeyframeId keyframe;
  stereo::StereoMeasurement measurement;
};

/// A patch without contrast, of landmarks that have none yet.
[[nodiscard]] std::shared_ptr<const stereo::ReferencePatch> blankPatch();

/// A static point with its observations and appearance. Copies share the patch, which takes most of
/// its memory and is replaced as a whole.
struct Landmark {
  LandmarkId id;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< map frame [m]
  KeyframeId reference;                                ///< keyframe that the landmark moves with
  int reference_level = 0;                             ///< pyramid level that `patch` was cut from
  /// Camera that `patch` was cut from: the reference itself, unless that keyframe was removed.
  Eigen::Isometry3f T_reference_cut = Eigen::Isometry3f::Identity();
  std::shared_ptr<const stereo::ReferencePatch> patch = blankPatch();
  Descriptor descriptor{};  ///< cut where the patch was cut; all zero if too near to the border
  std::vector<LandmarkObservation> observations;  ///< in order of keyframes
  int tried = 0;                                  ///< frames in which it was searched for
  int agreed = 0;  ///< of the frames where it was found, those whose pose it fits
  int found = 0;   ///< frames in which it was found
};

/// Wheel odometry from an earlier keyframe to this one.
struct OdometryLink {
  KeyframeId from;
  Pose T_from_this = Pose::Identity();  ///< robot frames
  double path_m = 0.0;                  ///< length of the path in between
  double turn_rad = 0.0;                ///< sum of the turns in between, all positive
};

/// The link over both, one after the other.
[[nodiscard]] OdometryLink composed(const OdometryLink& first, const OdometryLink& second);

/// A frame that the map is built on.
struct Keyframe {
  KeyframeId id;
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  Pose T_map_cam = Pose::Identity();
  PoseCovariance covariance = PoseCovariance::Zero();  ///< of T_map_cam
  int submap = 0;                                      ///< 0: the one with the map's origin
  std::vector<LandmarkId> landmarks;                   ///< seen in it, ascending
  std::optional<OdometryLink> odometry;                ///< not stored in map files
};

/// A keyframe and those that share most landmarks with it.
///
/// @param shared  number of landmarks that each keyframe shares with it
/// @return        at most `count` ids, ascending
[[nodiscard]] std::vector<KeyframeId> mostShared(KeyframeId of, std::map<KeyframeId, int> shared,
                                                 int count);

/// A set of groups of consecutive ids.
class IdGroups {
 public:
  static constexpr std::int64_t kSize = 64;  ///< ids of a group

  void add(std::int64_t id) {
    const std::int64_t group = id / kSize;
    if (group == last_) return;
    groups_.insert(group);
    last_ = group;
  }
  /// The groups, ascending; the set is empty afterwards.
  [[nodiscard]] std::vector<std::int64_t> take();

 private:
  std::set<std::int64_t> groups_;
  std::int64_t last_ = -1;  ///< added last, because neighbours are added together
};

/// Owns landmarks and keyframes and keeps their links consistent.
///
/// Invariant: a keyframe lists a landmark exactly if the landmark has an observation of it; a
/// landmark without observations does not exist.
class SparseMap {
 public:
  SparseMap() = default;
  /// A map from its parts; what keyframes see follows from the landmarks' observations.
  ///
  /// @throws InputError if ids repeat or name a keyframe that does not exist
  SparseMap(const std::vector<Keyframe>& keyframes, const std::vector<Landmark>& landmarks);

  /// A new keyframe without landmarks.
  Keyframe& addKeyframe(std::size_t frame, Time time, const Pose& T_map_cam);
  /// A new landmark, seen by its reference keyframe.
  Landmark& addLandmark(const Eigen::Vector3d& position, KeyframeId reference,
                        const stereo::StereoMeasurement& measurement);
  /// A keyframe sees a landmark (that it did not see so far).
  void observe(KeyframeId keyframe, LandmarkId landmark,
               const stereo::StereoMeasurement& measurement);
  /// Removes an observation, and the landmark with its last one (or with its reference's).
  void removeObservation(KeyframeId keyframe, LandmarkId landmark);
  void removeLandmark(LandmarkId landmark);
  /// Makes one landmark of two: `gone` is removed, and its observations become those of `kept`.
  ///
  /// @return false, and no change, if a keyframe observes both, so that they cannot be the same
  bool fuse(LandmarkId kept, LandmarkId gone);
  /// Removes a keyframe and the landmarks that no other keyframe observes. Landmarks whose
  /// reference it was get the nearest keyframe that observes them.
  void removeKeyframe(KeyframeId keyframe);

  /// Null if there is none.
  [[nodiscard]] const Landmark* find(LandmarkId id) const;
  [[nodiscard]] const Keyframe& keyframe(KeyframeId id) const { return keyframes_.at(id); }
  /// The same to be changed; they count as changed.
  [[nodiscard]] Landmark* findToChange(LandmarkId id);
  [[nodiscard]] Keyframe& keyframeToChange(KeyframeId id) {
    changed_keyframes_.add(id.value);
    return keyframes_.at(id);
  }

  /// Submaps are groups of keyframes with a known place to each other, numbered from 0.
  [[nodiscard]] int submapOf(KeyframeId id) const { return keyframes_.at(id).submap; }
  [[nodiscard]] std::vector<int> submaps() const;  ///< ascending
  /// The first keyframe of a submap that has any.
  [[nodiscard]] const Keyframe& firstOf(int submap) const;
  [[nodiscard]] int newSubmap() const;  ///< a number that no keyframe has
  /// Makes one submap of two, with the lower number.
  void joinSubmaps(int a, int b);

  /// The newest keyframes and, of the older ones, those that share most landmarks with the newest.
  ///
  /// @return at most `count` ids, ascending
  [[nodiscard]] std::vector<KeyframeId> neighbourhood(KeyframeId of, int count) const;
  /// The first of the `count` newest keyframes (of all, where there are fewer); invalid if none.
  [[nodiscard]] KeyframeId firstOfNewest(int count) const;
  /// Copies of landmarks with the poses of their reference keyframes, for measuring them in another
  /// thread. Its keyframes list no landmarks, so that it can be neither extended nor culled.
  [[nodiscard]] SparseMap landmarksOnly(const std::vector<LandmarkId>& landmarks) const;
  /// Landmarks seen by any of the keyframes, ascending.
  [[nodiscard]] std::vector<LandmarkId> seenBy(const std::vector<KeyframeId>& keyframes) const;

  /// Measured less true disparity, as estimated by bundle adjustment [px].
  ///
  /// After rectification the optical axes converge by a few tenths of a pixel, a scale error of
  /// percents at small disparities. It is observable because near and far landmarks then disagree
  /// on the length of the camera's motion.
  [[nodiscard]] double disparityOffset() const { return disparity_offset_px_; }
  /// Forgets what adjustments have told about it.
  void setDisparityOffset(double offset_px) {
    disparity_offset_px_ = offset_px;
    offset_record_ = {};
  }
  /// As an adjustment solved it, and what its observations alone tell, as OffsetRecord::add().
  void adjustDisparityOffset(double offset_px, const std::optional<stereo::OffsetEstimate>& seen,
                             double independent) {
    disparity_offset_px_ = offset_px;
    if (seen) offset_record_.add(*seen, independent);
  }
  /// Its standard deviation by all adjustments and the focal length's [px].
  [[nodiscard]] double offsetSigma() const {
    return std::hypot(offset_record_.estimate().sigma_px, stereo::kOffsetByFocalLength_px);
  }
  /// Whether it is to be corrected: where the right camera proved to be turned, in any case.
  [[nodiscard]] bool isOffsetCorrected() const {
    return right_turn_.y() != 0.0 || offset_record_.isCorrected();
  }
  /// The measurement without that offset.
  [[nodiscard]] stereo::StereoMeasurement corrected(stereo::StereoMeasurement measurement) const {
    measurement.disparity -= disparity_offset_px_;
    return measurement;
  }

  /// The right camera's rotation against its calibration that was undone in the right images of all
  /// measurements: pitch, yaw, roll [rad].
  [[nodiscard]] const Eigen::Vector3d& rightTurn() const { return right_turn_; }
  void setRightTurn(const Eigen::Vector3d& angles) { right_turn_ = angles; }

  /// Groups with landmarks and keyframes that changed since the last call, ascending.
  [[nodiscard]] std::vector<std::int64_t> takeChangedLandmarks() {
    return changed_landmarks_.take();
  }
  [[nodiscard]] std::vector<std::int64_t> takeChangedKeyframes() {
    return changed_keyframes_.take();
  }

  [[nodiscard]] const std::map<LandmarkId, Landmark>& landmarks() const { return landmarks_; }
  [[nodiscard]] const std::map<KeyframeId, Keyframe>& keyframes() const { return keyframes_; }

 private:
  void link(const Landmark& landmark);
  /// The odometry of the keyframe that follows a removed one begins where the removed one's began.
  void bridgeOdometry(const Keyframe& removed);
  /// Makes the nearest other keyframe that sees the landmark its reference, if there is one.
  void reassignReference(Landmark& landmark);

  std::map<LandmarkId, Landmark> landmarks_;
  std::map<KeyframeId, Keyframe> keyframes_;
  IdGroups changed_landmarks_;
  IdGroups changed_keyframes_;
  double disparity_offset_px_ = 0.0;
  stereo::OffsetRecord offset_record_;
  Eigen::Vector3d right_turn_ = Eigen::Vector3d::Zero();
  std::int64_t next_landmark_ = 0;
  std::int64_t next_keyframe_ = 0;
};

/// Replaces what a map assumes about the right camera's rotation against its calibration.
///
/// Disparities become those of right images that are turned back by the new rotation, the
/// disparities' offset that was a part of the old one becomes 0, and landmarks lie where their
/// reference keyframes measure them, in their old directions. Poses stay, and are to be adjusted.
///
/// @param angles  pitch, yaw, roll: rotation vector along the right camera's axes [rad]
void turnRightCamera(const Eigen::Vector3d& angles, const StereoCamera& camera, SparseMap& map);

/// How an adjustment changed the scale around each keyframe: the way to the next one, or else from
/// the one before, against that way before.
///
/// @param before  poses of the same keyframes before the adjustment
[[nodiscard]] std::map<KeyframeId, double> scaleChanges(const std::map<KeyframeId, Pose>& before,
                                                        const SparseMap& map);

}  // namespace headway::slam
