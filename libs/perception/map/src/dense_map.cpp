// SPDX-License-Identifier: BSD-3-Clause
// The dense coloured map: which depth scans are stored, and the fusion of those of a tile to at
// most one point a voxel.
#include <headway/core/error.h>
#include <headway/core/scan.h>
#include <headway/map/dense_map.h>
#include <mrpt/core/exceptions.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "scan_view.h"
#include "stored_values.h"

namespace headway::map {

/// Points of the dense map in one square of the map.
struct DenseTile {
  std::vector<Eigen::Vector3f> positions;            ///< from the corner of the tile [m]
  std::vector<std::array<std::uint8_t, 3>> colours;  ///< red, green, blue
};

namespace {

/// Voxels along the side of a tile.
constexpr int kTileVoxels = 256;

/// A depth scan and the pose of its robot, in order of time.
struct PosedScan {
  std::shared_ptr<const DepthScan> scan;
  Pose T_map_robot = Pose::Identity();
};

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

/// Fuses the scans of one tile, see DenseMap.
///
/// @param corner  of the tile with the least x and y, z of the map [m]
/// @param scans   that reach into the tile, in order of time
DenseTile fuseTile(const Eigen::Vector2d& corner, double voxel_m,
                   const std::vector<PosedScan>& scans) {
  return TileFusion(corner, voxel_m, scans).run();
}

/// Bounds of a scan's points in the robot frame [m]; empty without points.
Eigen::AlignedBox3d boundsOf(const DepthScan& scan) {
  Eigen::AlignedBox3f bounds;
  ScanView(scan, Pose::Identity(), {0.0, 0.0})
      .forEachPoint([&](const Eigen::Vector3f& point, const Rgb&, float) { bounds.extend(point); });
  return bounds.cast<double>();
}

using mrpt::maps::CColouredPointsMap;

constexpr std::uint8_t kDenseVersion = 2;   // 1 is without times
constexpr double kDenseMovedVoxels = 0.25;  ///< a scan moved less stays where it was
constexpr double kDenseTurned = 0.002;      ///< [rad]
constexpr double kMinVoxelM = 0.005;  // a smaller one of a file would take any amount of memory
constexpr double kMaxTiles = 1e4;     ///< that one scan may reach into: more is damage

struct TileWork {
  DenseMap::Tiles::key_type index;
  std::vector<PosedScan> scans;
};

double tileSide(double voxel_m) { return kTileVoxels * voxel_m; }

Eigen::Vector2d cornerOf(const DenseMap::Tiles::key_type& index, double voxel_m) {
  return tileSide(voxel_m) * Eigen::Vector2d(index[0], index[1]);
}

CColouredPointsMap::Ptr collect(const DenseMap::Tiles& tiles, double voxel_m) {
  std::size_t total = 0;
  for (const auto& [index, tile] : tiles) total += tile->positions.size();
  auto layer = CColouredPointsMap::Create();
  layer->reserve(total);
  for (const auto& [index, tile] : tiles) {
    const Eigen::Vector2d corner = cornerOf(index, voxel_m);
    for (std::size_t i = 0; i < tile->positions.size(); ++i) {
      const Eigen::Vector3d p =
          tile->positions[i].cast<double>() + Eigen::Vector3d(corner.x(), corner.y(), 0.0);
      const auto& colour = tile->colours[i];
      const auto unit = [&](std::size_t channel) {
        return static_cast<float>(colour[channel]) / 255.0F;
      };
      layer->insertPointRGB(static_cast<float>(p.x()), static_cast<float>(p.y()),
                            static_cast<float>(p.z()), unit(0), unit(1), unit(2));
    }
  }
  // MRPT computes these lazily: done here, because two readers must not do it concurrently.
  static_cast<void>(layer->boundingBox());
  static_cast<void>(layer->getLargestDistanceFromOrigin());
  return layer;
}

DenseMap::Fused fuse(DenseMap::Tiles tiles, const std::vector<TileWork>& work, double voxel_m) {
  for (const auto& [index, scans] : work) {
    auto tile = fuseTile(cornerOf(index, voxel_m), voxel_m, scans);
    if (tile.positions.empty()) {
      tiles.erase(index);
    } else {
      tiles[index] = std::make_shared<const DenseTile>(std::move(tile));
    }
  }
  return {tiles, collect(tiles, voxel_m)};
}

}  // namespace

void DenseMapParams::describe(Params::Section section) {
  section.add("use", use, "Dense coloured map of the static world by stereo depth");
  section.add(
      "voxel_m", voxel_m, 0.0, 2.0, "m",
      "Side of the dense map's voxels, which contain a point each; 0: derived from the rig, "
      "0.1 m for a car's, 0.05 m for a robot's");
  section.add("reach_m", reach_m, 0.0, 100.0, "m",
              "Maximum depth of the surfaces that enter the dense map; 0: derived from the rig");
  section.add("spacing_m", spacing_m, 0.0, 10.0, "m",
              "Distance between places of which a depth scan is stored; 0: derived from the rig");
}

DenseMap::DenseMap(const DenseMapParams& params) : params_(validated(params)) {}

AnchoredPose DenseMap::anchored(const Pose& T_map_robot) const {
  AnchoredPose pose;
  pose.T_map_robot = T_map_robot;
  keyframes_.attach(pose);
  return pose;
}

void DenseMap::add(AnchoredPose pose, const Pose& T_odom_robot, DepthScan scan) {
  ASSERTMSG_(params_.voxel_m > 0.0 && params_.spacing_m > 0.0, "a dense map needs a voxel size");
  if (scan.empty()) return;
  if (const auto moved = keyframes_.movedPose(pose, 0.0, 0.0)) pose.T_map_robot = *moved;
  replace(pose, T_odom_robot, std::make_shared<const DepthScan>(std::move(scan)));
}

void DenseMap::add(const DenseMap& other, std::int64_t keyframe_shift) {
  for (const auto* stored : other.inOrder()) {
    AnchoredPose pose = stored->pose;
    if (pose.anchor.valid()) pose.anchor.value += keyframe_shift;
    replace(pose, std::nullopt, stored->scan);
  }
}

void DenseMap::crop(const Eigen::AlignedBox3d& box) {
  DenseMap inside(params_);
  inside.keyframes_ = keyframes_;
  inside.next_order_ = next_order_;
  for (const auto& [place, stored] : scans_) {
    if (!box.contains(stored.pose.T_map_robot.translation())) continue;
    auto scan = cropped(*stored.scan, stored.pose.T_map_robot, box);
    if (scan.empty()) continue;
    StoredScan& kept = inside.scans_[place] = stored;
    kept.bounds = boundsOf(scan);
    kept.scan = std::make_shared<const DepthScan>(std::move(scan));
    inside.markOutdated(kept);
  }
  *this = std::move(inside);
}

void DenseMap::leaveOut(const std::vector<Track>& tracks, Time since) {
  std::vector<ScanPlace> emptied;
  for (auto& [place, stored] : scans_) {
    const Time time = stored.scan->time;
    if (!(time >= since) || !stored.T_odom_robot) continue;
    std::vector<UprightBox> boxes;
    for (const auto& track : tracks) {
      if (!isMoving(track)) continue;
      if (const auto box = pastBox(track, time)) boxes.push_back(*box);
    }
    auto rest = without(*stored.scan, *stored.T_odom_robot, boxes);
    if (!rest) continue;
    markOutdated(stored);
    if (rest->empty()) emptied.push_back(place);
    stored.bounds = boundsOf(*rest);
    stored.scan = std::make_shared<const DepthScan>(std::move(*rest));
  }
  for (const auto& place : emptied) scans_.erase(place);
}

/// Stores a scan in place of the one from the same place and direction.
void DenseMap::replace(const AnchoredPose& pose, const std::optional<Pose>& T_odom_robot,
                       std::shared_ptr<const DepthScan> scan) {
  StoredScan& stored = scans_[scanPlace(pose.T_map_robot, params_.spacing_m)];
  if (stored.scan != nullptr) markOutdated(stored);
  stored.pose = pose;
  stored.T_odom_robot = T_odom_robot;
  stored.order = next_order_++;
  stored.bounds = boundsOf(*scan);
  stored.scan = std::move(scan);
  markOutdated(stored);
}

std::vector<const DenseMap::StoredScan*> DenseMap::inOrder() const {
  std::vector<const StoredScan*> scans;
  for (const auto& [place, stored] : scans_) scans.push_back(&stored);
  std::sort(scans.begin(), scans.end(),
            [](const auto* a, const auto* b) { return a->order < b->order; });
  return scans;
}

std::set<DenseMap::TileIndex> DenseMap::tilesOf(const StoredScan& stored) const {
  Eigen::AlignedBox2d covered;
  for (int i = 0; i < 8; ++i) {
    const auto corner = stored.bounds.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i));
    covered.extend(Eigen::Vector2d((stored.pose.T_map_robot * corner).head<2>()));
  }
  const double side = tileSide(params_.voxel_m);
  const double farthest = covered.min().cwiseAbs().cwiseMax(covered.max().cwiseAbs()).maxCoeff();
  if (!(farthest < kMaxTiles * kMaxTiles * side)) return {};  // beyond 32-bit numbers of tiles
  if (!((covered.sizes().array() / side + 2.0).prod() <= kMaxTiles)) return {};
  const auto step = [&](double metres) {
    return static_cast<std::int32_t>(std::floor(metres / side));
  };
  std::set<TileIndex> tiles;
  for (auto x = step(covered.min().x()); x <= step(covered.max().x()); ++x) {
    for (auto y = step(covered.min().y()); y <= step(covered.max().y()); ++y) tiles.insert({x, y});
  }
  return tiles;
}

