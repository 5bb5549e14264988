// Images as they are in bad weather and with bad cameras, through the whole pipeline with the
// poses of its own SLAM: less may be found, and what is left out is counted; never are there many
// tracks of what is not there.

#include <gtest/gtest.h>
#include <headway/pipeline/perception.h>
#include <headway_test/painted_street.h>

#include <functional>
#include <opencv2/imgproc.hpp>
#include <set>

namespace headway::pipeline {
namespace {

using test::PaintedBox;
using test::PaintedStreet;

constexpr int kFrames = 16;

const std::vector<PaintedBox> kStillStreet = {{{3.5, 1.6, 16.0}, 1.8, 1.5, {0.0, 0.0, 0.0}, 12},
                                              {{-4.5, 1.6, 22.0}, 0.5, 1.7, {0.0, 0.0, 0.0}, 13},
                                              {{-6.0, 1.6, 18.0}, 2.2, 1.8, {0.0, 0.0, 0.0}, 14}};
const PaintedBox kMover{{-2.0, 1.6, 17.0}, 1.8, 1.5, {2.5, 0.0, 4.0}, 11};

struct Trouble {
  const char* name;
  std::function<void(int, StereoFrame&)> spoil;
  double right_late_s = 0.0;
};

void rain(int seed, cv::Mat& image) {
  cv::RNG random(static_cast<std::uint64_t>(seed) + 17);
  for (int drop = 0; drop < 250; ++drop) {
    const cv::Point from(random.uniform(0, image.cols), random.uniform(0, image.rows));
    cv::line(image, from, from + cv::Point(2, 9), cv::Scalar(random.uniform(150, 230)));
  }
}

std::vector<Trouble> troubles() {
  return {
      {"exposure",
       [](int i, StereoFrame& frame) {
         const double gain = i % 4 < 2 ? 1.0 : 0.8;
         frame.left.convertTo(frame.left, CV_8U, gain);
         frame.right.convertTo(frame.right, CV_8U, gain);
       }},
      {"blur",
       [](int, StereoFrame& frame) {
         cv::blur(frame.left, frame.left, {5, 1});
         cv::blur(frame.right, frame.right, {5, 1});
       }},
      {"rain",
       [](int i, StereoFrame& frame) {
         rain(2 * i, frame.left);
         rain(2 * i + 1, frame.right);
       }},
      {"black",
       [](int i, StereoFrame& frame) {
         if (i == 8) frame.left.setTo(0);
       }},
      {"late", [](int, StereoFrame&) {}, 0.01},
  };
}

struct Outcome {
  std::set<TrackId> moving_tracks;  ///< confirmed ones found moving at some time
  DropCounts dropped;
  int lost = 0;
};

Outcome run(const PaintedStreet& street, const Trouble& trouble) {
  PerceptionParams params;
  params.detection.detector = "stereo_motion";
  Perception perception(street.camera(), params);
  Outcome outcome;
  for (int i = 0; i < kFrames; ++i) {
    RecordedFrame frame;
    frame.index = static_cast<std::size_t>(i);
    frame.time = street.timeOf(i);
    frame.stereo = street.frame(i, trouble.right_late_s);
    trouble.spoil(i, *frame.stereo);
    const auto update = perception.process(frame);
    outcome.lost += update.camera.status == slam::TrackingStatus::kLost ? 1 : 0;
    for (const auto& [reason, count] : update.objects.detections_dropped) {
      outcome.dropped[reason] += count;
    }
    for (const auto& track : update.objects.tracks) {
      if (track.status == TrackStatus::kConfirmed && track.moving) {
        outcome.moving_tracks.insert(track.id);
      }
    }
  }
  return outcome;
}

class InTrouble : public testing::TestWithParam<int> {};

TEST_P(InTrouble, aStillStreetStaysStill) {
  EXPECT_LE(run(PaintedStreet(kStillStreet), troubles()[GetParam()]).moving_tracks.size(), 1u);
}

TEST_P(InTrouble, oneMoverIsNotAFlood) {
  auto boxes = kStillStreet;
  boxes.push_back(kMover);
  EXPECT_LE(run(PaintedStreet(boxes), troubles()[GetParam()]).moving_tracks.size(), 2u);
}

INSTANTIATE_TEST_SUITE_P(Troubles, InTrouble, testing::Range(0, 5), [](const auto& index) {
  return std::string(troubles()[index.param].name);
});

TEST(TroubleTest, aBlackImageIsReportedAndThenItGoesOn) {
  const auto outcome = run(PaintedStreet(kStillStreet), troubles()[3]);
  EXPECT_EQ(1u, outcome.dropped.at("unusable_image"));
  EXPECT_LE(outcome.lost, 2);
}

}  // namespace
}  // namespace headway::pipeline
