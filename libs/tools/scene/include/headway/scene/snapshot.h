// SPDX-License-Identifier: BSD-3-Clause
// Annotated pictures of a map.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/map/perception_map.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace headway::scene {

/// Viewpoint of a picture.
enum class View {
  kFollow,  ///< from behind and above the robot
  kTop,     ///< from above, the robot's heading upwards
  kOrbit,   ///< around the robot, one revolution in 360 frames
  kCamera,  ///< the robot's camera, drawn over its image
};

/// View of the name "follow", "top", "orbit" or "camera"; nullopt for other names.
[[nodiscard]] std::optional<View> viewFrom(std::string_view name);

/// Colours of a picture.
enum class Theme { kDark, kLight };

/// Theme of the name "dark" or "light"; nullopt for other names.
[[nodiscard]] std::optional<Theme> themeFrom(std::string_view name);

/// What a picture or scene of the map shows.
struct SnapshotOptions {
  int width = 1280;  ///< [px]
  int height = 720;  ///< [px]
  View view = View::kFollow;
  int supersampling = 2;  ///< 1: fastest, 2: antialiased edges
  Theme theme = Theme::kDark;
  bool dense = true;  ///< show the dense map, if there is one
};

/// Map and recording at one frame.
struct SnapshotInput {
  const map::PerceptionMap& map;
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  Pose T_map_robot = Pose::Identity();
  std::shared_ptr<const StereoCamera> camera = {};  ///< null: no frustum and no `camera` view
  cv::Mat image = {};                               ///< left image, BGR or grey; empty: no inset
  std::vector<Stamped<Pose>> path = {};             ///< of the robot up to this frame, oldest first
  std::vector<Stamped<Pose>> true_path = {};        ///< empty without truth
  std::vector<Track> true_objects = {};             ///< at this time; empty without truth
};

/// Renders the map as a picture: dense map, landmarks, camera path, labelled boxes in class
/// colours, past paths, predictions as green dashes, legend, scale, time and the camera image.
/// Requires neither a display nor OpenGL; the same input gives the same bytes.
///
/// Labels cover neither each other nor boxes; those that find no place are left out.
///
///     SnapshotRenderer snapshots({1280, 720, View::kFollow});
///     cv::Mat picture = snapshots.draw({map, frame.index, frame.time, T_map_robot, camera,
///                                     image});
class SnapshotRenderer {
 public:
  explicit SnapshotRenderer(const SnapshotOptions& options);
  ~SnapshotRenderer();
  SnapshotRenderer(SnapshotRenderer&&) noexcept;
  SnapshotRenderer& operator=(SnapshotRenderer&&) noexcept;

  /// @return 8-bit BGR, options.height x options.width
  [[nodiscard]] cv::Mat draw(const SnapshotInput& input);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes the map as a `.3Dscene` file for MRPT's SceneViewer3D, which opens it from behind the
/// robot. Requires no OpenGL.
///
/// @param options  theme and layers
/// @throws InputError if the file cannot be written
void saveScene(const std::string& path, const SnapshotInput& input,
               const SnapshotOptions& options = {});

}  // namespace headway::scene
