#include <headway/core/error.h>
#include <headway/map/static_grid.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "evidence_grid.h"
#include "stored_values.h"

namespace headway::map {
namespace {

constexpr double kMostCells = 25e6;
constexpr double kHeadingStep = M_PI / 12.0;  ///< between directions whose looks are kept [rad]
constexpr double kDrivenM = 5.0;              ///< farther apart, looks do not tell the way between
constexpr double kSeenM = 30.0;               ///< round a place, about [m]
constexpr double kMovedM = 0.05;              ///< a look moved less stays where it was
constexpr double kTurned = 0.003;             ///< [rad]
constexpr std::uint8_t kVersion = 1;
constexpr std::uint8_t kEnd = 0xE5;

bool moved(const Pose& from, const Pose& to) {
  return (to.translation() - from.translation()).norm() > kMovedM ||
         Eigen::AngleAxisd(from.linear().transpose() * to.linear()).angle() > kTurned;
}

}  // namespace

void StaticGridParams::describe(Params::Section section) {
  section.user().add("resolution", resolution_m, 0.05, 2.0, "m",
                     "Side of a grid cell; the planner's resolution");
  section.add("spacing_m", spacing_m, 0.1, 10.0, "m",
              "Distance between places of which a ground scan is stored");
  section.renamed({{"spacing", "spacing_m"}});
}

StaticGrid::StaticGrid(const StaticGridParams& params)
    : params_(validated(params)),
      resolution_m_(params.resolution_m),
      evidence_(std::make_unique<EvidenceGrid>(params.resolution_m)) {}

StaticGrid::~StaticGrid() = default;
StaticGrid::StaticGrid(StaticGrid&&) noexcept = default;
StaticGrid& StaticGrid::operator=(StaticGrid&&) noexcept = default;

StaticGrid::Place StaticGrid::placeOf(const Pose& T_map_robot) const {
  const auto step = [](double value, double size) {
    return static_cast<std::int32_t>(std::floor(value / size));
  };
  const Eigen::Vector3d& at = T_map_robot.translation();
  return {step(at.x(), params_.spacing_m), step(at.y(), params_.spacing_m),
          step(yawOf(T_map_robot), kHeadingStep)};
}

void StaticGrid::add(const Pose& T_map_robot, GroundScan scan) {
  const Place place = placeOf(T_map_robot);
  if (last_ && last_->place != place) before_ = last_->T_map_robot;
  last_ = Passed{place, T_map_robot};
  if (before_) {
    const Eigen::Vector3d before = T_map_robot.inverse() * before_->translation();
    if (before.norm() < kDrivenM) {
      scan.free.push_back({before.cast<float>(), Eigen::Vector3f::Zero()});
    }
  }
  Look look;
  look.T_map_robot = T_map_robot;
  look.scan = std::move(scan);
  hangOnNearest(look);
  auto& kept = looks_[place];
  if (!kept.scan.empty()) evidence_->remove(kept.scan, kept.T_map_robot);
  kept = std::move(look);
  enter(kept);
}

void StaticGrid::enter(const Look& look) {
  places_.extend(look.T_map_robot.translation().head<2>());
  const Eigen::Vector2d sides = places_.sizes().array() + 2.0 * kSeenM;
  const double before = resolution_m_;
  while (sides.prod() > kMostCells * resolution_m_ * resolution_m_) resolution_m_ *= 2.0;
  if (resolution_m_ == before) {
    evidence_->add(look.scan, look.T_map_robot);
    return;
  }
  evidence_ = std::make_unique<EvidenceGrid>(resolution_m_);
  for (const auto& [place, other] : looks_) evidence_->add(other.scan, other.T_map_robot);
}

void StaticGrid::hangOnNearest(Look& look) const {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [id, T_map_keyframe] : keyframes_) {
    const double distance =
        (T_map_keyframe.translation() - look.T_map_robot.translation()).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    look.anchor = id;
    look.T_anchor_robot = T_map_keyframe.inverse() * look.T_map_robot;
  }
}

void StaticGrid::follow(const std::vector<slam::KeyframeView>& keyframes) {
  keyframes_.clear();
  for (const auto& keyframe : keyframes) keyframes_[keyframe.id] = keyframe.T_map_robot;
  for (auto& [place, look] : looks_) {
    const auto anchor = keyframes_.find(look.anchor);
    if (anchor == keyframes_.end()) {
      hangOnNearest(look);
      continue;
    }
    const Pose T_map_robot = anchor->second * look.T_anchor_robot;
    if (!moved(look.T_map_robot, T_map_robot)) continue;
    evidence_->remove(look.scan, look.T_map_robot);
    look.T_map_robot = T_map_robot;
    enter(look);
  }
}

mrpt::maps::COccupancyGridMap2D::Ptr StaticGrid::grid() const { return evidence_->grid(); }

std::string StaticGrid::save() const {
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << kVersion << static_cast<std::uint64_t>(looks_.size());
  for (const auto& [place, look] : looks_) {
    for (const auto step : place) archive << step;
    write(archive, look.T_map_robot);
    archive << look.anchor.value;
    write(archive, look.T_anchor_robot);
    write(archive, look.scan);
  }
  archive << kEnd;
  return {static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()};
}

void StaticGrid::load(const std::string& bytes) {
  mrpt::io::CMemoryStream stream;
  stream.assignMemoryNotOwn(bytes.data(), bytes.size());
  auto archive = mrpt::serialization::archiveFrom(stream);
  StaticGrid loaded(params_);
  try {
    if (archive.ReadAs<std::uint8_t>() > kVersion) throw std::runtime_error("a newer version");
    const auto count = archive.ReadAs<std::uint64_t>();
    for (std::uint64_t i = 0; i < count; ++i) {
      Place place{};
      for (auto& step : place) archive >> step;
      Look& look = loaded.looks_[place];
      look.T_map_robot = readPose(archive);
      archive >> look.anchor.value;
      look.T_anchor_robot = readPose(archive);
      look.scan = readGroundScan(archive);
      if (!look.T_map_robot.matrix().allFinite()) throw std::runtime_error("no pose");
      loaded.enter(look);
    }
    if (archive.ReadAs<std::uint8_t>() != kEnd) throw std::runtime_error("no end");
  } catch (const std::exception&) {
    throw InputError("its looks over the ground are damaged or of a newer version");
  }
  *this = std::move(loaded);
}

}  // namespace headway::map
