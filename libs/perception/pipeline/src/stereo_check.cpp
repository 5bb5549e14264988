// SPDX-License-Identifier: BSD-3-Clause
// Comparison of left with right images: rows, times, order, and the right camera's rotation.
#include "stereo_check.h"

#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/stereo/point_tracking.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

namespace headway::pipeline {
namespace {

/// When pairs are compared.
struct ComparisonTimes {
  double interval_s = 0.4;
  double suspected_s = 0.09;  ///< where images of different times are suspected
  int first = 5;              ///< frames: all of them are compared, and may refuse the camera,
  int min_refusing = 3;       ///< so many at least
};
constexpr ComparisonTimes kTimes;

constexpr double kMarginOfMap = 3.0;         ///< sigmas: a map is changed by what is sure alone
constexpr double kIndependentOffset = 0.25;  ///< ratio of information: the same points recur

/// The search for corners of the left image in the right one, in reduced images.
struct CornerSearch {
  int max_width = 480;  ///< of images that are not reduced to a half [px]
  int corners = 80;
  int many_corners = 400;    ///< where few match, and of the first frames
  double places = 3.0;       ///< for each corner
  double min_spacing = 8.0;  ///< of corners [px]
  double max_spacing = 20.0;
  int radius = 5;                ///< of patches [px]
  int min_rows = 6;              ///< searched above and below [px]
  double turn_rad = 0.023;       ///< and so many by the camera's rotation: 1.3 deg
  double wide_turn_rad = 0.045;  ///< where few match: 2.6 deg
  int negative_px = 16;          ///< searched disparities below 0
  double max_disparity = 0.15;   ///< ratio of the width
  double min_correlation = 0.9;
  double min_margin = 0.05;  ///< of the correlation to the next best place
};

/// What is wrong with a pair, by its matches in the images as they are.
struct PairLimits {
  double max_refined_px = 2.0;  ///< change of a match by refinement
  std::size_t min_matches = 20;
  double max_offset_px = 1.5;    ///< median difference of rows
  double max_scatter_px = 0.9;   ///< median deviation from it
  double swapped_px = -2.0;      ///< median disparity
  std::size_t min_swapped = 12;  ///< matches, of which
  double swapped_ratio = 0.8;    ///< so many have no point before the cameras
  double min_agreement = 0.7;    ///< ratio of points that agree on an offset
  // Rows that differ as the left image moves:
  double min_flow_px = 0.15;     ///< RMS motion that tells something: the noise of rows,
  double max_flow_px = 0.3;      ///< in wide images, with the errors of a calibration, twice it
  double flow_per_width = 6e-4;  ///< between both
  double rows_px = 0.1;          ///< noise of rows, at least
  double min_moving = 8.0;       ///< corners
  double max_deviations = 5.0;   ///< median ones: motion of points that count
  double most = 0.35 * Evidence::kDecisive;  ///< that a comparison says: three decide
  double rest = -1.0;                        ///< what it says without motion: images at rest agree
};

/// When a scene is too near to be matched.
struct RangeLimits {
  double interval_s = 0.5;  ///< of comparisons
  double seconds = 2.0;     ///< in which the scene is too near: longer than somebody passes by
  double ratio = 0.1;       ///< of the image
  int width = 160;          ///< to which images are reduced about [px]: 1 ms
  double nearest_m = 1e-3;  ///< searched as far as images of that width can be matched
  int uniqueness_percent = 15;
};
constexpr RangeLimits kRange;

constexpr CornerSearch kSearch;
constexpr PairLimits kLimits;
constexpr stereo::PointTrackingOptions kRefinement{11, 0, 18.0, 0.0};
constexpr stereo::PointTrackingOptions kFlow{11, 3, 18.0, 0.7};

/// Offset of the vertex of a parabola through three samples from the middle one.
double vertex(float before, float middle, float after) {
  const double curvature = 2.0 * middle - before - after;
  return curvature <= 0.0 ? 0.0 : std::clamp(0.5 * (after - before) / curvature, -0.5, 0.5);
}

/// Left and right image, wide ones at half the resolution.
struct ReducedPair {
  cv::Mat left, right;
  int reduction = 1;
  int rows = kSearch.min_rows;  ///< searched above and below [px]

