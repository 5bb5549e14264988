// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of the dense map of a replay's folder.
#include <headway/core/error.h>
#include <headway/core/stereo_camera.h>
#include <headway/eval/dense_error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/map/map_file.h>
#include <headway/report/map_files.h>
#include <headway/stereo/disparity.h>
#include <headway/stereo/frame_context.h>
#include <headway/stereo/rig_capability.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "evaluation_inputs.h"

namespace headway::eval {
namespace {

/// What a dense map is compared with.
struct DenseTruth {
  std::vector<TrueSurface::Patch> patches;
  std::vector<ObjectBox> objects;
  double path_m = 0.0;  ///< length of the robot's path
};

/// How a replay made its dense map.
struct DenseClaim {
  StereoCamera camera;
  stereo::RigCapability rig;  ///< with what was configured
  stereo::DisparityParams disparity;
};

namespace fs = std::filesystem;

/// Pixels at which a disparity agrees with the true depth within three standard deviations.
cv::Mat matchedPixels(const stereo::DisparityImage& disparity, const cv::Mat& depth_m,
                      const stereo::RigCapability& rig) {
  cv::Mat matched(depth_m.size(), CV_8U, cv::Scalar(0));
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const auto z = static_cast<double>(depth_m.at<float>(v, u));
      const auto d = static_cast<double>(disparity.at(u, v));
      if (!(z > 0.0 && d > 0.0)) continue;
      const bool agrees = std::abs(d - rig.focal_baseline / z) <= 3.0 * rig.sigma_disparity_px;
      matched.at<std::uint8_t>(v, u) = agrees ? 255 : 0;
    }
  }
  return matched;
}

/// The pairs of a rawlog, frame by frame, matched densely.
class MatchedPairs {
 public:
  explicit MatchedPairs(const std::string& rawlog) : path_(rawlog) {
    if (!rawlog.empty()) source_.emplace(rawlog, io::RawlogSourceOptions{});
  }

  /// Of the next frame; empty without a rawlog.
  [[nodiscard]] cv::Mat next(const cv::Mat& depth_m, const DenseClaim& claim) {
    if (!source_) return {};
    const auto frame = source_->next();
    if (!frame || !frame->stereo) {
      throw InputError(path_ + ": has fewer frames than the truth; is it the truth's rawlog?");
    }
    const stereo::FrameContext context(*frame->stereo, claim.disparity, 0.0, ground_);
    cv::Mat matched = matchedPixels(context.disparity(), depth_m, claim.rig);
    if (const auto match_ground = context.groundMatching(claim.rig.dense_to_m)) {
      cv::bitwise_or(matched, matchedPixels(match_ground(), depth_m, claim.rig), matched);
    }
    ground_ = context.lastGround();
    return matched;
  }

 private:
  std::string path_;
  std::optional<io::RawlogSource> source_;
  std::optional<stereo::GroundPlane> ground_;  ///< of the frame before
};

/// Whether an object that moved or turned so little fills the same space.
bool isSame(const ObjectBox& a, const ObjectBox& b) {
  return (a.centre - b.centre).norm() < 0.05 && std::abs(a.yaw - b.yaw) < 0.02;
}

/// Boxes of all objects in all frames, without those of objects that stayed where they were.
std::vector<ObjectBox> objectBoxes(const std::string& path) {
  const auto samples = io::readTrackCsv(path);
  std::set<TrackId> moving;
  for (const auto& sample : samples) {
    if (isMoving(sample.track)) moving.insert(sample.track.id);
  }
  std::vector<ObjectBox> boxes;
  std::map<TrackId, ObjectBox> last;
  for (const auto& sample : samples) {
    const Track& track = sample.track;
    const ObjectBox box{track.position, track.size, track.yaw, moving.count(track.id) > 0};
    const auto before = last.find(track.id);
    if (before != last.end() && isSame(before->second, box)) continue;
    last[track.id] = box;
    boxes.push_back(box);
  }
  return boxes;
}

/// Reads calibration.yaml and replay.json of a replay's folder.
///
/// @throws InputError if one is missing or damaged
DenseClaim denseClaim(const fs::path& replay) {
  DenseClaim claim;
  claim.camera = io::readCalibration((replay / "calibration.yaml").string());
  stereo::RigAssumptions configured;
  const fs::path path = replay / "replay.json";
  std::ifstream file(path);
  if (!file) {
    throw InputError(path.string() + ": no such file; is this the output folder of a replay?");
  }
  try {
    const auto configuration = nlohmann::json::parse(file).at("configuration");
    Params params;
    claim.disparity.describe(params.section("disparity"));
    for (const auto& [key, value] : configuration.at("disparity").items()) {
      params.set("disparity." + key + "=" + value.get<std::string>());
    }
    const auto& dense = configuration.at("dense");
    configured.dense_to_m = std::stod(dense.at("reach_m").get<std::string>());
    configured.dense_voxel_m = std::stod(dense.at("voxel_m").get<std::string>());
    configured.nearest_m = claim.disparity.nearest_m;
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": is not the record of a replay: " + error.what());
  }
  claim.rig = stereo::rigCapability(claim.camera, configured);
  return claim;
}

