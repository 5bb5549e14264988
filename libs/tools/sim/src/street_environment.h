// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "environment.h"
#include "traffic.h"
#include "world.h"

namespace headway::sim {

/// Streets through a town, and the traffic on them.
class StreetEnvironment : public Environment {
 public:
  /// @param camera  in whose left image the escort covers its ratio
  StreetEnvironment(const SimParams& params, const StereoCamera& camera);

  void advance(double dt) override { traffic_.advance(dt); }
  void observe() override { traffic_.observe(); }
  [[nodiscard]] Pose T_world_robot() const override { return traffic_.robot().T_world_robot(); }
  [[nodiscard]] bool arrived() const override { return traffic_.robot().arrived(); }
  [[nodiscard]] double pathLength() const override { return route_.end_s - route_.start_s; }
  [[nodiscard]] std::vector<Actor> actors(double reach) override;
  [[nodiscard]] std::vector<PlacedMesh> staticMeshes(double reach) override;
  [[nodiscard]] std::unique_ptr<Scene> makeScene(const StereoCamera& camera) override;

 private:
  Route route_;
  World world_;
  Traffic traffic_;
};

}  // namespace headway::sim
