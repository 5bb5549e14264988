// SPDX-License-Identifier: BSD-3-Clause
// How many of the people around a robot a replay finds, and what it takes for objects that is none.
#pragma once

#include <headway/core/stereo_camera.h>
#include <headway/core/track.h>
#include <headway/plot/text_table.h>

#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::eval {

/// Who counts as a person to be found, and which rows count as found or false.
struct PeopleErrorParams {
  double min_visible = 0.5;      ///< ratio of a person's pixels that nothing hides
  double min_range_m = 0.5;      ///< over the ground, between the camera and a person
  double max_range_m = 7.0;      ///< the promised reach
  double settle_s = 0.4;         ///< time in view after which a person counts
  double found_within_m = 0.5;   ///< distance of a row from the person it finds, over the ground
  double stay_s = 1.0;           ///< in view, of who must be found, and of who has just appeared
  double head_on_rad = 0.524;    ///< greatest angle between a walk and the way to the camera
  double crossing_rad = 1.047;   ///< least angle between a walk and the line to the camera
  double group_m = 1.2;          ///< greatest distance of those who walk together
  double turning_radps = 0.785;  ///< least rate of a robot that turns
  double false_beyond_m = 1.0;   ///< rows farther from the boxes of all true objects are false
};

/// A true object and how much of it is seen.
struct SeenObject {
  Track object;          ///< robot frame
  double visible = 1.0;  ///< ratio of its pixels in the image that nothing hides
};

/// One frame of a recording, with the robot's true and estimated frame laid upon each other.
struct PeopleFrame {
  Time time = 0.0;
  double turn_radps = 0.0;        ///< of the robot, left is positive
  std::vector<SeenObject> truth;  ///< people and whatever else can move, parked things included
  std::vector<Track> rows;        ///< of the tracker, robot frame
};

/// Person-frames: a person in a frame, who counts.
struct PersonFrames {
  std::size_t persons = 0;
  std::size_t found = 0;            ///< with a confirmed row of their own
  std::size_t found_as_person = 0;  ///< of these, the row says Pedestrian or Person_sitting

  [[nodiscard]] std::optional<double> foundRatio() const;   ///< of persons
  [[nodiscard]] std::optional<double> personRatio() const;  ///< found_as_person of found
  /// Wilson's 95 % interval of the found ratio; person-frames of one person are not independent,
  /// so that the true interval is wider.
  [[nodiscard]] std::optional<std::array<double, 2>> interval() const;
};

/// People found and false rows of one recording.
struct PeopleError {
  double max_range_m = 0.0;  ///< up to which people count
  std::size_t frames = 0;
  double duration_s = 0.0;
  PersonFrames all;
  std::map<std::string, PersonFrames> walking, standing;  ///< "0.5-1.5", "1.5-3", "3-7", "7-" [m]
  /// Of the walking ones: "head-on" (within 30 degrees of the way to the camera), "leaving",
  /// "crossing" (60 to 120), "in a group" (somebody else walks within 1.2 m), "from behind
  /// something" (hidden until a second ago), "robot turns" (faster than 45 degrees/s). Whoever is
  /// several of these counts in each.
  std::map<std::string, PersonFrames> ways;
  /// Time from coming into view within the reach to the first row, of each who stays for `stay_s`
  /// or has a row before; ascending, infinite if there is none [s].
  std::vector<double> first_rows_s;
  std::size_t rows = 0;               ///< confirmed
  std::size_t rows_without_pose = 0;  ///< of frames in which the camera was lost: they do not count
  std::size_t false_rows = 0;         ///< of these
  std::size_t person_rows = 0;        ///< confirmed, Pedestrian or Person_sitting
  std::size_t person_rows_right = 0;  ///< of these, not farther than false rows from a person
  std::size_t moving_tracks = 0;      ///< with confirmed moving rows
  std::vector<std::int64_t> false_moving_tracks;  ///< at least half of whose moving rows are false

  [[nodiscard]] std::optional<double> falseRatio() const;           ///< false_rows of rows
  [[nodiscard]] std::optional<double> personRowsRatio() const;      ///< right of person_rows
  [[nodiscard]] std::optional<double> falseTracksPer10Min() const;  ///< nullopt without duration
  [[nodiscard]] std::optional<double> withinASecondRatio() const;   ///< of first_rows_s
  [[nodiscard]] std::optional<double> medianFirstRow_s() const;     ///< of first_rows_s
};

/// Compares the confirmed rows of a tracker with the people of a simulated world.
///
/// A person counts in a frame if at least half of him is seen, his centre is in the image, he is
/// between the least range and the reach, and he has been in view for a while. He is found if a
/// confirmed row of class Pedestrian, Person_sitting or Unknown is near him, one row for one person
/// at minimum distance. Walking is who moves in that frame.
///
/// @param frames  ascending times
[[nodiscard]] PeopleError peopleError(const std::vector<PeopleFrame>& frames,
                                      const StereoCamera& camera, const PeopleErrorParams& params);

/// Evaluates a replay as `headway-eval people` does: frames that were lost have no rows.
///
/// @param truth    folder written by headway-sim
/// @param replay   output folder of headway-replay
/// @param reach_m  up to which people count; 0: `people_to_m` of the rig in replay.json
/// @throws InputError naming the file that cannot be read or does not match the others
[[nodiscard]] PeopleError evaluatePeople(const std::filesystem::path& truth,
                                         const std::filesystem::path& replay, double reach_m);

/// The figures of `headway-eval people --json`.
[[nodiscard]] nlohmann::ordered_json toJson(const PeopleError& error);
/// One row for each range of the walking and the standing people, for each way of walking, and for
/// all.
[[nodiscard]] plot::TextTable tableOf(const PeopleError& error);

}  // namespace headway::eval
