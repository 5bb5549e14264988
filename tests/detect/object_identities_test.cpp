#include "object_identities.h"

#include <gtest/gtest.h>

namespace headway::detect {
namespace {

FoundObject walkerAt(double x, ObjectClass object_class = ObjectClass::kPedestrian) {
  FoundObject found;
  found.place = {x, 0.0, 10.0};
  found.velocity.value = {1.5, 0.0, 0.0};
  found.gate_m = 1.0;
  found.object_class = object_class;
  return found;
}

TEST(ObjectIdentitiesTest, WhatHasLostItsPartsIsKnownByItsPlace) {
  ObjectIdentities identities;
  std::int64_t first = -1;
  for (int frame = 0; frame < 5; ++frame) {
    identities.beginFrame(0.1 * frame);
    const auto& identity = identities.identify(walkerAt(0.15 * frame));
    if (frame == 0) first = identity.id;
    EXPECT_EQ(identity.id, first);
    EXPECT_EQ(identity.sightings, frame + 1);
  }
}

TEST(ObjectIdentitiesTest, PartsTellMoreThanPlace) {
  ObjectIdentities identities;
  identities.beginFrame(0.0);
  const auto a = identities.identify(walkerAt(0.0)).id;
  const auto b = identities.identify(walkerAt(3.0)).id;
  EXPECT_NE(a, b) << "farther apart than the gate";
  identities.beginFrame(0.1);
  auto found = walkerAt(0.2);
  found.hints = {b, a};
  EXPECT_EQ(identities.identify(found).id, b);
  EXPECT_EQ(identities.identify(found).id, a) << "no id is given twice in a frame";
  EXPECT_NE(identities.identify(walkerAt(0.2)).id, a);
}

TEST(ObjectIdentitiesTest, OnesThatAreGoneAreForgotten) {
  ObjectIdentities identities;
  identities.beginFrame(0.0);
  const auto id = identities.identify(walkerAt(0.0)).id;
  identities.beginFrame(0.9);
  EXPECT_TRUE(identities.isFree(id));
  identities.beginFrame(1.2);
  EXPECT_FALSE(identities.isFree(id));
  auto found = walkerAt(1.8);
  found.hints = {id};
  EXPECT_NE(identities.identify(found).id, id);
}

TEST(ObjectIdentitiesTest, WhatIsOnlyRecognisedIsForgottenAtLast) {
  ObjectIdentities identities;
  identities.beginFrame(0.0);
  const auto id = identities.identify(walkerAt(0.0)).id;
  for (int frame = 1; frame <= 12; ++frame) {
    identities.beginFrame(0.1 * frame);
    ASSERT_EQ(identities.isFree(id), frame <= 10) << "a second after it was seen to move";
    if (frame > 10) break;
    auto found = walkerAt(0.15 * frame);
    found.hints = {id};
    found.moved = false;
    EXPECT_EQ(identities.identify(found).id, id);
  }
}

TEST(ObjectIdentitiesTest, TellsWhoIsMissing) {
  ObjectIdentities identities;
  identities.beginFrame(0.0);
  const auto a = identities.identify(walkerAt(0.0)).id;
  const auto b = identities.identify(walkerAt(5.0)).id;
  EXPECT_TRUE(identities.missing().empty());
  identities.beginFrame(0.2);
  auto found = walkerAt(5.3);
  found.hints = {b};
  identities.identify(found);
  const auto missing = identities.missing();
  ASSERT_EQ(missing.size(), 1u);
  EXPECT_EQ(missing[0].id, a);
  EXPECT_NEAR(missing[0].expectedAt(0.2).x(), 0.3, 1e-9);
}

TEST(ObjectIdentitiesTest, TheClassGuessedMostOftenIsTheClass) {
  ObjectIdentities identities;
  ObjectClass last = ObjectClass::kUnknown;
  for (int frame = 0; frame < 5; ++frame) {
    identities.beginFrame(0.1 * frame);
    const auto guess = frame == 2 ? ObjectClass::kCar : ObjectClass::kPedestrian;
    last = identities.identify(walkerAt(0.15 * frame, guess)).objectClass();
  }
  EXPECT_EQ(last, ObjectClass::kPedestrian);
}

}  // namespace
}  // namespace headway::detect
