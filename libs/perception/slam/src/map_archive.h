// SPDX-License-Identifier: BSD-3-Clause
// The map as it leaves SLAM: as bytes, cropped, and as a view.
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/stereo_camera.h>
#include <headway/slam/map_view.h>

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sparse_map.h"

namespace headway::slam {

/// The whole map as bytes: version, camera, keyframes, landmarks with patches and descriptors. The
/// patches, two thirds of them, are shared with the map and are only copied into the sink.
[[nodiscard]] ByteSource mapBytes(const SparseMap& map, const StereoCamera& camera);

/// The same in one string.
///
/// Law: unpackMap(packMap(map)) has the same landmarks, keyframes and links, bit by bit.
[[nodiscard]] std::string packMap(const SparseMap& map, const StereoCamera& camera);

/// Reads what packMap wrote.
///
/// @param camera  that is going to use the map; empty: any
/// @param made_by  gets the camera of the map, without its pose on the robot; null: not wanted
/// @throws InputError if the bytes are cut off, damaged, of another version, or the map was made
///         with another camera
[[nodiscard]] SparseMap unpackMap(const std::string& bytes,
                                  const std::optional<StereoCamera>& camera,
                                  StereoCamera* made_by = nullptr);

/// Makes views of a map that grows: what did not change since the view before is shared with it.
///
/// Keyframes of a view are where the robot was, not its camera.
class MapViewMaker {
 public:
  explicit MapViewMaker(const Pose& T_cam_robot) : T_cam_robot_(T_cam_robot) {}

  /// @param map     the same in each call, or one that was loaded in its place after reset()
  /// @param submap  whose landmarks and keyframes are in the view
  [[nodiscard]] MapView make(SparseMap& map, int submap);
  void reset() {
    landmarks_.clear();
    keyframes_.clear();
  }

 private:
  template <typename View>
  using Groups = std::map<std::int64_t, std::shared_ptr<const std::vector<View>>>;

  Pose T_cam_robot_;
  int submap_ = 0;
  Groups<LandmarkView> landmarks_;
  Groups<KeyframeView> keyframes_;
};

/// A single view.
[[nodiscard]] MapView makeMapView(const SparseMap& map, const Pose& T_cam_robot, int submap);

}  // namespace headway::slam
