// SPDX-License-Identifier: BSD-3-Clause
// Fusion of the depth scans of a tile to at most one point a voxel.
#include "dense_fusion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "scan_view.h"

namespace headway::map {
namespace {

/// Numbers voxels of a tile in the order in which they are first seen: an open hash table, because
/// millions are looked up and std::unordered_map takes several times as long.
class VoxelIndex {
 public:
  /// The number of a voxel, given if it has none.
  std::uint32_t numberOf(std::uint32_t key) {
    Slot& slot = slots_[find(key)];
    if (slot.number >= 0) return static_cast<std::uint32_t>(slot.number);
    const auto number = static_cast<std::int32_t>(keys_.size());
    slot = {key, number};
    keys_.push_back(key);
    if (2 * keys_.size() > slots_.size()) grow();
    return static_cast<std::uint32_t>(number);
  }

  [[nodiscard]] bool contains(std::uint32_t key) const { return slots_[find(key)].number >= 0; }

  /// Keys by number.
  [[nodiscard]] const std::vector<std::uint32_t>& keys() const { return keys_; }

 private:
  struct Slot {
    std::uint32_t key = 0;
    std::int32_t number = -1;  ///< none
  };
  [[nodiscard]] std::size_t find(std::uint32_t key) const {
    std::size_t at = (key * 0x9e3779b1U) >> shift_;  // Knuth's multiplicative hash
    while (slots_[at].number >= 0 && slots_[at].key != key) at = (at + 1) & (slots_.size() - 1);
    return at;
  }
  void grow() {
    slots_.assign(2 * slots_.size(), {});
    --shift_;
    for (std::uint32_t number = 0; number < keys_.size(); ++number) {
      slots_[find(keys_[number])] = {keys_[number], static_cast<std::int32_t>(number)};
    }
  }

  std::uint32_t shift_ = 20;  ///< 32 less the binary logarithm of the number of slots
  std::vector<Slot> slots_ = std::vector<Slot>(std::size_t{1} << (32U - shift_));
  std::vector<std::uint32_t> keys_;
};

constexpr int kMarginVoxels = 4;     // round a tile, whose candidates may be moved into it
constexpr int kMaxEvidence = 4;      // of a voxel, which three scans that see through it remove
constexpr int kMinEvidence = -3;     // which five scans that hit it again restore
constexpr int kMinNeighbours = 2;    // of a point, in the 26 voxels round it
constexpr float kPoseSigma = 0.25F;  // of the surface by poses and sampling [voxels]

using Rgb = Eigen::Vector3f;

/// Voxels of a tile and its margin as 32-bit keys: 9 bits for x and y, 14 for z.
class VoxelKeys {
 public:
  explicit VoxelKeys(float voxel_m) : inverse_(1.0F / voxel_m) {}

  /// nullopt outside of the tile and its margin.
  [[nodiscard]] std::optional<std::uint32_t> keyOf(const Eigen::Vector3f& point,
                                                   int margin_voxels) const {
    const Eigen::Array3f at = (point * inverse_).array().floor();
    const auto margin = static_cast<float>(margin_voxels);
    const bool is_inside = at.x() >= -margin && at.y() >= -margin &&
                           at.x() < kTileVoxels + margin && at.y() < kTileVoxels + margin &&
                           std::abs(at.z()) < kMiddle - 1;
    if (!is_inside) return std::nullopt;
    return key(static_cast<int>(at.x()), static_cast<int>(at.y()),
               static_cast<int>(at.z()) + kMiddle);
  }

  /// The 26 voxels round one inside of the margin.
  template <typename Use>
  static void forNeighbours(std::uint32_t of, const Use& use) {
    for (std::uint32_t dx = 0; dx < 3; ++dx) {
      for (std::uint32_t dy = 0; dy < 3; ++dy) {
        for (std::uint32_t dz = 0; dz < 3; ++dz) {
          if (dx == 1 && dy == 1 && dz == 1) continue;
          use(of + ((dx - 1) << 23U) + ((dy - 1) << 14U) + (dz - 1));  // modulo 2^32
        }
      }
    }
  }

 private:
  static constexpr int kMiddle = 1 << 13;

  static std::uint32_t key(int x, int y, int z) {
    const auto column = static_cast<std::uint32_t>(x + kMarginVoxels);
    const auto row = static_cast<std::uint32_t>(y + kMarginVoxels);
    return (column << 23U) | (row << 14U) | static_cast<std::uint32_t>(z);
  }

  float inverse_;
};

/// Weighted mean of points and colours.
struct Sum {
  float weight = 0.0F;
  Eigen::Vector3f point = Eigen::Vector3f::Zero();
  Rgb colour = Rgb::Zero();

