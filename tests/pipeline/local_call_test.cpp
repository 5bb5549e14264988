// SPDX-License-Identifier: BSD-3-Clause
// What a host hears of a frame while objects are still detected in it, in another thread.
#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/painted_street.h>

#include <memory>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <vector>

namespace headway::pipeline {
namespace {

class LocalCallTest : public ::testing::Test {
 protected:
  /// The thread sanitizer does not see how OpenCV's own threads wait for each other.
  LocalCallTest() { cv::setNumThreads(1); }
  ~LocalCallTest() override { cv::setNumThreads(-1); }

  static PerceptionParams byMotion() {
    PerceptionParams params;
    params.detection.detector = "stereo_motion";
    return params;
  }

  PerceptionUpdate process(int i, const LocalCall& on_local) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.stereo = street_.frame(i);
    frame.time = frame.stereo->time;
    return perception_.process(frame, on_local);
  }

  test::PaintedStreet street_{{{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12},
                               {{-2.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11}}};
  Perception perception_{street_.camera(), byMotion()};
};

TEST_F(LocalCallTest, WhatIsBlockedNowIsKnownBeforeTracksAre) {
  bool has_tracks = false;
  PerceptionCallbacks callbacks;
  callbacks.on_tracks = [&](Time, const std::vector<Track>&) { has_tracks = true; };
  perception_.setCallbacks(callbacks);
  std::vector<std::shared_ptr<const map::LocalLayer>> layers;
  for (int i = 0; i < 3; ++i) {
    has_tracks = false;
    (void)process(i, [&](const slam::SlamUpdate&, const map::PerceptionMap& map) {
      EXPECT_FALSE(has_tracks);
      layers.push_back(map.local());
    });
    EXPECT_EQ(layers.back(), perception_.map().local()) << "the frame's own, and its last word";
  }
  ASSERT_EQ(3U, layers.size());
  EXPECT_NE(nullptr, layers[0]);
  EXPECT_NE(layers[0], layers[1]);
}

TEST_F(LocalCallTest, WhatAHostThrowsReachesItOnceDetectionHasEnded) {
  const auto fail = [](const slam::SlamUpdate&, const map::PerceptionMap&) {
    throw std::runtime_error("no subscriber");
  };
  EXPECT_THROW((void)process(0, fail), std::runtime_error);
  EXPECT_TRUE(slam::isTracked(process(1, {}).camera.status));
}

}  // namespace
}  // namespace headway::pipeline