  /// @param searched_turn  of the right camera [rad]
  ReducedPair(const StereoFrame& frame, double searched_turn) {
    reduction = frame.left.cols > kSearch.max_width ? 2 : 1;
    const double scale = 1.0 / reduction;
    cv::resize(frame.left, left, {}, scale, scale, cv::INTER_AREA);
    cv::resize(frame.right, right, {}, scale, scale, cv::INTER_AREA);
    if (frame.camera == nullptr) return;
    const double by_turn = std::ceil(searched_turn * frame.camera->fy * scale);
    rows = std::max(kSearch.min_rows, static_cast<int>(by_turn) + 1);
  }
};

}  // namespace

void StereoCheck::assume(const Eigen::Vector3d& turn) {
  turn_ = known_ = turn;
  margin_sigmas_ = kMarginOfMap;
}

namespace {

/// Disparity and rows [px] of the distinct place of a corner of the left image in the right one;
/// nullopt if there is none.
std::optional<Eigen::Vector2d> match(const ReducedPair& pair, const cv::Point& corner) {
  const auto& [left, right, reduction, rows] = pair;
  const int max_disparity = static_cast<int>(kSearch.max_disparity * left.cols);
  const int side = 2 * kSearch.radius + 1;
  const cv::Rect patch(corner.x - kSearch.radius, corner.y - kSearch.radius, side, side);
  const cv::Rect wanted(patch.x - max_disparity, patch.y - rows,
                        side + max_disparity + kSearch.negative_px, side + 2 * rows);
  const cv::Rect band = wanted & cv::Rect(0, 0, right.cols, right.rows);
  if (band.height < wanted.height || band.width < 4 * side) return std::nullopt;
  cv::Mat scores;
  cv::matchTemplate(right(band), left(patch), scores, cv::TM_CCOEFF_NORMED);
  double best = 0.0;
  cv::Point at;
  cv::minMaxLoc(scores, nullptr, &best, nullptr, &at);
  const bool is_inside = at.x > 0 && at.y > 0 && at.x + 1 < scores.cols && at.y + 1 < scores.rows;
  if (best < kSearch.min_correlation || !is_inside) return std::nullopt;
  const auto score = [&](int du, int dv) { return scores.at<float>(at.y + dv, at.x + du); };
  const Eigen::Vector2d found(
      patch.x - (band.x + at.x + vertex(score(-1, 0), score(0, 0), score(1, 0))),
      band.y + at.y + vertex(score(0, -1), score(0, 0), score(0, 1)) - patch.y);
  cv::rectangle(scores, cv::Rect(at.x - 2, at.y - 2, 5, 5) & cv::Rect({0, 0}, scores.size()), 0.0,
                cv::FILLED);
  double next = 0.0;
  cv::minMaxLoc(scores, nullptr, &next);
  if (best - next <= kSearch.min_margin) return std::nullopt;
  return reduction * found;
}

}  // namespace

/// Measures matches in the images as they are: the vertex of the correlation is biased towards
/// whole pixels of the reduced ones, so that a roll of 0.1 degrees was found as 0.075.
void StereoCheck::refine(const StereoFrame& frame, std::vector<Match>& matches) {
  std::vector<Eigen::Vector2d> left, right;
  for (const Match& one : matches) {
    left.push_back(one.row.right + Eigen::Vector2d(one.disparity, -one.row.rows));
    right.push_back(one.row.right);
  }
  const auto found =
      stereo::trackPoints(stereo::buildPyramid(frame.left, 1, stereo::Gradients::kAll),
                          stereo::buildPyramid(frame.right, 1), left, right, kRefinement);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    if (!found[i] || (*found[i] - right[i]).norm() > kLimits.max_refined_px) continue;
    matches[i].disparity = left[i].x() - found[i]->x();
    matches[i].row = {*found[i], found[i]->y() - left[i].y()};
  }
}

std::vector<StereoCheck::Match> StereoCheck::matchesOf(const StereoFrame& frame, int max_corners,
                                                       double searched_turn) {
  const ReducedPair pair(frame, searched_turn);
  std::vector<cv::Point2f> corners;
  const double spacing =
      std::sqrt(static_cast<double>(pair.left.total()) / (kSearch.places * max_corners));
  cv::goodFeaturesToTrack(pair.left, corners, max_corners, 0.02,
                          std::clamp(spacing, kSearch.min_spacing, kSearch.max_spacing));
  std::vector<Match> matches;
  const cv::Rect inside(kSearch.radius, kSearch.radius, pair.left.cols - 2 * kSearch.radius,
                        pair.left.rows - 2 * kSearch.radius);
  for (const cv::Point corner : corners) {
    const auto found = inside.contains(corner) ? match(pair, corner) : std::nullopt;
    if (!found) continue;
    Match& one = matches.emplace_back();
    one.disparity = found->x();
    one.row.rows = found->y();
    one.row.right = {pair.reduction * corner.x - found->x(),
                     pair.reduction * corner.y + found->y()};
  }
  refine(frame, matches);
  return matches;
}

