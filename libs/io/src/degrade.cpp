#include <headway/io/degrade.h>

#include <algorithm>
#include <cmath>

namespace headway::io {

void DegradeParams::describe(Params::Section section) {
  section.add("seed", seed, 0, 2147483647, "", "Seed of the random numbers");
  section.add("min_score", min_score, -1e9, 1e9, "", "Boxes at or below this score are left out");
  section.add("position_sigma_m", position_sigma_m, 0.0, 100.0, "m",
              "Noise of the position along the viewing ray, up to depth_scale_m away");
  section.add("depth_scale_m", depth_scale_m, 0.1, 1e6, "m",
              "Depth beyond which the noise grows in proportion to it");
  section.add("across_share", across_share, 0.0, 10.0, "",
              "Noise across the ray, as a share of that along it");
  section.add("drop_probability", drop_probability, 0.0, 1.0, "", "Share of boxes left out");
  section.add("double_probability", double_probability, 0.0, 1.0, "",
              "Share of the remaining boxes that come twice");
  section.add("double_sigma_m", double_sigma_m, 0.0, 100.0, "m",
              "Distance between such a box and its double, in each direction");
  section.add("flip_probability", flip_probability, 0.0, 1.0, "",
              "Share of boxes whose heading is turned by 180 degrees");
}

Degrader::Degrader(const DegradeParams& params)
    : params_(validated(params)), random_(static_cast<std::uint64_t>(params.seed)) {}

Detections Degrader::degrade(const Detections& detections) {
  Detections result = detections;
  result.items.clear();
  for (Detection detection : detections.items) {
    if (!(detection.score > params_.min_score)) continue;
    if (uniform() < params_.drop_probability) continue;
    if (detection.box3d) {
      moveCentre(*detection.box3d);
      if (uniform() < params_.flip_probability) {
        detection.box3d->yaw = wrapAngle(detection.box3d->yaw + M_PI);
      }
    }
    result.items.push_back(detection);
    if (uniform() < params_.double_probability) {
      if (detection.box3d) {
        detection.box3d->centre.x() += params_.double_sigma_m * normal();
        detection.box3d->centre.z() += params_.double_sigma_m * normal();
      }
      detection.detector_id.reset();
      result.items.push_back(detection);
    }
  }
  return result;
}

/// Moves the centre on the ground plane (x, z), where trackers are judged.
void Degrader::moveCentre(Box3d& box) {
  const double depth = box.centre.z();
  const double sigma = params_.position_sigma_m * std::max(1.0, depth / params_.depth_scale_m);
  const Eigen::Vector2d ground(box.centre.x(), box.centre.z());
  const double range = ground.norm();
  const Eigen::Vector2d along =
      range > 0.0 ? Eigen::Vector2d(ground / range) : Eigen::Vector2d(Eigen::Vector2d::UnitY());
  const Eigen::Vector2d across(-along.y(), along.x());
  const double along_noise = sigma * normal();
  const double across_noise = params_.across_share * sigma * normal();
  const Eigen::Vector2d moved = ground + along_noise * along + across_noise * across;
  box.centre.x() = moved.x();
  box.centre.z() = moved.y();
}

double Degrader::uniform() { return static_cast<double>(random_() >> 11) * 0x1.0p-53; }

/// Box and Muller 1958; the standard library's normal_distribution differs between platforms.
double Degrader::normal() {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * M_PI * uniform());
}

}  // namespace headway::io
