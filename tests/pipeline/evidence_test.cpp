// SPDX-License-Identifier: BSD-3-Clause
#include "evidence.h"

#include <gtest/gtest.h>

namespace headway::pipeline {
namespace {

/// Observations that say so much until they decide.
int observationsUntilDecisive(double log_ratio) {
  Evidence evidence;
  int count = 0;
  while (!evidence.isDecisive() && count < 1000) {
    evidence.add(log_ratio);
    ++count;
  }
  return count;
}

TEST(EvidenceTest, ManyWeakObservationsDecideAsFewStrongOnes) {
  EXPECT_EQ(observationsUntilDecisive(Evidence::kDecisive), 1);
  EXPECT_EQ(observationsUntilDecisive(Evidence::kDecisive / 16.0), 16);
  EXPECT_EQ(observationsUntilDecisive(-1.0), 1000);
}

TEST(EvidenceTest, AFaultIsFoundAsSoonAfterALongGoodTime) {
  Evidence evidence;
  for (int i = 0; i < 1000; ++i) evidence.add(-10.0);
  EXPECT_FALSE(evidence.isSuspected());
  evidence.add(0.5 * Evidence::kDecisive);
  EXPECT_TRUE(evidence.isSuspected());
  EXPECT_FALSE(evidence.isDecisive());
  evidence.add(0.5 * Evidence::kDecisive);
  EXPECT_TRUE(evidence.isDecisive());
}

TEST(EvidenceTest, TheEndOfALongFaultIsFoundAsSoonAsThatOfAShortOne) {
  Evidence evidence;
  for (int i = 0; i < 1000; ++i) evidence.add(10.0);
  evidence.add(-0.3 * Evidence::kDecisive);
  EXPECT_TRUE(evidence.isDecisive()) << "by one observation of a thousand";
  evidence.add(-0.3 * Evidence::kDecisive);
  EXPECT_FALSE(evidence.isDecisive());
  evidence.add(-Evidence::kDecisive);
  EXPECT_FALSE(evidence.isSuspected());
}

}  // namespace
}  // namespace headway::pipeline