namespace {

/// @param corrected  said after it
Finding offsetFinding(const StereoFrame& frame, double rows_px, const char* corrected) {
  return {"vertical_offset", frame.index,
          formatted("the rows of left and right images differ by %.1f px; a camera has moved in "
                    "its mounting: calibrate the cameras%s",
                    rows_px, corrected)};
}

std::optional<Finding> turnFinding(const stereo::RectificationError& error,
                                   const StereoCamera& camera, std::size_t frame) {
  const auto excess = stereo::excessiveTurn(error, camera);
  if (!excess) return std::nullopt;
  return Finding{"right_camera_turned", frame, "stereo calibration: " + *excess, Severity::kFatal};
}

}  // namespace

/// What is wrong with the pair, apart from turn_.
StereoCheck::Condition StereoCheck::compare(const std::vector<Match>& matches,
                                            const StereoCamera* camera, double& rows_px) const {
  const auto is_swapped = [](const Match& one) { return one.disparity < kLimits.swapped_px; };
  const auto swapped = std::count_if(matches.begin(), matches.end(), is_swapped);
  if (matches.size() >= kLimits.min_swapped &&
      static_cast<double>(swapped) > kLimits.swapped_ratio * static_cast<double>(matches.size())) {
    return Condition::kSwapped;
  }
  if (matches.size() < kLimits.min_matches) return Condition::kNone;
  std::vector<double> disparities, rows, deviations;
  for (const auto& one : matches) {
    disparities.push_back(one.disparity);
    const double by_turn =
        camera == nullptr ? 0.0 : stereo::rowShift(one.row.right, turn_, *camera);
    rows.push_back(one.row.rows - by_turn);
  }
  const double offset = median(rows);
  for (const double row : rows) deviations.push_back(std::abs(row - offset));
  const double scatter = median(deviations);
  if (median(disparities) < kLimits.swapped_px) return Condition::kSwapped;
  rows_px = std::max(std::abs(offset), scatter);
  if (scatter > kLimits.max_scatter_px) return Condition::kScattered;
  const auto agrees = [&](double deviation) { return deviation < 0.5 * std::abs(offset); };
  const auto agreeing = std::count_if(deviations.begin(), deviations.end(), agrees);
  const bool is_common =
      static_cast<double>(agreeing) > kLimits.min_agreement * static_cast<double>(rows.size());
  return std::abs(offset) > kLimits.max_offset_px && is_common ? Condition::kOffset
                                                               : Condition::kNone;
}

/// Takes what matches say of a right image that was taken with another left one: rows that differ
/// as the points do between both left images leave less unexplained than rows that agree. Less than
/// half of it is the trigger's jitter, or a focal length that differs.
void StereoCheck::compareTimes(const std::vector<Match>& matches, const cv::Mat& left_image,
                               const cv::Mat& other, const StereoCamera* camera,
                               Timing& timing) const {
  if (other.size() != left_image.size()) return;
  std::vector<Eigen::Vector2d> left;
  for (const Match& one : matches) {
    left.push_back(one.row.right + Eigen::Vector2d(one.disparity, -one.row.rows));
  }
  const int levels = kFlow.coarsest_level + 1;
  const auto found = stereo::trackPoints(
      stereo::buildPyramid(left_image, levels, stereo::Gradients::kAll),
      stereo::buildPyramid(other, levels, stereo::Gradients::kAll), left, left, kFlow);
  std::vector<double> rows, flows, deviations;
  for (std::size_t i = 0; i < left.size(); ++i) {
    if (!found[i]) continue;
    const double by_turn =
        camera == nullptr ? 0.0 : stereo::rowShift(matches[i].row.right, turn_, *camera);
    rows.push_back(matches[i].row.rows - by_turn);
    flows.push_back(found[i]->y() - left[i].y());
  }
  const double usual_row = median(rows), usual_flow = median(flows);
  for (const double flow : flows) deviations.push_back(std::abs(flow - usual_flow));
  const double max_flow = kLimits.max_deviations * median(deviations);
  double corners = 0.0, rows2 = 0.0, flow2 = 0.0, both = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double row = rows[i] - usual_row, flow = flows[i] - usual_flow;
    if (std::abs(flow) > max_flow) continue;  // mistaken, or something else that moves
    corners += 1.0;
    rows2 += row * row;
    flow2 += flow * flow;
    both += row * flow;
  }
  const double min_flow = std::clamp(kLimits.flow_per_width * left_image.cols, kLimits.min_flow_px,
                                     kLimits.max_flow_px);
  const bool is_moving = flow2 > corners * square(min_flow) && corners >= kLimits.min_moving;
  if (!is_moving) return timing.evidence.add(kLimits.rest);
  timing.frames = both / flow2;
  const double tried = std::max(1.0, timing.frames);
  const double noise2 = corners * square(kLimits.rows_px);
  const double left2 = rows2 + tried * (tried * flow2 - 2.0 * both);
  const double ratio = 0.5 * corners * std::log((rows2 + noise2) / (left2 + noise2));
  timing.evidence.add(std::clamp(ratio + kLimits.rest, -kLimits.most, kLimits.most));
}

