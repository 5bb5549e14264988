// SPDX-License-Identifier: BSD-3-Clause
// What houses hide.
#include "occlusion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "mesh_projection.h"

namespace headway::sim {
namespace {

using Eigen::Vector3f;

// How much nearer to a block's middle than its edges pixels must lie to be called filled: more than
// what OpenGL rounds corners by [px].
constexpr float kMargin = 0.06F;

/// Corners in front of the camera, and where edges pass its near plane.
std::vector<Vector3f> cutBlock(const Block& block, const Eigen::Isometry3f& T_cam_block) {
  Block corners;
  std::transform(block.begin(), block.end(), corners.begin(),
                 [&](const Vector3f& corner) { return T_cam_block * corner; });
  std::vector<Vector3f> points;
  const auto cutEdge = [&](std::size_t i, std::size_t k) {
    const Vector3f &a = corners[i], &b = corners[k];
    if ((a.z() >= kNearPlane) == (b.z() >= kNearPlane)) return;
    points.push_back(a + (kNearPlane - a.z()) / (b.z() - a.z()) * (b - a));
  };
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t next = (i + 1) % 4;
    cutEdge(i, next);
    cutEdge(4 + i, 4 + next);
    cutEdge(i, 4 + i);
  }
  std::copy_if(corners.begin(), corners.end(), std::back_inserter(points),
               [](const Vector3f& corner) { return corner.z() >= kNearPlane; });
  return points;
}

/// Rows that an outline spans at one place of a column.
struct SpannedRows {
  float top = std::numeric_limits<float>::max(), bottom = -top;
};

/// Rows that a convex outline spans a little beside each column from `first` to `last`, on either
/// side: those in common are filled.
std::vector<std::array<SpannedRows, 2>> columnSpans(const std::vector<cv::Point2f>& outline,
                                                    int first, int last) {
  std::vector<std::array<SpannedRows, 2>> spans(static_cast<std::size_t>(last - first + 1));
  for (std::size_t i = 0; i < outline.size(); ++i) {
    cv::Point2f a = outline[i], b = outline[(i + 1) % outline.size()];
    if (a.x > b.x) std::swap(a, b);
    if (b.x - a.x < 1e-6F) continue;
    const int from = std::max(first, static_cast<int>(std::floor(std::max(a.x, -1.0F))));
    const int to = static_cast<int>(std::ceil(std::min(b.x, static_cast<float>(last))));
    for (int u = from; u <= std::min(to, last); ++u) {
      for (const std::size_t side : {0U, 1U}) {
        const float x = static_cast<float>(u) + (side == 0 ? -kMargin : kMargin);
        if (x < a.x || x > b.x) continue;
        const float v = a.y + (b.y - a.y) * (x - a.x) / (b.x - a.x);
        SpannedRows& rows = spans[static_cast<std::size_t>(u - first)][side];
        rows.top = std::min(rows.top, v);
        rows.bottom = std::max(rows.bottom, v);
      }
    }
  }
  return spans;
}

}  // namespace

Occlusion::Occlusion(const StereoCamera& camera, const Eigen::Isometry3d& T_cam_origin)
    : camera_(camera),
      T_cam_origin_(T_cam_origin),
      columns_(static_cast<std::size_t>(camera.width)) {}

Eigen::Isometry3f Occlusion::place(const Eigen::Vector3d& offset) const {
  return (T_cam_origin_ * Eigen::Translation3d(offset)).cast<float>();
}

bool Occlusion::fills(int column, float top, float bottom, float depth) const {
  const auto& filled = columns_[static_cast<std::size_t>(column)];
  return std::any_of(filled.begin(), filled.end(), [&](const Filled& part) {
    return part.depth < depth && part.top <= top && part.bottom >= bottom;
  });
}

void Occlusion::add(const Block& block, const Eigen::Vector3d& offset) {
  const auto points = cutBlock(block, place(offset));
  if (points.size() < 3) return;
  std::vector<cv::Point2f> corners, outline;
  float depth = 0.0F, left = std::numeric_limits<float>::max(), right = -left;
  for (const Vector3f& p : points) {
    corners.emplace_back(
        static_cast<float>(camera_.fx) * p.x() / p.z() + static_cast<float>(camera_.cx),
        static_cast<float>(camera_.fy) * p.y() / p.z() + static_cast<float>(camera_.cy));
    depth = std::max(depth, p.z());
    left = std::min(left, corners.back().x);
    right = std::max(right, corners.back().x);
  }
  const int first = std::max(0, static_cast<int>(std::ceil(std::max(left, -1.0F) + kMargin)));
  const int last = std::min(
      camera_.width - 1,
      static_cast<int>(std::floor(std::min(right, static_cast<float>(camera_.width)) - kMargin)));
  if (first > last) return;
  cv::convexHull(corners, outline);
  const auto spans = columnSpans(outline, first, last);
  for (int u = first; u <= last; ++u) {
    const auto& [before, after] = spans[static_cast<std::size_t>(u - first)];
    const Filled filled{std::max(before.top, after.top) + kMargin,
                        std::min(before.bottom, after.bottom) - kMargin, depth};
    if (filled.top < filled.bottom && !fills(u, filled.top, filled.bottom, depth)) {
      columns_[static_cast<std::size_t>(u)].push_back(filled);
    }
  }
}

bool Occlusion::hides(const std::vector<Vector3f>& points, const Eigen::Vector3d& offset) const {
  const Eigen::Isometry3f T_cam_points = place(offset);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  float left = kInf, right = -kInf, top = kInf, bottom = -kInf, depth = kInf;
  for (const Vector3f& point : points) {
    const Vector3f p = T_cam_points * point;
    if (p.z() < kNearPlane) return false;
    const float u = static_cast<float>(camera_.fx) * p.x() / p.z() + static_cast<float>(camera_.cx);
    const float v = static_cast<float>(camera_.fy) * p.y() / p.z() + static_cast<float>(camera_.cy);
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
    depth = std::min(depth, p.z());
  }
  // Clipped by the image, with a pixel to spare.
  const int first = static_cast<int>(std::floor(std::max(left - 1.0F, 0.0F)));
  const int last =
      static_cast<int>(std::ceil(std::min(right + 1.0F, static_cast<float>(camera_.width - 1))));
  top = std::max(top - 1.0F, 0.0F);
  bottom = std::min(bottom + 1.0F, static_cast<float>(camera_.height - 1));
  if (first > last || top > bottom) return true;
  for (int u = first; u <= last; ++u) {
    if (!fills(u, top, bottom, depth)) return false;
  }
  return true;
}

}  // namespace headway::sim