void DenseMap::markOutdated(const StoredScan& stored) { outdated_.merge(tilesOf(stored)); }

void DenseMap::follow(const SharedChunks<slam::KeyframeView>& keyframes) {
  keyframes_.update(keyframes);
  for (auto& [place, stored] : scans_) {
    const auto moved =
        keyframes_.movedPose(stored.pose, kDenseMovedVoxels * params_.voxel_m, kDenseTurned);
    if (!moved) continue;
    markOutdated(stored);
    stored.pose.T_map_robot = *moved;
    markOutdated(stored);
  }
}

std::function<DenseMap::Fused()> DenseMap::fusion() {
  std::map<TileIndex, TileWork> work;
  for (const auto& index : outdated_) work[index].index = index;
  for (const auto* stored : inOrder()) {
    for (const auto& index : tilesOf(*stored)) {
      const auto tile = work.find(index);
      if (tile == work.end()) continue;
      tile->second.scans.push_back({stored->scan, stored->pose.T_map_robot});
    }
  }
  std::vector<TileWork> list;
  for (auto& [index, tile] : work) list.push_back(std::move(tile));
  outdated_.clear();
  return [tiles = tiles_, list = std::move(list), voxel_m = params_.voxel_m] {
    return fuse(tiles, list, voxel_m);
  };
}