/// Whether the images match the other way round, where they do not as they are.
bool StereoCheck::isSwapped(const StereoFrame& frame) const {
  StereoFrame other = frame;
  std::swap(other.left, other.right);
  const auto matches = matchesOf(other, kSearch.corners, kSearch.turn_rad);
  const auto is_before = [](const Match& one) { return one.disparity > -kLimits.swapped_px; };
  const auto before = std::count_if(matches.begin(), matches.end(), is_before);
  return matches.size() >= kLimits.min_matches &&
         static_cast<double>(before) > kLimits.swapped_ratio * static_cast<double>(matches.size());
}

std::optional<stereo::RectificationError> StereoCheck::rectification() const {
  auto error = estimator_ ? estimator_->error() : std::nullopt;
  if (error) error->disparities = disparities_;
  return error;
}

/// Improves the estimate of the right camera's rotation, and what is undone of it.
std::optional<Finding> StereoCheck::estimate(const std::vector<Match>& matches,
                                             const StereoFrame& frame) {
  std::vector<stereo::RowMatch> rows_by_place;
  for (const auto& one : matches) rows_by_place.push_back(one.row);
  estimator_->add(rows_by_place, frame.time);
  ++estimated_;
  const auto error = rectification();
  if (!error) return std::nullopt;
  turn_ = stereo::correctionFor(*error, turn_, *frame.camera, margin_sigmas_);
  if (estimated_ < kTimes.min_refusing || estimated_ > kTimes.first) return std::nullopt;
  return turnFinding(*error, *frame.camera, frame.index);
}

std::optional<Finding> StereoCheck::addOffset(const stereo::OffsetEstimate& offset,
                                              const StereoCamera& camera, std::size_t frame) {
  addOffsetAtGivenPoses({offset.px, offset.sigma_px / std::sqrt(kIndependentOffset)}, camera);
  const auto error = rectification();
  if (!error || hasMoved()) return std::nullopt;
  return turnFinding(*error, camera, frame);
}

void StereoCheck::addOffsetAtGivenPoses(const stereo::OffsetEstimate& offset,
                                        const StereoCamera& camera) {
  const double undone_px = turn_.y() / stereo::yawOfOffset(1.0, camera);
  disparities_ = {undone_px + offset.px, offset.sigma_px};
  const auto error = rectification();
  if (error) turn_ = stereo::correctionFor(*error, turn_, camera, margin_sigmas_);
}

/// Matches the pair coarsely over half of its width.
std::optional<Finding> StereoCheck::compareRange(const StereoFrame& frame) {
  if (frame.camera == nullptr) return std::nullopt;
  const auto& camera = *frame.camera;
  const double nearest_m = stereo::nearestMatched(camera, matching_);
  if (!std::isfinite(nearest_m)) return std::nullopt;  // too narrow to be matched
  if (last_range_ && std::abs(frame.time - *last_range_) < kRange.interval_s) return std::nullopt;
  last_range_ = frame.time;
  stereo::DisparityParams coarse;
  coarse.reduce = std::max(1, frame.left.cols / kRange.width);
  coarse.nearest_m = kRange.nearest_m;
  coarse.uniqueness_percent = kRange.uniqueness_percent;
  const cv::Mat disparities = stereo::denseDisparity(frame, coarse).values;
  const double limit = camera.fx * camera.baseline_m / nearest_m + coarse.reduce;
  std::vector<double> near;
  for (auto d = disparities.begin<float>(); d != disparities.end<float>(); ++d) {
    if (static_cast<double>(*d) > limit) near.push_back(static_cast<double>(*d));
  }
  const double ratio =
      static_cast<double>(near.size()) / std::max(1.0, static_cast<double>(disparities.total()));
  near_ = ratio > kRange.ratio ? near_ + 1 : 0;
  if (near_ * kRange.interval_s <= kRange.seconds) return std::nullopt;
  return Finding{
      "too_near", frame.index,
      formatted("%.0f %% of the image is nearer than %.2f m, the least depth that is matched, and "
                "therefore neither obstacle nor ground nor object: set disparity.nearest_m to %.2g",
                100.0 * ratio, nearest_m,
                0.9 * camera.fx * camera.baseline_m / percentile(near, 0.9))};
}

