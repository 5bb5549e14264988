// SPDX-License-Identifier: BSD-3-Clause
#include "dense_truth.h"

#include <headway/core/error.h>
#include <headway/io/calibration_file.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>
#include <headway/stereo/frame_context.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <set>
#include <utility>

#include "truth_images.h"

namespace headway::eval_files {
namespace {

namespace fs = std::filesystem;

constexpr double kSigmas = 3.0;        // of a disparity that agrees with the true depth
constexpr double kSameBox_m = 0.05;    // an object that moved less fills the same space ...
constexpr double kSameBox_rad = 0.02;  // ... as does one that turned less

/// Pixels at which a disparity agrees with the true depth.
cv::Mat matchedPixels(const stereo::DisparityImage& disparity, const cv::Mat& depth_m,
                      const stereo::RigCapability& rig) {
  cv::Mat matched(depth_m.size(), CV_8U, cv::Scalar(0));
  for (int v = 0; v < depth_m.rows; ++v) {
    for (int u = 0; u < depth_m.cols; ++u) {
      const auto z = static_cast<double>(depth_m.at<float>(v, u));
      const auto d = static_cast<double>(disparity.at(u, v));
      if (!(z > 0.0 && d > 0.0)) continue;
      const bool agrees = std::abs(d - rig.focal_baseline / z) <= kSigmas * rig.sigma_disparity_px;
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

bool isSame(const eval::ObjectBox& a, const eval::ObjectBox& b) {
  return (a.centre - b.centre).norm() < kSameBox_m && std::abs(a.yaw - b.yaw) < kSameBox_rad;
}

/// Boxes of all objects in all frames, without those of objects that stayed where they were.
std::vector<eval::ObjectBox> objectBoxes(const std::string& path) {
  const auto samples = io::readTrackCsv(path);
  std::set<TrackId> moving;
  for (const auto& sample : samples) {
    if (isMoving(sample.track)) moving.insert(sample.track.id);
  }
  std::vector<eval::ObjectBox> boxes;
  std::map<TrackId, eval::ObjectBox> last;
  for (const auto& sample : samples) {
    const Track& track = sample.track;
    const eval::ObjectBox box{track.position, track.size, track.yaw, moving.count(track.id) > 0};
    const auto before = last.find(track.id);
    if (before != last.end() && isSame(before->second, box)) continue;
    last[track.id] = box;
    boxes.push_back(box);
  }
  return boxes;
}

}  // namespace

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

DenseTruth denseTruth(const fs::path& folder, const std::string& rawlog, const DenseClaim& claim) {
  DenseTruth truth;
  truth.objects = objectBoxes((folder / "objects.csv").string());
  const auto poses = io::readTum((folder / "trajectory.tum").string());
  MatchedPairs pairs(rawlog);
  eval::TrueSurface surface(claim.camera, claim.rig.dense_voxel_m, claim.rig.nearest_m,
                            claim.rig.dense_to_m);
  for (std::size_t frame = 0; frame < poses.size(); ++frame) {
    eval::TrueDepths depths;
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

}  // namespace headway::eval_files
