// SPDX-License-Identifier: BSD-3-Clause
// headway-eval trajectory: an estimated trajectory against the true one.
#include <headway/core/error.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/plots.h>
#include <headway/eval/trajectory_error.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway/plot/text_table.h>
#include <headway/program/truth_report.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

using eval::PoseFormat;
using eval::poseFormatOf;

struct TrajectoryOptions {
  std::string truth;
  std::string estimate;
  std::string format;
  std::string align = "se3";
  std::string segments = "100,200,300,400,500,600,700,800";
  double max_difference_s = program::kSameTime_s;
  std::string truth_rotation;
  Outputs outputs;
};

PoseFormat formatFrom(const TrajectoryOptions& options) {
  if (options.format == "tum") return PoseFormat::kTum;
  if (options.format == "kitti") return PoseFormat::kKitti;
  if (!options.format.empty()) {
    throw program::UsageError("--format: '" + options.format + "' is neither tum nor kitti");
  }
  return poseFormatOf(options.estimate);
}

eval::Alignment alignmentFrom(const std::string& name) {
  if (name == "se3") return eval::Alignment::kSe3;
  if (name == "none") return eval::Alignment::kNone;
  if (name == "scale") return eval::Alignment::kScale;
  if (name == "origin") return eval::Alignment::kOrigin;
  throw program::UsageError("--align: '" + name + "' is none of se3, origin, scale, none");
}

/// @param what  of the numbers, for messages
std::vector<double> numbersFrom(const std::string& list, const std::string& option,
                                const std::string& what) {
  std::vector<double> numbers;
  for (const std::string& word : program::split(list)) {
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    if (word.empty() || *end != '\0' || !std::isfinite(number)) {
      throw program::UsageError(option + ": '" + word + "' is not " + what);
    }
    numbers.push_back(number);
  }
  return numbers;
}

std::vector<double> segmentLengthsFrom(const std::string& list) {
  const auto lengths = numbersFrom(list, "--segments", "a length in metres");
  if (std::any_of(lengths.begin(), lengths.end(), [](double length) { return length <= 0.0; })) {
    throw program::UsageError("--segments: '" + list + "' contains what is not a length in metres");
  }
  return lengths;
}

std::optional<Eigen::Matrix3d> rotationFrom(const std::string& list) {
  if (list.empty()) return std::nullopt;
  const auto angles = numbersFrom(list, "--truth-rotation", "an angle in degrees");
  if (angles.size() != 3) throw program::UsageError("--truth-rotation: give YAW,PITCH,ROLL");
  return (Eigen::AngleAxisd(angles[0] * kDegree, Eigen::Vector3d::UnitZ()) *
          Eigen::AngleAxisd(angles[1] * kDegree, Eigen::Vector3d::UnitY()) *
          Eigen::AngleAxisd(angles[2] * kDegree, Eigen::Vector3d::UnitX()))
      .toRotationMatrix();
}

std::vector<Stamped<Pose>> readTimedTruth(const std::string& path) {
  if (!io::hasRawlogName(path)) return io::readTum(path);
  auto truth = io::readTruth(path).poses;
  if (truth.empty()) throw InputError(path + ": contains no poses labelled truth_pose");
  return truth;
}

eval::PosePairs readPairs(const TrajectoryOptions& options, PoseFormat format) {
  if (format == PoseFormat::kKitti) {
    if (io::hasRawlogName(options.truth) || poseFormatOf(options.truth) != PoseFormat::kKitti) {
      throw InputError(options.estimate +
                       ": KITTI poses have no times and require a true trajectory "
                       "in KITTI format; " +
                       options.truth + " is not");
    }
    return eval::pairByIndex(io::readKittiPoses(options.truth),
                             io::readKittiPoses(options.estimate));
  }
  if (!io::hasRawlogName(options.truth) && poseFormatOf(options.truth) != PoseFormat::kTum) {
    throw InputError(options.truth +
                     ": KITTI poses have no times; compare them with an estimate "
                     "in KITTI format (trajectory_kitti.txt), or give the truth as TUM or rawlog");
  }
  return eval::pairByTime(readTimedTruth(options.truth), io::readTum(options.estimate),
                          options.max_difference_s);
}

bool parseTrajectory(TrajectoryOptions& options, int argc, const char** argv) {
  program::CommandLine line(
      "headway-eval trajectory",
      "Evaluates an estimated trajectory: absolute error (ATE), relative error "
      "per frame (RPE) and over path segments (KITTI).");
  line.option(options.truth, 0, "truth", "FILE", "TUM or KITTI poses, or a rawlog with truth",
              true);
  line.option(options.estimate, 0, "estimate", "FILE", "TUM or KITTI poses", true);
  line.option(options.format, 0, "format", "tum|kitti",
              "Format of the estimate; default: detected from its columns");
  line.option(options.align, 0, "align", "se3|origin|scale|none",
              "Alignment of the estimate: se3 fits all poses (default), origin makes the first "
              "poses equal, scale fits the scale too");
  line.option(options.segments, 0, "segments", "M,M,...",
              "Lengths of the KITTI path segments [m]; default 100,200,...,800");
  line.option(options.max_difference_s, 0, "max-difference", "S",
              "Maximum time difference of paired poses [s]; default 0.02");
  line.option(
      options.truth_rotation, 0, "truth-rotation", "YAW,PITCH,ROLL",
      "Axes of the truth's body on the robot [deg], -90,0,-90 for a camera's optical frame; "
      "default: found by the motion, else those of the robot");
  return options.outputs.parse(line, argc, argv, {&options.truth, &options.estimate});
}

eval::TrajectoryError compare(const TrajectoryOptions& options, PoseFormat format) {
  eval::TrajectoryErrorParams params;
  params.alignment = alignmentFrom(options.align);
  params.segment_lengths_m = segmentLengthsFrom(options.segments);
  params.R_robot_truth = rotationFrom(options.truth_rotation);
  params.finds_rotation = true;
  const auto pairs = readPairs(options, format);
  return eval::trajectoryError(pairs, params);
}

}  // namespace

int runTrajectory(int argc, const char** argv) {
  TrajectoryOptions options;
  if (!parseTrajectory(options, argc, argv)) return program::kDone;
  const PoseFormat format = formatFrom(options);
  const auto error = compare(options, format);
  if (error.body.source == eval::BodyRotation::Source::kUnknown) {
    std::cerr << "headway-eval: warning: the truth's body has other axes than the robot, and the "
                 "motion does not determine them, so that relative errors are too large; state "
                 "--truth-rotation YAW,PITCH,ROLL"
              << std::endl;
  }
  if (!options.outputs.quiet()) plot::writeTable(std::cout, eval::tableOf(error));
  const auto plot = [&] {
    const auto view = format == PoseFormat::kKitti ? eval::TopView::kXz : eval::TopView::kXy;
    return eval::trajectoryPlot(error, view,
                                recordingName(options.estimate) + " against the truth");
  };
  options.outputs.write([&] { return eval::toJson(error); }, plot);
  return program::kDone;
}

}  // namespace headway::app
