// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/pose.h>

#include <random>

#include "track_evidence.h"

namespace headway::objects {
namespace {

TEST(HeadingEvidenceTest, BringsAFlippedMeasurementBack) {
  HeadingEvidence evidence{HeadingParams()};
  EXPECT_NEAR(evidence.unflipped(0.1, 0.0), 0.1, 1e-12);
  EXPECT_NEAR(wrapAngle(evidence.unflipped(wrapAngle(0.1 + M_PI), 0.0)), 0.1, 1e-12);
}

TEST(HeadingEvidenceTest, IsNotTurnedByScatteredFlips) {
  std::mt19937 random(1);
  std::bernoulli_distribution flipped(0.2);
  HeadingEvidence evidence{HeadingParams()};
  for (int k = 0; k < 10000; ++k) {
    (void)evidence.unflipped(flipped(random) ? M_PI : 0.0, 0.0);
    ASSERT_FALSE(evidence.turnsRound()) << "frame " << k;
  }
}

TEST(HeadingEvidenceTest, IsNotTurnedByFiveFlipsInARow) {
  HeadingEvidence evidence{HeadingParams()};
  for (int k = 0; k < 10; ++k) (void)evidence.unflipped(0.0, 0.0);
  for (int k = 0; k < 5; ++k) {
    (void)evidence.unflipped(M_PI, 0.0);
    EXPECT_FALSE(evidence.turnsRound());
  }
}

TEST(HeadingEvidenceTest, RecoversFromAWrongFirstHeading) {
  HeadingEvidence evidence{HeadingParams()};
  int frames = 0;
  while (!evidence.turnsRound() && frames < 100) {
    (void)evidence.unflipped(M_PI, 0.0);
    ++frames;
  }
  EXPECT_LT(frames, 8);
  (void)evidence.unflipped(M_PI, M_PI);
  EXPECT_FALSE(evidence.turnsRound()) << "the evidence now speaks for the new heading";
}

TEST(HeadingEvidenceTest, ListensToTheDirectionOfMotion) {
  HeadingEvidence evidence{HeadingParams()};
  for (int k = 0; k < 4; ++k) evidence.addMotion(0.2);  // sideways motion is no evidence
  EXPECT_FALSE(evidence.turnsRound());
  for (int k = 0; k < 4; ++k) evidence.addMotion(-0.99);
  EXPECT_TRUE(evidence.turnsRound());
}

}  // namespace
}  // namespace headway::objects