  void add(const Eigen::Vector3f& p, const Rgb& c, float w) {
    weight += w;
    point += w * p;
    colour += w * c;
  }
};

/// A voxel that scans hit.
struct Candidate {
  Eigen::Vector3f point;
  Rgb colour;
  float variance;  ///< of the most precise hit, along its ray [m^2]
  int evidence = 0;
  bool was_seen_through = false;
  float weight = 0.0F;  ///< of the scans that agree
  Eigen::Vector3f shift = Eigen::Vector3f::Zero();
};

class TileFusion {
 public:
  TileFusion(const Eigen::Vector2d& corner, double voxel_m, const std::vector<PosedScan>& scans)
      : voxel_(static_cast<float>(voxel_m)), keys_(voxel_) {
    for (const auto& posed : scans) views_.emplace_back(*posed.scan, posed.T_map_robot, corner);
  }

  [[nodiscard]] DenseTile run() {
    findCandidates();
    for (const auto& view : views_) {
      for (auto& candidate : candidates_) compare(view, candidate);
    }
    return points();
  }

 private:
  [[nodiscard]] float weightOf(float variance) const {
    const float sampling = kPoseSigma * voxel_;
    return 1.0F / (variance + sampling * sampling);
  }

  void findCandidates() {
    VoxelIndex index;
    std::vector<Sum> sums;
    std::vector<float> variances;
    for (const auto& view : views_) {
      view.forEachSurfacePoint(
          voxel_, [&](const Eigen::Vector3f& point, const Rgb& colour, float variance) {
            const auto key = keys_.keyOf(point, kMarginVoxels);
            if (!key) return;
            const std::uint32_t number = index.numberOf(*key);
            if (number == sums.size()) {
              sums.emplace_back();
              variances.push_back(variance);
            }
            sums[number].add(point, colour, weightOf(variance));
            variances[number] = std::min(variances[number], variance);
          });
    }
    candidates_.reserve(sums.size());
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Sum& sum = sums[i];
      candidates_.push_back({sum.point / sum.weight, sum.colour / sum.weight, variances[i]});
    }
  }

  void compare(const ScanView& view, Candidate& candidate) const {
    const auto look = view.lookAt(candidate.point);
    if (!look) return;
    const float further = look->measured - look->depth;
    const float tolerance =
        kDepthSigmas * std::sqrt(look->variance + candidate.variance) + 0.5F * voxel_;
    if (std::abs(further) <= tolerance) {
      const float weight = weightOf(look->variance);
      candidate.evidence = std::min(candidate.evidence + 1, kMaxEvidence);
      candidate.weight += weight;
      candidate.shift +=
          (weight * further / look->depth) * (candidate.point - view.cameraPosition());
    } else if (further > tolerance && view.nearestRound(*look) - look->depth > tolerance) {
      candidate.evidence = std::max(candidate.evidence - 1, kMinEvidence);
      candidate.was_seen_through = true;
    }
  }

  /// Whether two scans agree and no later ones see through it; one is enough if none ever did.
  [[nodiscard]] static bool isSurface(const Candidate& candidate) {
    return candidate.evidence >= (candidate.was_seen_through ? 2 : 1);
  }

  [[nodiscard]] DenseTile points() const {
    VoxelIndex index;
    std::vector<Sum> sums;
    for (const auto& candidate : candidates_) {
      if (!isSurface(candidate)) continue;
      const Eigen::Vector3f point = candidate.point + candidate.shift / candidate.weight;
      const auto key = keys_.keyOf(point, 0);
      if (!key) continue;
      const std::uint32_t number = index.numberOf(*key);
      if (number == sums.size()) sums.emplace_back();
      sums[number].add(point, candidate.colour, candidate.weight);
    }
    DenseTile tile;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      int neighbours = 0;
      VoxelKeys::forNeighbours(
          index.keys()[i], [&](std::uint32_t key) { neighbours += index.contains(key) ? 1 : 0; });
      if (neighbours < kMinNeighbours) continue;
      tile.positions.emplace_back(sums[i].point / sums[i].weight);
      const Rgb colour = sums[i].colour / sums[i].weight;
      const auto byte = [](float value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F)));
      };
      tile.colours.push_back({byte(colour[0]), byte(colour[1]), byte(colour[2])});
    }
    return tile;
  }

  float voxel_;
  VoxelKeys keys_;
  std::vector<ScanView> views_;
  std::vector<Candidate> candidates_;
};

}  // namespace

DenseTile fuseTile(const Eigen::Vector2d& corner, double voxel_m,
                   const std::vector<PosedScan>& scans) {
  return TileFusion(corner, voxel_m, scans).run();
}

Eigen::AlignedBox3d boundsOf(const DepthScan& scan) {
  Eigen::AlignedBox3f bounds;
  ScanView(scan, Pose::Identity(), {0.0, 0.0})
      .forEachPoint([&](const Eigen::Vector3f& point, const Rgb&, float) { bounds.extend(point); });
  return bounds.cast<double>();
}

}  // namespace headway::map
