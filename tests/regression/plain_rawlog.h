// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_sink.h>

#include <opencv2/imgproc.hpp>
#include <string>

namespace headway::test {

/// A rectified pair of cameras for small made-up rawlogs.
inline StereoCamera plainCamera() {
  StereoCamera camera;
  camera.width = 320;
  camera.height = 240;
  camera.fx = camera.fy = 260.0;
  camera.cx = 160.0;
  camera.cy = 120.0;
  camera.baseline_m = 0.2;
  return camera;
}

/// A stereo pair in front of a wall of random texture at 4 m, moved sideways by `shift_px`.
struct PlainPair {
  cv::Mat left;
  cv::Mat right;
};

inline PlainPair plainPair(int shift_px) {
  cv::Mat wall(240, 480, CV_8U);
  cv::RNG random(7);
  random.fill(wall, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(wall, wall, {5, 5}, 1.2);
  cv::normalize(wall, wall, 0, 255, cv::NORM_MINMAX);
  const int disparity = 13;  // 260 px * 0.2 m / 4 m
  return {wall(cv::Rect(40 + shift_px, 0, 320, 240)).clone(),
          wall(cv::Rect(40 + shift_px + disparity, 0, 320, 240)).clone()};
}

inline constexpr int kPlainFrames = 12;

/// Time of a frame of a plain rawlog [s].
inline Time plainTime(int frame) { return 1000.0 + 0.1 * frame; }

/// A pedestrian straight ahead, as a well-behaved detector would report it.
inline Detection plainDetection() {
  Detection detection;
  detection.object_class = ObjectClass::kPedestrian;
  detection.score = 0.9;
  detection.box2d = Box2d{140, 80, 180, 180};
  detection.box3d = Box3d{{0.0, 0.3, 3.5}, 0.8, 0.6, 1.7, 0.0};
  return detection;
}

/// Writes one frame with its boxes.
inline void writePlainFrame(io::RawlogSink& sink, int frame, const std::vector<Detection>& items) {
  const auto pair = plainPair(frame);
  sink.writeStereo(plainTime(frame), pair.left, pair.right, io::rawFrom(plainCamera()));
  Detections detections;
  detections.time = plainTime(frame);
  detections.image_width = 320;
  detections.image_height = 240;
  detections.items = items;
  sink.writeDetections("detections", detections);
}

/// Writes a rawlog of kPlainFrames good frames.
inline void writePlainRawlog(const std::string& path,
                             io::ImageStorage storage = io::ImageStorage::kEmbedded) {
  io::RawlogSink sink(path, storage);
  for (int frame = 0; frame < kPlainFrames; ++frame) {
    writePlainFrame(sink, frame, {plainDetection()});
  }
  sink.close();
}

}  // namespace headway::test
