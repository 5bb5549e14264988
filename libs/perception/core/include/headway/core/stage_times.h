// SPDX-License-Identifier: BSD-3-Clause
// Durations of the stages of a frame, and processor time.
#pragma once

#include <headway/core/statistics.h>

#include <chrono>
#include <map>
#include <string>

namespace headway {

/// Processor time of this process, sum of all threads [s].
[[nodiscard]] double processorSeconds();

/// Distribution of the durations of named stages [ms], one sample per frame, in bounded memory.
///
/// Medians and percentiles differ from the exact ones by less than 1 % (see Histogram). Not
/// thread-safe: each thread has its own instance, and merge() combines them.
///
///     StageTimes times;
///     { auto watch = times.watch("slam_track");  track(frame); }
///     times.summary().at("slam_track").median_ms;
class StageTimes {
 public:
  /// Adds the time from its construction to its destruction to one stage.
  class Watch {
   public:
    Watch(StageTimes& owner, std::string stage)
        : owner_(owner), stage_(std::move(stage)), start_(std::chrono::steady_clock::now()) {}
    ~Watch() { owner_.add(stage_, elapsedMs()); }
    Watch(const Watch&) = delete;
    Watch& operator=(const Watch&) = delete;
    [[nodiscard]] double elapsedMs() const {
      return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_)
          .count();
    }

   private:
    StageTimes& owner_;
    std::string stage_;
    std::chrono::steady_clock::time_point start_;
  };
  /// Figures of one stage.
  struct Summary {
    std::size_t count = 0;
    double median_ms = 0.0;
    double p95_ms = 0.0;
    double max_ms = 0.0;
    double total_ms = 0.0;
  };

  [[nodiscard]] Watch watch(std::string stage) { return Watch(*this, std::move(stage)); }
  void add(const std::string& stage, double milliseconds);
  void merge(const StageTimes& other);

  [[nodiscard]] std::map<std::string, Summary> summary() const;
  [[nodiscard]] bool empty() const { return stages_.empty(); }

 private:
  std::map<std::string, Histogram> stages_;
};

}  // namespace headway
