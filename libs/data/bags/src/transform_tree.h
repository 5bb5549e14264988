// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/pose.h>

#include <map>
#include <optional>
#include <string>

#include "messages.h"

namespace headway::bags {

/// Frames of a robot and how they are mounted on each other, by its recorded transforms.
///
/// Of a frame that moves the first transform is kept: mounted sensors do not move.
class TransformTree {
 public:
  /// @param is_static  replaces what is known of the child frame
  void add(const TransformMessage& transform, bool is_static);
  [[nodiscard]] bool contains(const std::string& frame) const;
  /// Pose of frame b in frame a; nullopt if they are not connected.
  [[nodiscard]] std::optional<Pose> between(const std::string& a, const std::string& b) const;

 private:
  struct Parent {
    std::string frame;
    Pose T_parent_child = Pose::Identity();
    bool is_static = false;
  };
  /// The frame and all above it, with the pose of `frame` in each.
  [[nodiscard]] std::map<std::string, Pose> ancestorsOf(const std::string& frame) const;

  std::map<std::string, Parent> parents_;  ///< by child
};

}  // namespace headway::bags
