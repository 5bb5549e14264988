// SPDX-License-Identifier: BSD-3-Clause
#include "status_line.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

namespace headway::live {

StatusLine::StatusLine(bool quiet, std::function<void()> poll, std::function<std::string()> wait)
    : quiet_(quiet), poll_(std::move(poll)), wait_(std::move(wait)), thread_([this] { run(); }) {}

StatusLine::~StatusLine() {
  stopping_ = true;
  thread_.join();
}

void StatusLine::update(const pipeline::PerceptionUpdate& update, double latency_s,
                        std::size_t dropped, const std::string& left_out) {
  const std::lock_guard lock(mutex_);
  last_ = update;
  max_latency_s_ = std::max(max_latency_s_, latency_s);
  ++frames_;
  dropped_ = dropped;
  left_out_ = left_out;
}

void StatusLine::run() {
  using Clock = std::chrono::steady_clock;
  auto due = Clock::now() + std::chrono::seconds(1);
  while (!stopping_) {
    poll_();
    if (Clock::now() >= due) {
      due += std::chrono::seconds(1);
      const std::string line = text();
      if (!quiet_) std::puts(line.c_str());
      std::fflush(stdout);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}

std::string StatusLine::text() {
  const std::lock_guard lock(mutex_);
  if (!last_) return "waiting for images" + wait_();
  const Pose& T_map_robot = last_->camera.T_map_robot;
  const auto& place = T_map_robot.translation();
  const auto is_confirmed = [](const Track& track) {
    return track.status == TrackStatus::kConfirmed;
  };
  const auto& tracks = last_->objects.tracks;
  std::array<char, 240> line{};
  std::snprintf(line.data(), line.size(),
                "frame %zu: x %.2f y %.2f m, yaw %.1f deg, %s (%d landmarks), %d tracks, %zu "
                "frames/s, latency %.0f ms at most, %zu dropped",
                last_->frame, place.x(), place.y(), yawOf(T_map_robot) * 180.0 / M_PI,
                frames_ == 0 ? "no images" : slam::toString(last_->camera.status),
                last_->camera.inliers,
                static_cast<int>(std::count_if(tracks.begin(), tracks.end(), is_confirmed)),
                frames_, 1e3 * max_latency_s_, dropped_);
  max_latency_s_ = 0.0;
  frames_ = 0;
  return line.data() + (left_out_.empty() ? "" : "; " + left_out_);
}

}  // namespace headway::live
