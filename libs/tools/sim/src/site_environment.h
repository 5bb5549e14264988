// SPDX-License-Identifier: BSD-3-Clause
// A hall, campus or warehouse as an environment, with the scene that is drawn of it.
#pragma once

#include "environment.h"
#include "site_traffic.h"

namespace headway::sim {

/// A site with a robot, people and vehicles.
class SiteEnvironment : public Environment {
 public:
  SiteEnvironment(const SimParams& params, const StereoCamera& camera,
                  Driver driver = Driver::kItself);

  void advance(double dt) override;
  [[nodiscard]] Pose T_world_robot() const override { return robot_.T_world_robot(); }
  [[nodiscard]] bool arrived() const override { return false; }
  [[nodiscard]] double pathLength() const override { return 0.0; }
  [[nodiscard]] std::vector<Actor> actors(double reach) override;
  [[nodiscard]] std::vector<PlacedMesh> staticMeshes(double reach) override;
  [[nodiscard]] std::vector<Drop> drops() const override { return site_.drops; }
  [[nodiscard]] WheeledRobot* drivenRobot() override { return robot_.course() ? &robot_ : nullptr; }
  [[nodiscard]] std::vector<Footprint> things() const override;
  [[nodiscard]] std::unique_ptr<Scene> makeScene(const StereoCamera& camera) override;

  [[nodiscard]] const Site& site() const { return site_; }
  [[nodiscard]] const NavigationGrid& grid() const { return grid_; }

 private:
  std::uint64_t seed_;
  Grain grain_;
  Site site_;
  NavigationGrid grid_;
  WheeledRobot robot_;
  std::int64_t next_id_ = 0;
  LoopVehicles vehicles_;
  Walkers walkers_;
  CoveringPeople cover_;
  std::vector<Actor> bicycles_;
};

}  // namespace headway::sim
