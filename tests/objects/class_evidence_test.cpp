// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "track_evidence.h"

namespace headway::objects {
namespace {

using C = ObjectClass;

MeasuredBox byMotion(C object_class) {
  MeasuredBox box;
  box.object_class = object_class;
  box.evidence.motion = true;
  return box;
}

MeasuredBox byClassifier(C object_class) {
  MeasuredBox box;
  box.object_class = object_class;
  box.evidence.classifier = true;
  return box;
}

TEST(ClassEvidenceTest, AFindByGeometryIsUnknownUntilThreeVotesAgree) {
  ClassEvidence evidence(byMotion(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kUnknown);
  EXPECT_EQ(evidence.assumed(), C::kPedestrian);
  evidence.add(byMotion(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kUnknown);
  evidence.add(byMotion(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kPedestrian);
}

TEST(ClassEvidenceTest, ContraryVotesDelayIt) {
  ClassEvidence evidence(byMotion(C::kCar));
  evidence.add(byMotion(C::kCyclist));
  for (int i = 0; i < 2; ++i) evidence.add(byMotion(C::kCar));
  EXPECT_EQ(evidence.known(), C::kUnknown) << "three votes to one";
  evidence.add(byMotion(C::kCar));
  EXPECT_EQ(evidence.known(), C::kCar);
}

TEST(ClassEvidenceTest, VehiclesVoteTogether) {
  ClassEvidence evidence(byMotion(C::kVan));
  evidence.add(byMotion(C::kCar));
  EXPECT_EQ(evidence.known(), C::kUnknown);
  evidence.add(byMotion(C::kVan));
  EXPECT_EQ(evidence.known(), C::kVan);
}

TEST(ClassEvidenceTest, StaysKnown) {
  ClassEvidence evidence(byMotion(C::kCar));
  for (int i = 0; i < 2; ++i) evidence.add(byMotion(C::kCar));
  for (int i = 0; i < 2; ++i) evidence.add(byMotion(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kCar);
  for (int i = 0; i < 2; ++i) evidence.add(byMotion(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kPedestrian) << "of most votes";
}

TEST(ClassEvidenceTest, AClassifierOrARecordedBoxIsKnownAtOnce) {
  EXPECT_EQ(ClassEvidence(byClassifier(C::kCyclist)).known(), C::kCyclist);
  MeasuredBox recorded;
  recorded.object_class = C::kTruck;
  EXPECT_EQ(ClassEvidence(recorded).known(), C::kTruck);
  ClassEvidence evidence(byMotion(C::kPedestrian));
  evidence.add(byClassifier(C::kPedestrian));
  EXPECT_EQ(evidence.known(), C::kPedestrian);
}

TEST(ClassEvidenceTest, AMatchOfTheTemplateDoesNotVote) {
  MeasuredBox again = byMotion(C::kPedestrian);
  again.evidence = {};
  again.evidence.appearance = true;
  ClassEvidence evidence(byMotion(C::kPedestrian));
  for (int i = 0; i < 5; ++i) evidence.add(again);
  EXPECT_EQ(evidence.known(), C::kUnknown);
}

TEST(ClassEvidenceTest, WithoutClassesItStaysUnknown) {
  ClassEvidence evidence(byMotion(C::kUnknown));
  for (int i = 0; i < 5; ++i) evidence.add(byMotion(C::kUnknown));
  EXPECT_EQ(evidence.known(), C::kUnknown);
}

}  // namespace
}  // namespace headway::objects
