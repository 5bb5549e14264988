// SPDX-License-Identifier: BSD-3-Clause
#include "transform_tree.h"

#include <algorithm>

namespace headway::bags {
namespace {

constexpr std::size_t kMaxFrames = 10000;
constexpr std::size_t kMaxDepth = 100;

}  // namespace

void TransformTree::add(const TransformMessage& transform, bool is_static) {
  const auto known = parents_.find(transform.child_frame);
  if (known != parents_.end() && (known->second.is_static || !is_static)) return;
  if (known == parents_.end() && parents_.size() == kMaxFrames) return;
  parents_[transform.child_frame] = {transform.header.frame, transform.T_parent_child, is_static};
}

bool TransformTree::contains(const std::string& frame) const {
  return parents_.count(frame) > 0 ||
         std::any_of(parents_.begin(), parents_.end(),
                     [&](const auto& entry) { return entry.second.frame == frame; });
}

std::optional<Pose> TransformTree::between(const std::string& a, const std::string& b) const {
  if (a == b) return Pose::Identity();
  const auto above_a = ancestorsOf(a);
  Pose T_above_b = Pose::Identity();
  std::string frame = b;
  for (std::size_t depth = 0; depth < kMaxDepth; ++depth) {
    const auto common = above_a.find(frame);
    if (common != above_a.end()) return common->second.inverse() * T_above_b;
    const auto parent = parents_.find(frame);
    if (parent == parents_.end()) return std::nullopt;
    T_above_b = parent->second.T_parent_child * T_above_b;
    frame = parent->second.frame;
  }
  return std::nullopt;
}

std::map<std::string, Pose> TransformTree::ancestorsOf(const std::string& frame) const {
  std::map<std::string, Pose> result = {{frame, Pose::Identity()}};
  Pose T_above_frame = Pose::Identity();
  std::string current = frame;
  for (std::size_t depth = 0; depth < kMaxDepth; ++depth) {
    const auto parent = parents_.find(current);
    if (parent == parents_.end()) break;
    T_above_frame = parent->second.T_parent_child * T_above_frame;
    current = parent->second.frame;
    result.emplace(current, T_above_frame);
  }
  return result;
}

}  // namespace headway::bags