/// The true static surface and the true objects of a simulated rawlog.
///
/// @param folder  NAME.truth with depth/, masks/, trajectory.tum and objects.csv
/// @param rawlog  of that truth, to match its pairs as the replay did; empty: not matched
/// @throws InputError if a file is missing or its size differs from the camera's
DenseTruth denseTruth(const fs::path& folder, const std::string& rawlog, const DenseClaim& claim) {
  DenseTruth truth;
  truth.objects = objectBoxes((folder / "objects.csv").string());
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  MatchedPairs pairs(rawlog);
  TrueSurface surface(claim.camera, claim.rig.dense_voxel_m, claim.rig.nearest_m,
                      claim.rig.dense_to_m);
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    TrueDepths depths;
    depths.depth_m = readTrueDepth(folder, frame, claim.camera);
    depths.moving = readMovingMask(folder, frame, claim.camera);
    depths.matched = pairs.next(depths.depth_m, claim);
    surface.add(depths, poses[frame].value);
    if (frame == 0) continue;
    truth.path_m +=
        (poses[frame].value.translation() - poses[frame - 1].value.translation()).norm();
  }
  truth.patches = surface.patches();
  return truth;
}

using Json = nlohmann::ordered_json;

std::vector<Eigen::Vector3d> pointsOf(const fs::path& path) {
  if (!fs::exists(path)) {
    throw InputError(path.string() + ": no such file; has the replay a dense map (dense.use)?");
  }
  std::vector<Eigen::Vector3d> points;
  for (const auto& point : report::readPoints(path, 0)) {
    points.push_back(point.position.cast<double>());
  }
  return points;
}

double megabytes(std::size_t bytes) { return static_cast<double>(bytes) / 1e6; }

DenseSizes sizesOf(const fs::path& replay, double path_m) {
  DenseSizes sizes;
  sizes.points_mb = megabytes(fs::file_size(replay / "map_dense.ply"));
  const auto stored = map::loadMap((replay / "map.headway").string());
  const auto scans = stored.attachments.find(map::kDenseAttachment);
  if (scans != stored.attachments.end()) {
    sizes.scans_mb = megabytes(scans->second.size());
  }
  sizes.path_km = path_m / 1000.0;
  return sizes;
}

Json coverageJson(const Coverage& coverage, bool matched) {
  Json json = {{"surface", coverage.surface},
               {"covered", coverage.covered},
               {"ratio", orNull(coverage.ratio())},
               {"ratio_within_bar", orNull(coverage.ratioWithinBar())}};
  if (!matched) return json;
  json["matchable"] = coverage.matchable;
  json["matchable_ratio"] = orNull(coverage.matchableRatio());
  json["matchable_covered_ratio"] = orNull(coverage.matchableCovered());
  return json;
}

}  // namespace

std::optional<double> DenseSizes::perKilometre() const {
  if (!(path_km > 0.0)) return std::nullopt;
  return (points_mb + scans_mb) / path_km;
}

std::array<double, 2> DenseEvaluation::rangeLimits(std::size_t range) const {
  const double width = reach_m / static_cast<double>(DenseError::kRanges);
  return {width * static_cast<double>(range), width * static_cast<double>(range + 1)};
}

DenseEvaluation evaluateDense(const fs::path& truth, const fs::path& replay,
                              const std::string& rawlog) {
  DenseEvaluation result;
  result.points = pointsOf(replay / "map_dense.ply");
  const auto claim = denseClaim(replay);
  auto surface = denseTruth(truth, rawlog, claim);
  result.voxel_m = claim.rig.dense_voxel_m;
  result.reach_m = claim.rig.dense_to_m;
  result.is_matched = !rawlog.empty();
  const double sigma = claim.rig.sigma_disparity_px / claim.rig.focal_baseline;
  result.error = denseError(surface.patches, result.voxel_m, result.reach_m, sigma, result.points,
                            surface.objects);
  result.sizes = sizesOf(replay, surface.path_m);
  result.patches = std::move(surface.patches);
  return result;
}

Json toJson(const DenseEvaluation& evaluation) {
  const auto& error = evaluation.error;
  const auto& sizes = evaluation.sizes;
  Json by_range = Json::array();
  for (std::size_t i = 0; i < error.by_range.size(); ++i) {
    Json range = coverageJson(error.by_range[i], evaluation.is_matched);
    range["nearest_m"] = evaluation.rangeLimits(i);
    by_range.push_back(std::move(range));
  }
  return {{"voxel_m", evaluation.voxel_m},
          {"reach_m", evaluation.reach_m},
          {"points", error.points},
          {"compared", error.compared},
          {"median_m", error.median_m},
          {"median_bar_m", error.median_bar_m},
          {"within_bar_ratio", orNull(error.withinBarRatio())},
          {"astray", error.astray},
          {"of_movers", error.of_movers},
          {"mover_ratio", orNull(error.moverRatio())},
          {"on_still_objects", error.on_still_objects},
          {"coverage", coverageJson(error.coverage, evaluation.is_matched)},
          {"by_range", std::move(by_range)},
          {"path_km", sizes.path_km},
          {"points_mb", sizes.points_mb},
          {"scans_mb", sizes.scans_mb},
          {"mb_per_km", orNull(sizes.perKilometre())}};
}

}  // namespace headway::eval
