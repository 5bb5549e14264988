// SPDX-License-Identifier: BSD-3-Clause
// Place recognition: keyframes with similar descriptors, and the pose that their landmarks give.
#pragma once

#include <headway/core/ids.h>
#include <headway/core/stereo_camera.h>

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "frame_tracker.h"
#include "keypoints.h"
#include "sparse_map.h"

namespace headway::slam {

/// A keyframe that looks like what was asked for.
struct PlaceMatch {
  KeyframeId keyframe;
  double score = 0.0;  ///< descriptors found again, each counting the more the fewer places have it
};

/// Finds keyframes by the descriptors seen in them, without a vocabulary.
///
/// Words are a few bits of a descriptor, picked at random once (locality-sensitive hashing):
/// nothing to train, load or ship. An inverted list a word makes the cost of a query grow with the
/// words shared, not with the map; a shared word counts only if the whole descriptors are near,
/// so that chance matches do not count.
///
/// @see Indyk & Motwani 1998 (LSH); Sivic & Zisserman 2003 (inverted lists)
class PlaceIndex {
 public:
  PlaceIndex();
  PlaceIndex(const PlaceIndex&) = delete;
  PlaceIndex& operator=(const PlaceIndex&) = delete;

  void add(KeyframeId keyframe, const std::vector<Descriptor>& descriptors);
  void remove(KeyframeId keyframe);

  /// The keyframes most alike, best first, of those that are wanted.
  [[nodiscard]] std::vector<PlaceMatch> query(const std::vector<Descriptor>& descriptors, int count,
                                              const std::function<bool(KeyframeId)>& wanted) const;

 private:
  static constexpr int kTables = 6;
  static constexpr int kBits = 16;
  using Links = std::array<std::int32_t, kTables>;  ///< an index for each table; -1: none
  /// A descriptor, in a list for each of its words. Keyframes that see one landmark share its
  /// entry.
  struct Entry {
    Descriptor descriptor{};
    Links next{};                       ///< entry after this one in the list of its word
    std::vector<KeyframeId> keyframes;  ///< with this descriptor
  };
  /// Index in heads_ of the descriptor's word in each table.
  [[nodiscard]] std::array<std::size_t, kTables> wordsOf(const Descriptor& descriptor) const;
  /// Entry of the descriptor, made if there is none.
  [[nodiscard]] std::int32_t entryOf(const Descriptor& descriptor);
  void remove(std::int32_t entry);
  /// Keyframes that have seen (nearly) this descriptor, ascending.
  [[nodiscard]] std::vector<KeyframeId> keyframesWith(const Descriptor& descriptor) const;

  std::array<std::array<int, kBits>, kTables> bits_{};
  std::vector<std::int32_t> heads_;  ///< first entry of each word's list; -1: none
  std::deque<Entry> entries_;
  std::vector<std::int32_t> free_;                              ///< entries to be used again
  std::map<KeyframeId, std::vector<std::int32_t>> entries_of_;  ///< indices
};

/// Result of recognising a frame by its descriptors.
struct Recognition {
  std::optional<Pose> T_map_cam;  ///< good to a few pixels; nullopt if too few agree
  int inliers = 0;                ///< descriptors that agree on a pose
};

/// The pose of a frame of which nothing is known but its image: corners are recognised by their
/// descriptors among the given landmarks, and a consensus of them gives the pose.
///
/// @param points       corners of the frame
/// @param among        landmarks to search for, ascending
/// @param min_inliers  landmarks that must agree
[[nodiscard]] Recognition relocalise(const std::vector<DescribedPoint>& points,
                                     const std::vector<LandmarkId>& among, const SparseMap& map,
                                     const StereoCamera& camera, int min_inliers);

}  // namespace headway::slam