bool StereoCheck::isStarting() const { return estimated_ < kTimes.first; }

Findings StereoCheck::add(const StereoFrame& frame) {
  if (frame.right.empty()) return {};  // of a depth camera
  if (!estimator_ && frame.camera != nullptr) estimator_.emplace(*frame.camera, known_);
  Findings findings;
  if (auto near = compareRange(frame)) findings.push_back(std::move(*near));
  const auto isDue = [&](const std::optional<Time>& last, double interval_s) {
    return !last || std::abs(frame.time - *last) >= interval_s;
  };
  const bool is_due = isDue(last_, kTimes.interval_s);
  const cv::Mat left_before = std::exchange(left_before_, frame.left);
  const auto matches_before = std::exchange(matches_before_, {});
  if (!matches_before.empty()) {
    compareTimes(matches_before, left_before, frame.left, frame.camera.get(), early_);
  }
  const auto isSuspected = [&] {
    return late_.evidence.isSuspected() || early_.evidence.isSuspected();
  };
  const bool is_timed = is_due || (isSuspected() && isDue(last_timed_, kTimes.suspected_s));
  const bool is_first = estimator_ && isStarting();
  if (!is_timed && !is_first) return findings;
  auto matches =
      matchesOf(frame, is_first ? kSearch.many_corners : kSearch.corners, kSearch.turn_rad);
  if (matches.size() < kLimits.min_matches)
    matches = matchesOf(frame, kSearch.many_corners, kSearch.wide_turn_rad);
  if (is_timed) {
    last_timed_ = frame.time;
    compareTimes(matches, frame.left, left_before, frame.camera.get(), late_);
    matches_before_ = matches;
  }
  if (estimator_ && !isSuspected() && matches.size() >= kLimits.min_matches) {
    if (auto fatal = estimate(matches, frame)) findings.push_back(std::move(*fatal));
  }
  const bool is_late = late_.evidence.isDecisive() || early_.evidence.isDecisive();
  if (!is_due && !is_late) return findings;
  if (is_due) last_ = frame.time;
  double rows_px = 0.0;
  const Condition before = condition_;
  condition_ = is_late ? Condition::kLate : compare(matches, frame.camera.get(), rows_px);
  if (matches.size() < kLimits.min_matches && condition_ == Condition::kNone && isSwapped(frame)) {
    condition_ = Condition::kSwapped;
  }
  const auto is_of_time = [](Condition condition) {
    return condition == Condition::kLate || condition == Condition::kScattered;
  };
  persists_ = is_late || (condition_ != Condition::kNone &&
                          (condition_ == before || (is_of_time(condition_) && is_of_time(before))));
  if (persists_) {
    findings.push_back(findingOf(frame, rows_px));
  } else if (frame.camera != nullptr &&
             std::abs(turn_.x()) * frame.camera->fy > kLimits.max_offset_px) {
    findings.push_back(offsetFinding(frame, std::abs(turn_.x()) * frame.camera->fy, "; corrected"));
  }
  return findings;
}

Finding StereoCheck::findingOf(const StereoFrame& frame, double rows_px) const {
  if (condition_ == Condition::kSwapped) {
    return {"images_swapped", frame.index,
            "left and right images are swapped: most points have a negative disparity; check the "
            "order of the cameras"};
  }
  if (condition_ == Condition::kOffset) return offsetFinding(frame, rows_px, "");
  if (condition_ == Condition::kLate) {
    const bool is_early = early_.evidence.isDecisive();
    return {"images_not_simultaneous", frame.index,
            formatted("the right image is %.1f frames %s: its rows differ as the left image moves; "
                      "check the cameras' trigger, and whether a driver delays images",
                      is_early ? early_.frames : late_.frames, is_early ? "early" : "late")};
  }
  return {"images_not_simultaneous", frame.index,
          formatted("the rows of left and right images differ by %.1f px, by place: the images are "
                    "not of the same time, or the calibration is wrong; check the cameras' trigger",
                    rows_px)};
}

}  // namespace headway::pipeline
