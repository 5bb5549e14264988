// SPDX-License-Identifier: BSD-3-Clause
// The dense coloured map: which depth scans are stored, and which tiles are fused anew.
#include <headway/core/error.h>
#include <headway/map/dense_map.h>
#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "dense_fusion.h"
#include "scan_view.h"
#include "stored_values.h"

namespace headway::map {
namespace {

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
