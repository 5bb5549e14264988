// SPDX-License-Identifier: BSD-3-Clause
// Pictures of the map during a run, and the scene at its end.
#pragma once

#include <headway/core/recorded_frame.h>
#include <headway/pipeline/perception.h>
#include <headway/scene/snapshot.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace headway::replay {

/// Draws pictures of the map, evenly spaced over the rawlog, and writes the final scene.
class Snapshots {
 public:
  Snapshots(std::filesystem::path folder, int count, scene::Theme theme)
      : folder_(std::move(folder)), count_(count) {
    look_.theme = theme;
  }

  /// Whether a picture is due with the next frame.
  ///
  /// @param progress  ratio of the rawlog that is processed, 0 to 1
  [[nodiscard]] bool isDue(double progress) const;

  /// Stores the frame and draws a picture if one is due.
  void add(const pipeline::Perception& perception, const pipeline::PerceptionUpdate& update,
           const RecordedFrame& frame, double progress);

  /// The map is moved, and the way in it: what is drawn from now on follows.
  void move(const Pose& T_map_run);

  /// Writes scene.3Dscene of the latest frame.
  void finish(const pipeline::Perception& perception);

  /// Names of the pictures written so far, in `snapshots/`.
  [[nodiscard]] const std::vector<std::filesystem::path>& written() const { return written_; }

 private:
  void addToPath(const Stamped<Pose>& pose);
  [[nodiscard]] scene::SnapshotInput input(const pipeline::Perception& perception) const;
  void draw(const pipeline::Perception& perception);

  std::filesystem::path folder_;
  int count_;
  scene::SnapshotOptions look_;
  std::unique_ptr<scene::SnapshotRenderer> renderer_;  ///< created for the first picture
  std::vector<std::filesystem::path> written_;
  std::vector<Stamped<Pose>> path_;  ///< every path_step_-th tracked pose
  std::size_t path_step_ = 1;
  std::size_t tracked_ = 0;  ///< frames
  std::optional<RecordedFrame> last_;
  Pose T_map_robot_ = Pose::Identity();
};

}  // namespace headway::replay
