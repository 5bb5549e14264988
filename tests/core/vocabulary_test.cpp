// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/ids.h>
#include <headway/core/object_class.h>
#include <headway/core/track.h>

#include <set>
#include <unordered_set>

namespace headway {
namespace {

std::vector<ObjectClass> allClasses() {
  std::vector<ObjectClass> classes;
  for (int i = 0; i < kObjectClassCount; ++i) classes.push_back(static_cast<ObjectClass>(i));
  return classes;
}

TEST(StrongIdTest, IsInvalidUntilGiven) {
  EXPECT_FALSE(TrackId{}.valid());
  EXPECT_TRUE(TrackId{0}.valid());
}

TEST(StrongIdTest, ComparesByValue) {
  EXPECT_EQ(LandmarkId{3}, LandmarkId{3});
  EXPECT_NE(LandmarkId{3}, LandmarkId{4});
  EXPECT_LT(LandmarkId{3}, LandmarkId{4});
  EXPECT_FALSE(LandmarkId{3} < LandmarkId{3});
}

TEST(StrongIdTest, OfDifferentThingsDoNotConvert) {
  EXPECT_FALSE((std::is_convertible_v<TrackId, LandmarkId>));
  EXPECT_FALSE((std::is_convertible_v<TrackId, std::int64_t>));
}

TEST(StrongIdTest, IsAKeyOfOrderedAndHashedContainers) {
  const std::vector<KeyframeId> ids{{2}, {0}, {1}, {2}};
  const std::set<KeyframeId> ordered(ids.begin(), ids.end());
  EXPECT_THAT(ordered, ::testing::ElementsAre(KeyframeId{0}, KeyframeId{1}, KeyframeId{2}));
  const std::unordered_set<KeyframeId> hashed(ids.begin(), ids.end());
  EXPECT_EQ(3u, hashed.size());
}

TEST(ObjectClassTest, NamesAreInverseToTheirParser) {
  std::set<std::string_view> names;
  for (const ObjectClass object_class : allClasses()) {
    const auto name = toString(object_class);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(object_class, objectClassFrom(name)) << name;
  }
}

TEST(ObjectClassTest, OtherWordsAreNoClass) {
  for (const char* word : {"", "car", "DontCare", "Person sitting", "Cars"}) {
    EXPECT_EQ(std::nullopt, objectClassFrom(word)) << word;
  }
}

TEST(ObjectClassTest, PeopleReadNamesWithoutUnderscores) {
  EXPECT_EQ("Car", displayName(ObjectClass::kCar));
  std::set<std::string_view> names;
  for (const ObjectClass object_class : allClasses()) {
    const auto name = displayName(object_class);
    EXPECT_TRUE(names.insert(name).second) << name;
    EXPECT_EQ(std::string_view::npos, name.find('_')) << name;
  }
}

TEST(ObjectClassTest, VehiclesAreCarsVansTrucksAndTrams) {
  std::vector<ObjectClass> vehicles;
  for (const ObjectClass object_class : allClasses()) {
    if (isVehicle(object_class)) vehicles.push_back(object_class);
  }
  EXPECT_THAT(vehicles, ::testing::ElementsAre(ObjectClass::kCar, ObjectClass::kVan,
                                               ObjectClass::kTruck, ObjectClass::kTram));
}

TEST(ClassColourTest, DiffersBetweenClassesAndFromPredictions) {
  std::set<std::array<std::uint8_t, 3>> colours{
      {kPredictionColour.red, kPredictionColour.green, kPredictionColour.blue}};
  for (const ObjectClass object_class : allClasses()) {
    const Colour colour = colourOf(object_class);
    EXPECT_TRUE(colours.insert({colour.red, colour.green, colour.blue}).second)
        << toString(object_class);
  }
}

TEST(TrackStatusTest, HasTheNamesOfTheTrackFiles) {
  EXPECT_EQ("tentative", toString(TrackStatus::kTentative));
  EXPECT_EQ("confirmed", toString(TrackStatus::kConfirmed));
  EXPECT_EQ("coasting", toString(TrackStatus::kCoasting));
  EXPECT_EQ("ended", toString(TrackStatus::kEnded));
}

TEST(TrackTest, IsShownWhileConfirmedOrCoasting) {
  Track track;
  const auto shown = [&track](TrackStatus status) {
    track.status = status;
    return isShown(track);
  };
  EXPECT_FALSE(shown(TrackStatus::kTentative));
  EXPECT_TRUE(shown(TrackStatus::kConfirmed));
  EXPECT_TRUE(shown(TrackStatus::kCoasting));
  EXPECT_FALSE(shown(TrackStatus::kEnded));
}

}  // namespace
}  // namespace headway
