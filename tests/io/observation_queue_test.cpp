// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservationOdometry.h>

#include <thread>

namespace headway::io {
namespace {

mrpt::obs::CObservation::Ptr labelled(int number) {
  auto observation = mrpt::obs::CObservationOdometry::Create();
  observation->sensorLabel = std::to_string(number);
  return observation;
}

TEST(ObservationQueueTest, ReturnsObservationsInOrderAndThenNull) {
  ObservationQueue queue;
  for (int i = 0; i < 3; ++i) queue.push(labelled(i));
  queue.push(nullptr);
  queue.close();
  queue.push(labelled(9));
  for (int i = 0; i < 3; ++i) EXPECT_EQ(queue.pop()->sensorLabel, std::to_string(i));
  EXPECT_EQ(queue.pop(), nullptr);
  EXPECT_EQ(queue.dropped(), 0u);
}

TEST(ObservationQueueTest, DropsAndCountsTheOldestIfFull) {
  ObservationQueue queue(2);
  for (int i = 0; i < 5; ++i) queue.push(labelled(i));
  EXPECT_EQ(queue.dropped(), 3u);
  EXPECT_EQ(queue.pop()->sensorLabel, "3");
}

TEST(ObservationQueueTest, WaitsForAnotherThread) {
  ObservationQueue queue;
  std::thread sensor([&] {
    for (int i = 0; i < 100; ++i) queue.push(labelled(i));
    queue.close();
  });
  int count = 0;
  while (const auto observation = queue.pop()) {
    EXPECT_EQ(observation->sensorLabel, std::to_string(count++));
  }
  sensor.join();
  EXPECT_EQ(count, 100);
}

TEST(ObservationQueueTest, WithoutACameraIsAnError) {
  ObservationQueue queue;
  queue.push(labelled(1));
  queue.close();
  EXPECT_THROW(RawlogSource(queue, {}), InputError);
}

}  // namespace
}  // namespace headway::io