void DenseMap::apply(Fused fused) { tiles_ = std::move(fused.tiles); }

CColouredPointsMap::Ptr DenseMap::layer() {
  if (scans_.empty()) return nullptr;
  Fused fused = fusion()();
  const auto layer = fused.layer;
  apply(std::move(fused));
  return layer;
}

ByteSource DenseMap::save() const {
  const auto scans = std::make_shared<const std::map<ScanPlace, StoredScan>>(scans_);
  return [scans, voxel_m = params_.voxel_m](const ByteSink& sink) {
    ByteWriter head;
    head.value(kDenseVersion);
    head.value(voxel_m);
    head.count(scans->size());
    sink(head.bytes);
    for (const auto& [place, stored] : *scans) {
      ByteWriter out;
      out.values(place);
      out.value(stored.order);
      out.value(stored.scan->time);
      write(out, stored.pose);
      write(out, *stored.scan);
      sink(out.bytes);
    }
  };
}

void DenseMap::load(const std::string& bytes) {
  try {
    *this = loaded(bytes);
  } catch (const InputError& error) {
    throw InputError(std::string("its depth scans cannot be read: ") + error.what());
  }
}

DenseMap DenseMap::loaded(const std::string& bytes) const {
  ByteReader in(bytes);
  const auto version = in.value<std::uint8_t>();
  if (version != kDenseVersion && version != 1) {
    throw InputError("they are of another version");
  }
  const auto stored_voxel_m = in.finiteValue<double>();
  DenseMap loaded(params_);
  if (loaded.params_.voxel_m <= 0.0) loaded.params_.voxel_m = stored_voxel_m;
  const auto count = in.value<std::uint64_t>();
  if (count > 0 && !(loaded.params_.voxel_m >= kMinVoxelM)) {
    throw InputError("damaged: they have no voxel size");
  }
  for (std::uint64_t i = 0; i < count; ++i) {
    ScanPlace place{};
    in.values(place);
    StoredScan& stored = loaded.scans_[place];
    stored.order = in.value<std::uint64_t>();
    const Time time = version == kDenseVersion ? in.value<Time>() : DepthScan().time;
    stored.pose = readAnchoredPose(in);
    auto scan = readDepthScan(in);
    scan.time = time;
    stored.bounds = boundsOf(scan);
    stored.scan = std::make_shared<const DepthScan>(std::move(scan));
    loaded.next_order_ = std::max(loaded.next_order_, stored.order + 1);
    loaded.markOutdated(stored);
  }
  if (!in.atEnd()) throw InputError("damaged: there are data after their end");
  return loaded;
}

CColouredPointsMap::Ptr denseLayer(const std::string& bytes) {
  DenseMap map({});
  map.load(bytes);
  return map.layer();
}

}  // namespace headway::map
