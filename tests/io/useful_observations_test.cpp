// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/obs/CObservation2DRangeScan.h>
#include <mrpt/obs/CObservationOdometry.h>

#include "foreign_recording.h"
#include "observation_selection.h"
#include "synthetic_recording.h"

namespace headway::io {
namespace {

using mrpt::obs::CObservation;
using ::testing::ElementsAre;
using ::testing::Pair;

/// A recording that ends, or breaks off, after some observations.
class Recording : public ObservationReader {
 public:
  explicit Recording(std::vector<CObservation::Ptr> observations,
                     std::optional<std::string> truncation = {})
      : observations_(std::move(observations)), truncation_(std::move(truncation)) {}
  CObservation::Ptr next() override {
    return read_ < observations_.size() ? observations_[read_++] : nullptr;
  }
  [[nodiscard]] const std::optional<std::string>& truncation() const override {
    return truncation_;
  }
  [[nodiscard]] double progress() const override {
    return static_cast<double>(read_) / static_cast<double>(observations_.size());
  }

 private:
  std::vector<CObservation::Ptr> observations_;
  std::optional<std::string> truncation_;
  std::size_t read_ = 0;
};

template <typename Kind>
CObservation::Ptr observed(int i, const std::string& label) {
  auto observation = Kind::Create();
  observation->timestamp = mrptTime(test::frameTime(static_cast<std::size_t>(i)));
  observation->sensorLabel = label;
  return observation;
}

CObservation::Ptr odometry(int i) {
  return observed<mrpt::obs::CObservationOdometry>(i, "odometry");
}

CObservation::Ptr image(int i) { return test::wallObservation(i, test::frameTime(i)); }

class UsefulObservationsTest : public ::testing::Test {
 protected:
  UsefulObservations opened(std::vector<CObservation::Ptr> observations,
                            const RawlogSourceOptions& options = {},
                            std::optional<std::string> truncation = {}) {
    return {std::make_unique<Recording>(std::move(observations), std::move(truncation)), options,
            skipped};
  }

  std::map<std::string, std::size_t> skipped;
};

std::vector<CObservation::Ptr> rest(UsefulObservations& observations) {
  std::vector<CObservation::Ptr> all;
  while (auto observation = observations.next()) all.push_back(observation);
  return all;
}

TEST_F(UsefulObservationsTest, CountsUnusedObservationsByReason) {
  auto truth = image(0);
  truth->sensorLabel = "truth_something";
  auto undated = image(0);
  undated->timestamp = INVALID_TIMESTAMP;
  const auto useful = image(1);
  RawlogSourceOptions options;
  options.use_odometry = false;
  auto observations =
      opened({truth, undated, observed<mrpt::obs::CObservation2DRangeScan>(0, "laser"), odometry(0),
              useful},
             options);
  EXPECT_THAT(rest(observations), ElementsAre(useful));
  EXPECT_THAT(skipped,
              ElementsAre(Pair("CObservation2DRangeScan", 1u), Pair("CObservationOdometry", 1u),
                          Pair("no_time", 1u), Pair("truth", 1u)));
}

TEST_F(UsefulObservationsTest, ReturnsTheObservationsReadToFindTheCamera) {
  const std::vector<CObservation::Ptr> recorded{odometry(0), image(0), odometry(1), image(1),
                                                image(2)};
  auto observations = opened(recorded);
  const CameraChoice camera = observations.findCamera();
  EXPECT_EQ(CameraChoice::Kind::kStereo, camera.kind);
  EXPECT_EQ("stereo", camera.labels[0]);
  EXPECT_EQ(0.8, observations.progress()) << "two images of one camera tell";
  EXPECT_EQ(recorded, rest(observations));
  EXPECT_TRUE(skipped.empty());
}

TEST_F(UsefulObservationsTest, KeepsTheLatestImagesAndMotionsUntilTheCameraIsKnown) {
  std::vector<CObservation::Ptr> recorded;
  for (int i = 0; i < 2005; ++i) recorded.push_back(odometry(i));
  for (int i = 0; i < 20; ++i) recorded.push_back(test::singleImage(0, 0, 3000.0 + i, "left"));
  for (int i = 0; i < 2; ++i) recorded.push_back(test::singleImage(1, 0, 3030.0 + i, "right"));
  auto observations = opened(recorded);
  EXPECT_EQ(CameraChoice::Kind::kPair, observations.findCamera().kind);
  EXPECT_THAT(skipped,
              ElementsAre(Pair("CObservationImage", 6u), Pair("CObservationOdometry", 5u)));
  const auto kept = rest(observations);
  ASSERT_EQ(2016u, kept.size());
  EXPECT_EQ(recorded[5], kept.front());
  EXPECT_EQ(recorded.back(), kept.back());
}

TEST_F(UsefulObservationsTest, ReportsATruncationWithoutACamera) {
  auto whole = opened({odometry(0)});
  const auto error = test::errorOf([&] { (void)whole.findCamera(); });
  EXPECT_THAT(error, ::testing::StartsWith("contains neither stereo images nor poses"));
  auto broken = opened({odometry(0)}, {}, "ends within an object");
  EXPECT_EQ(error + "; ends within an object", test::errorOf([&] { (void)broken.findCamera(); }));
}

}  // namespace
}  // namespace headway::io
