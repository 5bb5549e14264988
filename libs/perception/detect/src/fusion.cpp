// SPDX-License-Identifier: BSD-3-Clause
// Joins what several detectors found in one frame.
#include <headway/core/assignment.h>
#include <headway/core/box_overlap.h>
#include <headway/detect/fusion.h>

#include <algorithm>
#include <cmath>

namespace headway::detect {
namespace {

bool overlapInImage(const Box2d& a, const Box2d& b, const FusionParams& params) {
  return overlap2d(a, b) > params.same_iou || ratioInside(a, b) > params.same_inside ||
         ratioInside(b, a) > params.same_inside;
}

// Distance over the ground beyond what half the greater box explains.
double distance(const Box3d& a, const Box3d& b) {
  const double off = std::hypot(a.centre.x() - b.centre.x(), a.centre.z() - b.centre.z());
  return std::max(0.0, off - 0.25 * std::max(a.length, b.length));
}

bool sameObject(const Detection& a, const Detection& b, const FusionParams& params) {
  const bool both_2d = a.box2d && b.box2d;
  const bool both_3d = a.box3d && b.box3d;
  if (!both_2d && !both_3d) return false;
  if (both_2d && !overlapInImage(*a.box2d, *b.box2d, params)) return false;
  return !both_3d || distance(*a.box3d, *b.box3d) < params.same_distance_m;
}

double costOf(const Detection& a, const Detection& b) {
  const double overlap = a.box2d && b.box2d ? overlap2d(*a.box2d, *b.box2d) : 0.0;
  const double off = a.box3d && b.box3d ? distance(*a.box3d, *b.box3d) : 0.0;
  return 1.0 - overlap + off;
}

void complete(Detection& kept, const Detection& other, const FusionParams& params) {
  if (params.rider_by_motion && kept.object_class == ObjectClass::kPedestrian &&
      other.object_class == ObjectClass::kCyclist && other.evidence.motion) {
    kept.object_class = ObjectClass::kCyclist;
  }
  if (kept.object_class == ObjectClass::kUnknown) kept.object_class = other.object_class;
  if (!kept.box2d) kept.box2d = other.box2d;
  if (!kept.box3d) {
    kept.box3d = other.box3d;
    kept.centre_covariance = other.centre_covariance;
  }
  if (!kept.velocity) kept.velocity = other.velocity;
  if (!kept.searched_track) kept.searched_track = other.searched_track;
  if (!kept.mask) kept.mask = other.mask;
  if (!kept.appearance) kept.appearance = other.appearance;
  // A classifier that is told otherwise by motion leaves the class open.
  kept.evidence.classifier = kept.evidence.classifier ||
                             (other.evidence.classifier && kept.object_class == other.object_class);
  kept.evidence.motion = kept.evidence.motion || other.evidence.motion;
  kept.evidence.change = kept.evidence.change || other.evidence.change;
  kept.evidence.appearance = kept.evidence.appearance || other.evidence.appearance;
  kept.evidence.periodic = kept.evidence.periodic && other.evidence.periodic;
  if (!kept.detector_id) kept.detector_id = other.detector_id;
}

}  // namespace

FusedDetections fuse(const std::vector<Detections>& sources, const FusionParams& params) {
  FusedDetections fused;
  if (sources.empty()) return fused;
  Detections& result = fused.detections;
  result = sources.front();
  for (std::size_t s = 1; s < sources.size(); ++s) {
    const auto& more = sources[s].items;
    const std::size_t known = result.items.size();
    std::vector<CandidatePair> candidates;
    std::vector<bool> doubled(more.size(), false);
    for (std::size_t i = 0; i < known; ++i) {
      for (std::size_t j = 0; j < more.size(); ++j) {
        if (!sameObject(result.items[i], more[j], params)) continue;
        candidates.push_back({i, j, costOf(result.items[i], more[j])});
        doubled[j] = true;
      }
    }
    std::size_t dropped =
        static_cast<std::size_t>(std::count(doubled.begin(), doubled.end(), true));
    for (const auto& pair : assignPairs(std::move(candidates))) {
      complete(result.items[pair.row], more[pair.column], params);
      --dropped;
    }
    for (std::size_t j = 0; j < more.size(); ++j) {
      if (!doubled[j]) result.items.push_back(more[j]);
    }
    if (dropped > 0) fused.dropped["part_of_other"] += dropped;
  }
  return fused;
}

}  // namespace headway::detect
