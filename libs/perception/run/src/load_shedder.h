// SPDX-License-Identifier: BSD-3-Clause
// Which work is left out while frames take longer than their interval.
#pragma once

#include <headway/pipeline/perception.h>

#include <optional>
#include <string>

namespace headway::run {

/// Decides which work is left out while frames take longer than the sensor's interval.
///
/// The least useful work is left out first, one step after the other: the page, most ground scans,
/// all ground scans, boxes beyond 30 m. A step is taken back after a calm time, which doubles
/// whenever that brought the overload back. Time is what the caller says it is.
///
///     LoadShedder shedder(pipeline::RuntimeParams{});
///     if (const auto line = shedder.add(now_s, process_s, interval_s)) {
///       log(*line);
///       perception.change(shedder.params());
///     }
class LoadShedder {
 public:
  /// What is left out; each with those before.
  enum class Level { kNothing, kPictures, kMostScans, kScans, kFarBoxes };

  /// @param full  parameters without any load
  explicit LoadShedder(const pipeline::RuntimeParams& full) : full_(full) {}

  /// Takes the times of one frame.
  ///
  /// @param now_s       of a clock that does not go back [s]
  /// @param process_s   processing of the frame, with all that is done in its thread [s]
  /// @param interval_s  between two frames of the sensor, > 0 [s]
  /// @return            one line for the log if the level changed
  std::optional<std::string> add(double now_s, double process_s, double interval_s);

  [[nodiscard]] Level level() const { return level_; }
  /// For Perception::change().
  [[nodiscard]] pipeline::RuntimeParams params() const;
  /// What is left out, such as "without pictures and grid"; empty if nothing is.
  [[nodiscard]] std::string description() const;

 private:
  static constexpr double kMinCalm_s = 3.0;

  void shed(double now_s);
  void recover(double now_s);

  pipeline::RuntimeParams full_;
  Level level_ = Level::kNothing;
  double interval_s_ = 0.0;             ///< between the last two frames
  std::optional<double> load_;          ///< processing over interval, smoothed
  std::optional<double> over_since_;    ///< the load exceeds the interval
  std::optional<double> calm_since_;    ///< the load leaves room
  std::optional<double> recovered_at_;  ///< the latest step that was taken back
  double calm_s_ = kMinCalm_s;          ///< before a step is taken back
};

}  // namespace headway::run
