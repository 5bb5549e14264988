// SPDX-License-Identifier: BSD-3-Clause
// Width of the edges in an image, which grows with blur.
#include <headway/stereo/edge_width.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace headway::stereo {
namespace {

constexpr int kLineStep = 8;
// Squares of the coefficients of the three filters below, summed: their gains of white noise.
constexpr double kNoiseOfFirst = 84.0, kNoiseOfSecond = 28.0, kNoiseOfFourth = 70.0;
constexpr double kMedianOfNoise = 0.6745;  // median absolute value of a standard Gaussian
constexpr double kLeastSignal = 0.3;       // ratio of an energy that is not taken for noise
constexpr int kHistogram = 1024;           // of the fourth derivative: noise of 60 grey levels

double edgeWidth(const cv::Mat& image, bool along_columns) {
  const int count = along_columns ? image.rows : image.cols;
  const int lines = along_columns ? image.cols : image.rows;
  const auto row = static_cast<std::ptrdiff_t>(image.step);
  const std::ptrdiff_t step = along_columns ? row : 1, next_line = along_columns ? 1 : row;
  double first = 0.0, second = 0.0, samples = 0.0;
  std::vector<int> fourth(kHistogram, 0);  // whose median is that of noise: edges are rare
  for (int line = 0; line < lines; line += kLineStep) {
    const unsigned char* at = image.data + line * next_line + 3 * step;
    std::int64_t first_of_line = 0, second_of_line = 0;
    for (int i = 3; i + 3 < count; ++i, at += step) {
      const int a = at[-3 * step], b = at[-2 * step], c = at[-step], d = *at;
      const int e = at[step], f = at[2 * step], g = at[3 * step];
      const std::int64_t d1 = (g - a) + 4 * (f - b) + 5 * (e - c);
      const std::int64_t d2 = (a + g) + 2 * (b + f) - (c + e) - 4 * d;
      first_of_line += d1 * d1;
      second_of_line += d2 * d2;
      const int d4 = std::abs(b + f - 4 * (c + e) + 6 * d);
      ++fourth[static_cast<std::size_t>(std::min(d4, kHistogram - 1))];
    }
    first += static_cast<double>(first_of_line);
    second += static_cast<double>(second_of_line);
    samples += std::max(0, count - 6);
  }
  double median = -0.5, below = 0.0;  // interpolated within its bin
  for (const int in_bin : fourth) {
    if (below + in_bin >= 0.5 * samples) {
      median += in_bin > 0 ? (0.5 * samples - below) / in_bin : 0.0;
      break;
    }
    below += in_bin;
    median += 1.0;
  }
  const double sigma = std::max(0.0, median) / kMedianOfNoise;
  const double noise = samples * sigma * sigma / kNoiseOfFourth;
  first = std::max(first - kNoiseOfFirst * noise, kLeastSignal * first);
  second = std::max(second - kNoiseOfSecond * noise, kLeastSignal * second);
  return second > 0.0 ? std::sqrt(first / second) : 0.0;
}

}  // namespace

std::array<double, 2> edgeWidths(const cv::Mat& image) {
  return {edgeWidth(image, false), edgeWidth(image, true)};
}

}  // namespace headway::stereo
