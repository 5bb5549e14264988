#include "ground.h"

#include <algorithm>

namespace headway::scene {
namespace {

constexpr double kNearM = 40.0;
constexpr std::size_t kFewestBoxes = 3;
constexpr std::size_t kFewestLandmarks = 50;
constexpr double kGroundShare = 0.08;  ///< of the landmarks around, lie lower than the ground

bool isNear(const Eigen::Vector3d& point, const SnapshotInput& input) {
  return (point - input.T_map_robot.translation()).head<2>().norm() < kNearM;
}

double percentileOf(std::vector<double>& values, double share) {
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

}  // namespace

double groundHeight(const SnapshotInput& input) {
  std::vector<double> heights;
  for (const auto& track : input.map.movingObjects().tracks()) {
    if (isNear(track.position, input)) {
      heights.push_back(track.position.z() - 0.5 * track.size.z());
    }
  }
  if (heights.size() >= kFewestBoxes) return percentileOf(heights, 0.5);
  heights.clear();
  for (const auto& landmark : input.map.stillWorld()->landmarks) {
    if (isNear(landmark.position, input)) heights.push_back(landmark.position.z());
  }
  if (heights.size() >= kFewestLandmarks) return percentileOf(heights, kGroundShare);
  return input.T_map_robot.translation().z();
}

}  // namespace headway::scene
