// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/eval/people_error.h>
#include <headway/eval/plots.h>

#include <nlohmann/json.hpp>

namespace headway::eval {
namespace {

/// 90 degrees wide, 0.5 m above the robot's origin, looking forward.
StereoCamera forwardCamera() {
  StereoCamera camera;
  camera.width = 640;
  camera.height = 480;
  camera.fx = camera.fy = 320.0;
  camera.cx = 319.5;
  camera.cy = 239.5;
  camera.T_robot_cam = robotFromOptical();
  camera.T_robot_cam.translation() = Eigen::Vector3d(0.0, 0.0, 0.5);
  return camera;
}

Track boxAt(std::int64_t id, ObjectClass object_class, double x, double y, bool moving) {
  Track track;
  track.id = TrackId{id};
  track.object_class = object_class;
  track.status = TrackStatus::kConfirmed;
  track.motion_state = moving ? MotionState::kMoving : MotionState::kStatic;
  track.position = {x, y, 0.5};
  track.size = {0.6, 0.6, 1.7};
  return track;
}

constexpr auto kPerson = ObjectClass::kPedestrian;
constexpr auto kSitting = ObjectClass::kPersonSitting;

PeopleError peopleErrorOf(const std::vector<PeopleFrame>& frames) {
  return peopleError(frames, forwardCamera(), {});
}

/// Two seconds at 10 Hz: somebody walks 2 m away, somebody sits 1 m away and is half seen from the
/// second second on, somebody is behind the robot and somebody 9 m away; a car is parked.
std::vector<PeopleFrame> twoSeconds() {
  std::vector<PeopleFrame> frames;
  for (int k = 0; k < 20; ++k) {
    PeopleFrame frame;
    frame.time = 0.1 * k;
    frame.truth = {{boxAt(1, kPerson, 2.0, 0.5, true), 1.0},
                   {boxAt(2, kSitting, 1.0, -0.3, false), k < 10 ? 0.4 : 0.6},
                   {boxAt(3, kPerson, -2.0, 0.0, true), 1.0},
                   {boxAt(4, kPerson, 9.0, 0.0, true), 1.0},
                   {boxAt(5, ObjectClass::kCar, 4.0, -3.0, false), 1.0}};
    if (k % 2 == 0) {
      frame.rows.push_back(boxAt(11, k < 10 ? kPerson : ObjectClass::kUnknown, 2.3, 0.5, true));
    }
    if (k >= 14) frame.rows.push_back(boxAt(12, kSitting, 1.0, -0.2, false));
    if (k < 10) frame.rows.push_back(boxAt(13, kPerson, 5.0, 3.0, true));  // nobody is there
    frame.rows.push_back(boxAt(15, ObjectClass::kCar, 4.5, -3.0, false));
    frame.rows.push_back(boxAt(16, kPerson, 6.0, 3.0, true));
    frame.rows.back().status = TrackStatus::kCoasting;
    frames.push_back(frame);
  }
  return frames;
}

/// Somebody walks at 1 m/s in a direction for two seconds and is found from a time on.
std::vector<PeopleFrame> walk(double direction_rad, double found_from_s) {
  std::vector<PeopleFrame> frames;
  const Eigen::Vector3d velocity(std::cos(direction_rad), std::sin(direction_rad), 0.0);
  for (int k = 0; k < 20; ++k) {
    PeopleFrame& frame = frames.emplace_back();
    frame.time = 0.1 * k;
    Track person = boxAt(1, kPerson, 4.0, 0.0, true);
    person.position += (frame.time - 1.0) * velocity;
    person.velocity = velocity;
    frame.truth = {{person, 1.0}};
    if (frame.time > found_from_s - 0.01) {
      person.id = TrackId{11};
      frame.rows = {person};
    }
  }
  return frames;
}

TEST(PeopleErrorTest, TellsApartFromWhereTheyWalk) {
  for (const auto& [direction_rad, way] :
       {std::pair{M_PI, "head-on"}, {0.0, "leaving"}, {0.5 * M_PI, "crossing"}}) {
    const auto error = peopleErrorOf(walk(direction_rad, 1.0));
    ASSERT_EQ(error.ways.count(way), 1u) << way;
    EXPECT_EQ(error.ways.at(way).persons, 16u) << way;
    EXPECT_EQ(error.ways.at(way).found, 10u) << way;
    for (const auto& [other, cell] : error.ways) {
      if (other != way) {
        EXPECT_LT(cell.persons, 4u) << other << " of who is " << way;
      }
    }
  }
  EXPECT_TRUE(peopleErrorOf(walk(0.25 * M_PI, 1.0)).ways.empty());
}

TEST(PeopleErrorTest, TellsApartGroupsWhoAppearsAndARobotThatTurns) {
  auto frames = walk(0.25 * M_PI, 0.0);
  for (PeopleFrame& frame : frames) {
    Track other = frame.truth.front().object;
    other.id = TrackId{2};
    other.position.y() += 0.8;
    if (frame.time < 0.75) frame.truth.push_back({other, 1.0});
    frame.turn_radps = frame.time > 1.45 ? -1.5 : 0.5;
  }
  auto error = peopleErrorOf(frames);
  EXPECT_EQ(error.ways.at("in a group").persons, 8u) << "two, from 0.4 to 0.7 s";
  EXPECT_EQ(error.ways.at("robot turns").persons, 5u);
  EXPECT_EQ(error.ways.count("from behind something"), 0u) << "they were there from the start";
  for (PeopleFrame& frame : frames) {
    if (frame.time < 0.45) frame.truth.front().visible = 0.2;
  }
  error = peopleErrorOf(frames);
  EXPECT_EQ(error.ways.at("from behind something").persons, 6u) << "from 0.9 to 1.4 s";
}

TEST(PeopleErrorTest, StatesHowLongWhoComesIntoViewHasNoRow) {
  const auto late = peopleErrorOf(walk(0.0, 0.7));
  ASSERT_EQ(late.first_rows_s.size(), 1u);
  EXPECT_NEAR(late.medianFirstRow_s().value(), 0.7, 1e-9);
  EXPECT_DOUBLE_EQ(late.withinASecondRatio().value(), 1.0);
  PeopleError rounded;
  rounded.first_rows_s = {1.0 + 2e-7};  // of seconds since 1970
  EXPECT_DOUBLE_EQ(rounded.withinASecondRatio().value(), 1.0);
  const auto too_late = peopleErrorOf(walk(0.0, 1.5));
  EXPECT_NEAR(too_late.medianFirstRow_s().value(), 1.5, 1e-9);
  EXPECT_DOUBLE_EQ(too_late.withinASecondRatio().value(), 0.0);
  const auto never = peopleErrorOf(walk(0.0, 3.0));
  EXPECT_EQ(never.first_rows_s.size(), 1u);
  EXPECT_FALSE(never.medianFirstRow_s().has_value());
  EXPECT_TRUE(toJson(never)["first_rows_s"][0].is_null());

  auto comes_back = walk(0.0, 0.0);  // out of view for 0.7 s, then found after 0.3 s
  for (PeopleFrame& frame : comes_back) {
    if (frame.time > 0.75 && frame.time < 1.45) frame.truth.front().visible = 0.1;
    if (frame.time > 0.75 && frame.time < 1.75) frame.rows.clear();
  }
  const auto twice = peopleErrorOf(comes_back).first_rows_s;
  ASSERT_EQ(twice.size(), 2u);
  EXPECT_NEAR(twice[0], 0.0, 1e-9);
  EXPECT_NEAR(twice[1], 0.3, 1e-9);

  auto short_look = walk(0.0, 3.0);
  short_look.resize(8);
  EXPECT_TRUE(peopleErrorOf(short_look).first_rows_s.empty()) << "in view for 0.7 s alone";
}

TEST(PeopleErrorTest, CountsPersonFramesFromWhenTheyHaveBeenInViewForAWhile) {
  const auto error = peopleErrorOf(twoSeconds());
  EXPECT_EQ(error.frames, 20u);
  ASSERT_EQ(error.walking.size(), 1u) << "behind the robot and beyond the reach nobody counts";
  const auto& walking = error.walking.at("1.5-3");
  EXPECT_EQ(walking.persons, 16u) << "from 0.4 s on";
  EXPECT_EQ(walking.found, 8u);
  EXPECT_EQ(walking.found_as_person, 3u);
  EXPECT_DOUBLE_EQ(walking.foundRatio().value(), 0.5);
  EXPECT_DOUBLE_EQ(walking.personRatio().value(), 3.0 / 8.0);
  const auto& standing = error.standing.at("0.5-1.5");
  EXPECT_EQ(standing.persons, 6u) << "seen by half from 1.0 s on";
  EXPECT_EQ(standing.found, 6u);
  EXPECT_EQ(error.all.persons, 22u);
  EXPECT_EQ(error.all.found, 14u);
}

TEST(PeopleErrorTest, CountsFalseRowsOfAnyClassAndFalseMovingTracks) {
  const auto error = peopleErrorOf(twoSeconds());
  EXPECT_EQ(error.rows, 10u + 6u + 10u + 20u) << "without coasting ones";
  EXPECT_EQ(error.false_rows, 10u);
  EXPECT_EQ(error.person_rows, 5u + 6u + 10u);
  EXPECT_EQ(error.person_rows_right, 11u);
  EXPECT_EQ(error.moving_tracks, 2u);
  EXPECT_EQ(error.false_moving_tracks, std::vector<std::int64_t>{13});
  EXPECT_DOUBLE_EQ(error.falseRatio().value(), 10.0 / 46.0);
  EXPECT_NEAR(error.falseTracksPer10Min().value(), 600.0 / 1.9, 1e-6);
}

TEST(PeopleErrorTest, GivesWilsonsInterval) {
  const auto interval = peopleErrorOf(twoSeconds()).walking.at("1.5-3").interval();
  ASSERT_TRUE(interval);
  EXPECT_NEAR((*interval)[0], 0.2800, 1e-4);  // of 8 in 16, R: prop.test(8, 16, correct = FALSE)
  EXPECT_NEAR((*interval)[1], 0.7200, 1e-4);
  const PersonFrames none{10, 0, 0};
  EXPECT_DOUBLE_EQ((*none.interval())[0], 0.0);
  EXPECT_NEAR((*none.interval())[1], 0.2775, 1e-4);
  EXPECT_FALSE(PersonFrames{}.interval());
}

TEST(PeopleErrorTest, GivesOneRowToOnePerson) {
  auto frames = twoSeconds();
  for (auto& frame : frames) {
    frame.truth = {{boxAt(1, kPerson, 2.0, 0.0, true), 1.0},
                   {boxAt(2, kPerson, 2.0, 0.4, true), 1.0}};
    frame.rows = {boxAt(11, kPerson, 2.0, 0.1, true)};
  }
  const auto error = peopleErrorOf(frames);
  EXPECT_EQ(error.all.persons, 32u);
  EXPECT_EQ(error.all.found, 16u);
  for (auto& frame : frames) frame.rows[0].object_class = ObjectClass::kCyclist;
  EXPECT_EQ(peopleErrorOf(frames).all.found, 0u) << "a cyclist is no person";
}

TEST(PeopleErrorTest, TakesAPersonForNewWhoWasOutOfViewForLong) {
  const auto framesWithout = [](int first, int end) {
    auto frames = twoSeconds();
    for (int k = first; k < end; ++k) {
      frames[static_cast<std::size_t>(k)].truth[0].visible = 0.0;
    }
    return peopleErrorOf(frames).walking.at("1.5-3").persons;
  };
  EXPECT_EQ(framesWithout(8, 11), 13u) << "hidden for 0.4 s from view to view: the same view";
  EXPECT_EQ(framesWithout(8, 14), 4u + 2u) << "for longer: in view anew from 1.4 s on";
}

TEST(PeopleErrorTest, IsUndefinedWithoutPeopleAndRows) {
  const auto error = peopleErrorOf({});
  EXPECT_FALSE(error.all.foundRatio());
  EXPECT_FALSE(error.falseRatio());
  EXPECT_FALSE(error.falseTracksPer10Min());
  EXPECT_EQ(tableOf(error).size(), 2u);
  EXPECT_GT(peoplePlot(peopleErrorOf(twoSeconds())).rows, 0);
}

}  // namespace
}  // namespace headway::eval
