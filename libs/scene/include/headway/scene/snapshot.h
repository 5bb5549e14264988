#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/map/perception_map.h>
#include <headway/render/offscreen_renderer.h>

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace headway::scene {

/// From where the map is looked at.
enum class View {
  kFollow,  ///< from behind and above the robot
  kTop,     ///< straight down, the robot's heading upwards
  kOrbit,   ///< around the robot, one turn in 360 frames
  kCamera,  ///< through the robot's camera: drawn over its image
};

/// "follow", "top", "orbit" or "camera"; nullopt for any other word.
[[nodiscard]] std::optional<View> viewFrom(std::string_view name);

struct SnapshotOptions {
  int width = 1280;  ///< [px]
  int height = 720;  ///< [px]
  View view = View::kFollow;
  int supersampling = 2;  ///< 1 is fastest, 2 has smooth edges
};

/// The world at one frame, and what to show of it besides the map.
struct SnapshotInput {
  const map::PerceptionMap& map;
  std::size_t frame = 0;
  Time time = 0.0;  ///< [s]
  Pose T_map_robot = Pose::Identity();
  std::shared_ptr<const StereoCamera> camera = {};  ///< null: no frustum, no `camera` view
  cv::Mat image = {};                               ///< left image, BGR or grey; empty: no inset
  std::vector<Stamped<Pose>> path = {};             ///< of the robot so far, oldest first
  std::vector<Stamped<Pose>> true_path = {};        ///< empty where there is no truth
  std::vector<Track> true_objects = {};             ///< at this time; empty where there is no truth
};

/// Draws the map as a picture: landmarks, camera path, boxes coloured by class with ids, past
/// paths, predictions as green dashes, with legend, scale, time and the camera's image.
///
/// Belongs to the thread that made it (as OffscreenRenderer).
///
///     SnapshotRenderer snapshots({1280, 720, View::kFollow});
///     cv::Mat picture = snapshots.draw({map, frame.index, frame.time, T_map_robot, camera,
///     image});
class SnapshotRenderer {
 public:
  /// @throws render::RendererUnavailable if there is no OpenGL (never for the `camera` view)
  explicit SnapshotRenderer(const SnapshotOptions& options);
  ~SnapshotRenderer();
  SnapshotRenderer(SnapshotRenderer&&) noexcept;
  SnapshotRenderer& operator=(SnapshotRenderer&&) noexcept;

  /// @return 8-bit BGR of the size asked for
  [[nodiscard]] cv::Mat draw(const SnapshotInput& input);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// Writes the same world as `.3Dscene`, which MRPT's SceneViewer3D opens. Needs no OpenGL.
///
/// @throws InputError if the file cannot be written
void saveScene(const std::string& path, const SnapshotInput& input);

}  // namespace headway::scene
