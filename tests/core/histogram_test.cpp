// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/random.h>
#include <headway/core/statistics.h>

#include <cmath>
#include <vector>

namespace headway {
namespace {

TEST(HistogramTest, IsZeroWithoutSamples) {
  const Histogram none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(0.0, none.mean());
  EXPECT_EQ(0.0, none.max());
  EXPECT_EQ(0.0, none.percentile(0.5));
}

TEST(HistogramTest, PercentilesDifferByLessThanOnePercent) {
  Random random(7);
  Histogram histogram;
  std::vector<double> samples;
  double sum = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double sample = std::exp(random.uniform(-6.0, 12.0));
    samples.push_back(sample);
    histogram.add(sample);
    sum += sample;
  }
  for (const double fraction : {0.0, 0.05, 0.5, 0.95, 0.999}) {
    const double exact = percentile(samples, fraction);
    EXPECT_NEAR(exact, histogram.percentile(fraction), 0.01 * exact) << fraction;
  }
  EXPECT_EQ(percentile(samples, 1.0), histogram.percentile(1.0));
  EXPECT_EQ(percentile(samples, 1.0), histogram.max());
  EXPECT_EQ(samples.size(), histogram.count());
  EXPECT_DOUBLE_EQ(sum, histogram.sum());
}

TEST(HistogramTest, KeepsSamplesBeyondItsLimits) {
  Histogram histogram;
  for (const double sample : {0.0, 0.0, 1e-5, 1e12}) histogram.add(sample);
  EXPECT_EQ(4u, histogram.count());
  EXPECT_LT(histogram.percentile(0.5), 1e-3);
  EXPECT_EQ(1e12, histogram.max());
}

TEST(HistogramTest, MergedEqualsOneOfAllSamples) {
  Histogram first, second, all;
  for (int i = 1; i <= 50; ++i) {
    (i % 3 == 0 ? first : second).add(i);
    all.add(i);
  }
  first.merge(second);
  first.merge(Histogram());
  EXPECT_EQ(all.count(), first.count());
  EXPECT_EQ(all.sum(), first.sum());
  EXPECT_EQ(all.max(), first.max());
  EXPECT_EQ(all.percentile(0.5), first.percentile(0.5));
}

}  // namespace
}  // namespace headway
