// SPDX-License-Identifier: BSD-3-Clause
// Percentiles, histograms in bounded memory, and the rate of frames.
#include <headway/core/statistics.h>

#include <algorithm>
#include <cmath>

namespace headway {

double percentile(std::vector<double> samples, double fraction) {
  if (samples.empty()) return 0.0;
  const auto count = static_cast<double>(samples.size());
  const double rank = std::clamp(std::ceil(fraction * count), 1.0, count);
  const auto nth = samples.begin() + static_cast<std::ptrdiff_t>(rank - 1.0);
  std::nth_element(samples.begin(), nth, samples.end());
  return *nth;
}

double median(std::vector<double> samples) {
  if (samples.empty()) return 0.0;
  const auto middle = samples.begin() + static_cast<std::ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return *middle;
}

namespace {

constexpr double kRatio = 1.01;  // of the limits of a bin
constexpr double kLowest = 1e-3;
constexpr double kHighest = 1e9;

int binOf(double sample) {
  static const double scale = 1.0 / std::log(kRatio);
  return static_cast<int>(std::floor(scale * std::log(std::clamp(sample, kLowest, kHighest))));
}

}  // namespace

void Histogram::add(double sample) {
  Bin& bin = bins_[binOf(sample)];
  ++bin.count;
  bin.sum += sample;
  max_ = count_ == 0 ? sample : std::max(max_, sample);
  ++count_;
  sum_ += sample;
}

void Histogram::merge(const Histogram& other) {
  if (other.empty()) return;
  for (const auto& [index, added] : other.bins_) {
    Bin& bin = bins_[index];
    bin.count += added.count;
    bin.sum += added.sum;
  }
  max_ = empty() ? other.max_ : std::max(max_, other.max_);
  count_ += other.count_;
  sum_ += other.sum_;
}

double Histogram::mean() const { return empty() ? 0.0 : sum_ / static_cast<double>(count_); }

double Histogram::percentile(double fraction) const {
  if (empty()) return 0.0;
  const auto count = static_cast<double>(count_);
  const auto rank = static_cast<std::size_t>(std::clamp(std::ceil(fraction * count), 1.0, count));
  if (rank == count_) return max_;
  std::size_t below = 0;
  for (const auto& [index, bin] : bins_) {
    below += bin.count;
    if (below >= rank) return bin.sum / static_cast<double>(bin.count);
  }
  return max_;
}

void FrameRate::add(double time) {
  constexpr std::size_t kEnough = 3;  ///< intervals, of which a single wrong one is not the median
  if (last_) {
    // To a microsecond, more than the resolution of a double that counts from the epoch.
    last_interval_s_ = std::max(0.0, std::round(1e6 * (time - *last_)) / 1e6);
    if (last_interval_s_ > 0.0) intervals_.add(last_interval_s_);
    if (intervals_.count() >= kEnough) interval_s_ = intervals_.percentile(0.5);
  }
  last_ = time;
}

}  // namespace headway
