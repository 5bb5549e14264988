// SPDX-License-Identifier: BSD-3-Clause
// Recordings of a rig of two cameras of which one fails in mid-run, and what is noticed of it.
#pragma once

#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "input_health.h"

namespace headway::pipeline {

using Frames = std::vector<RecordedFrame>;

/// The first frames of a recording, with images reduced to a width [px].
inline Frames recordedFrames(const std::string& rawlog, std::size_t count, int width) {
  io::RawlogSourceOptions options;
  options.to_index = count - 1;
  io::RawlogSource source(rawlog, options);
  Frames frames;
  auto camera = std::make_shared<StereoCamera>();
  while (auto frame = source.next()) {
    StereoFrame& pair = *frame->stereo;
    if (frames.empty()) *camera = *pair.camera;
    const double scale = static_cast<double>(width) / camera->width;
    const cv::Size size(width, static_cast<int>(std::lround(scale * camera->height)));
    cv::resize(pair.left, pair.left, size, 0, 0, cv::INTER_AREA);
    cv::resize(pair.right, pair.right, size, 0, 0, cv::INTER_AREA);
    pair.camera = camera;
    frames.push_back(std::move(*frame));
  }
  const double scale = static_cast<double>(width) / camera->width;
  for (double* length : {&camera->fx, &camera->fy}) *length *= scale;
  for (double* centre : {&camera->cx, &camera->cy}) *centre = (*centre + 0.5) * scale - 0.5;
  camera->width = frames.front().stereo->left.cols;
  camera->height = frames.front().stereo->left.rows;
  return frames;
}

/// Makes frame i of the recording one of a rig that fails at frame `begin`.
using Failure = std::function<void(const Frames&, std::size_t begin, std::size_t i, StereoFrame&)>;

/// A way in which a rig fails.
struct FailingRig {
  const char* name;
  Failure fail;
  double seconds;  ///< of motion, in which it is noticed
};

/// An image whose content lies so many pixels to the right and below.
inline cv::Mat shifted(const cv::Mat& image, int columns, int rows) {
  cv::Mat result;
  const cv::Matx23d shift(1, 0, columns, 0, 1, rows);
  cv::warpAffine(image, result, shift, image.size(), cv::INTER_NEAREST, cv::BORDER_REPLICATE);
  return result;
}

inline const std::vector<FailingRig>& failingRigs() {
  const auto turned = [](const cv::Mat& image) {
    cv::Mat result;
    cv::flip(image, result, -1);
    return result;
  };
  const auto shiftedBy = [](int columns, int rows) {
    return [columns, rows](const Frames&, std::size_t, std::size_t, StereoFrame& pair) {
      pair.right = shifted(pair.right, columns, rows);
    };
  };
  static const std::vector<FailingRig> kRigs = {
      {"LeftFrozen",
       [](const Frames& good, std::size_t begin, std::size_t, StereoFrame& pair) {
         pair.left = good[begin - 1].stereo->left.clone();
       },
       0.0},
      {"RightFrozen",
       [](const Frames& good, std::size_t begin, std::size_t, StereoFrame& pair) {
         pair.right = good[begin - 1].stereo->right.clone();
       },
       0.0},
      {"RightIsLeft",
       [](const Frames&, std::size_t, std::size_t, StereoFrame& pair) { pair.right = pair.left; },
       0.0},
      {"RightBlack",
       [](const Frames&, std::size_t, std::size_t, StereoFrame& pair) {
         pair.right = cv::Mat(pair.right.size(), CV_8U, cv::Scalar(0));
       },
       0.0},
      {"RightLate",
       [](const Frames& good, std::size_t, std::size_t i, StereoFrame& pair) {
         pair.right = good[i - 1].stereo->right;
       },
       1.0},
      {"RightEarly",
       [](const Frames& good, std::size_t, std::size_t i, StereoFrame& pair) {
         pair.right = good[i + 1].stereo->right;
       },
       1.0},
      {"BothUpsideDown",
       [turned](const Frames&, std::size_t, std::size_t, StereoFrame& pair) {
         pair.left = turned(pair.left);
         pair.right = turned(pair.right);
       },
       1.0},
      {"RightFourRowsLower", shiftedBy(0, 4), 1.0},
      {"RightFourRowsHigher", shiftedBy(0, -4), 1.0},
      {"RightTenRowsLower", shiftedBy(0, 10), 1.0},
      {"RightFourColumnsToTheRight", shiftedBy(4, 0), 1.0},
      {"RightFourColumnsToTheLeft", shiftedBy(-4, 0), 1.0},
  };
  return kRigs;
}

/// What becomes of a recording's frames.
struct Noticed {
  std::vector<bool> doubted;          ///< no pose of the frame counts
  std::vector<std::string> findings;  ///< of the frame, by name
};

/// Drives through a recording whose rig fails in the frames from `begin` up to `end`.
inline Noticed noticed(const Frames& frames, const Failure& fail, std::size_t begin,
                       std::size_t end) {
  PerceptionParams params;
  params.detection.detector = "none";
  params.grid.period_s = 0.0;
  params.grid.local = false;
  Perception perception(frames.front().stereo->camera, params);
  Noticed result;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    RecordedFrame frame = frames[i];
    if (i >= begin && i < end) fail(frames, begin, i, *frame.stereo);
    const PerceptionUpdate update = perception.process(frame);
    result.doubted.push_back(!slam::isTracked(update.camera.status));
    std::string names;
    for (const Finding& finding : update.findings) names += finding.name + " ";
    result.findings.push_back(names);
  }
  return result;
}

/// Frames whose images are not to be trusted; the rig fails in those from `begin` up to `end`.
inline std::vector<bool> doubtedFrames(const Frames& frames, const Failure& fail, std::size_t begin,
                                       std::size_t end) {
  InputHealth health(frames.front().stereo->camera, 70.0);
  PreviousFrame previous;
  const FrameRate rate;
  std::vector<bool> doubted;
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    RecordedFrame frame = frames[i];
    if (i >= begin && i < end) fail(frames, begin, i, *frame.stereo);
    const FrameState state(frame, previous, rate);
    (void)health.checkFrame(state);
    doubted.push_back(health.imageEvidence() != slam::ImageEvidence::kNone);
    (void)health.checkPair(state);
    previous.index = frame.index;
    previous.time = frame.time;
  }
  return doubted;
}

}  // namespace headway::pipeline
