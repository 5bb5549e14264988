// SPDX-License-Identifier: BSD-3-Clause
// Which work is left out while frames take longer than their interval.
#include "load_shedder.h"

#include <mrpt/core/exceptions.h>

#include <algorithm>
#include <cmath>

namespace headway::run {
namespace {

constexpr double kGain = 0.25;       // of a frame in the smoothed load
constexpr double kRoom = 0.75;       // below which a step may be taken back
constexpr double kShedAfterS = 0.5;  // of overload
constexpr double kMaxCalmS = 60.0;
constexpr double kRelapseS = 10.0;  // overload so soon after a step back is its consequence
constexpr int kScansOfAll = 4;      // one of so many remains with kMostScans
constexpr double kNearM = 30.0;     // a car ahead at 30 km/h is there in 3.6 s

}  // namespace

std::optional<std::string> LoadShedder::add(double now_s, double process_s, double interval_s) {
  ASSERTMSG_(interval_s > 0.0, "the interval of frames is not positive");
  interval_s_ = interval_s;
  const double load = process_s / interval_s;
  if (!std::isfinite(load)) return std::nullopt;
  load_ = load_ ? *load_ + kGain * (load - *load_) : load;
  const Level before = level_;
  if (*load_ <= 1.0) over_since_.reset();
  if (*load_ >= kRoom) calm_since_.reset();
  if (*load_ > 1.0 && !over_since_) over_since_ = now_s;
  if (*load_ < kRoom && !calm_since_) calm_since_ = now_s;
  if (over_since_ && now_s - *over_since_ >= kShedAfterS) shed(now_s);
  if (calm_since_ && now_s - *calm_since_ >= calm_s_) recover(now_s);
  if (level_ == before) return std::nullopt;
  const int percent = static_cast<int>(std::lround(100.0 * std::min(*load_, 100.0)));
  const std::string text = "frames take " + std::to_string(percent) + " % of their interval: ";
  return text + (level_ == Level::kNothing ? "all work is done again" : description());
}

void LoadShedder::shed(double now_s) {
  over_since_ = now_s;  // the next step needs as long again
  if (level_ == Level::kFarBoxes) return;
  if (recovered_at_ && now_s - *recovered_at_ < kRelapseS) {
    calm_s_ = std::min(2.0 * calm_s_, kMaxCalmS);
    recovered_at_.reset();
  }
  level_ = static_cast<Level>(static_cast<int>(level_) + 1);
}

void LoadShedder::recover(double now_s) {
  calm_since_ = now_s;
  if (level_ == Level::kNothing) {
    calm_s_ = kMinCalm_s;
    return;
  }
  level_ = static_cast<Level>(static_cast<int>(level_) - 1);
  recovered_at_ = now_s;
}

pipeline::RuntimeParams LoadShedder::params() const {
  pipeline::RuntimeParams params = full_;
  if (level_ >= Level::kMostScans && params.grid_period_s > 0.0) {
    params.grid_period_s = kScansOfAll * std::max(params.grid_period_s, interval_s_);
  }
  if (level_ >= Level::kScans) params.grid_period_s = 0.0;
  if (level_ >= Level::kFarBoxes) params.max_box_range_m = std::min(params.max_box_range_m, kNearM);
  return params;
}

std::string LoadShedder::description() const {
  constexpr const char* kTexts[] = {
      "", "without pictures", "without pictures and most ground scans", "without pictures and grid",
      "without pictures, grid and boxes beyond 30 m"};
  return kTexts[static_cast<std::size_t>(level_)];
}

}  // namespace headway::run
