// SPDX-License-Identifier: BSD-3-Clause
// The report of a finished replay with its errors against the truth.
#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/truth_report.h>
#include <headway/report/report.h>

#include <utility>
#ifdef HEADWAY_WITH_EVAL
#include <headway/eval/grid_error.h>
#include <headway/eval/people_error.h>
#include <headway/eval/trajectory_error.h>
#include <headway/plot/text_table.h>
#endif

namespace headway::program {
namespace {

#ifdef HEADWAY_WITH_EVAL

/// Errors of the final trajectory after rigid alignment.
///
/// @throws InputError if there are too few poses of equal times
std::vector<report::Figure> errorsOf(const std::filesystem::path& replay,
                                     const std::filesystem::path& truth) {
  const auto error =
      eval::trajectoryError(eval::pairByTime(io::readTum(truth / "trajectory.tum"),
                                             io::readTum(replay / "trajectory.tum"), kSameTime_s),
                            {});
  return {
      {"Frames compared", std::to_string(error.frames_matched), "with a true pose of their time"},
      {"True path", plot::fixedText(error.path_m, 1) + " m"},
      {"Absolute trajectory error, RMSE", plot::fixedText(error.ate_m.rmse, 3) + " m",
       "of the final path, laid upon the true one"},
      {"Absolute trajectory error, median", plot::fixedText(error.ate_m.median, 3) + " m"},
      {"Absolute trajectory error, maximum", plot::fixedText(error.ate_m.max, 3) + " m"},
      {"Relative pose error per frame", plot::fixedText(error.rpe_trans_rmse_m, 4) + " m, " +
                                            plot::fixedText(error.rpe_rot_rmse_deg, 4) + " deg"}};
}

/// People found and false rows; empty if nobody counts.
std::vector<report::Figure> peopleFigures(const std::filesystem::path& replay,
                                          const std::filesystem::path& truth) {
  const eval::PeopleError people = eval::evaluatePeople(truth, replay, 0.0);
  if (people.all.persons == 0) return {};
  const auto percent = [](const std::optional<double>& ratio) {
    return plot::percentText(ratio, 0) + " %";
  };
  return {
      {"People found", percent(people.all.foundRatio()),
       "of " + std::to_string(people.all.persons) +
           " person-frames: a person in a frame, half "
           "seen or more, within the " +
           plot::fixedText(people.max_range_m, 1) + " m of this rig"},
      {"False rows", percent(people.falseRatio()),
       "of " + std::to_string(people.rows) + " rows of tracks: without a true object within 1 m"},
      {"False moving tracks", std::to_string(people.false_moving_tracks.size()),
       "of " + std::to_string(people.moving_tracks) +
           ": at least half of their moving rows are false"}};
}

/// Recall and precision of the grid.
std::vector<report::Figure> gridFigures(const std::filesystem::path& replay,
                                        const std::filesystem::path& truth) {
  const eval::GridEvaluation grid = eval::evaluateGrid(truth, replay, {0.0, 0.0});
  return {{"Obstacles in the grid", plot::percentText(grid.in_reach.foundRatio(), 0) + " %",
           "of " + std::to_string(grid.in_reach.judged) +
               " truly occupied cells that were seen within the rig's reach"},
          {"Right obstacles", plot::percentText(grid.precision.touchRatio(), 0) + " %",
           "of " + std::to_string(grid.precision.called) +
               " cells called occupied are or touch a true obstacle"}};
}

#else

std::vector<report::Figure> errorsOf(const std::filesystem::path&, const std::filesystem::path&) {
  throw InputError("headway was built without evaluation (HEADWAY_BUILD_EVAL=OFF)");
}

std::vector<report::Figure> peopleFigures(const std::filesystem::path&,
                                          const std::filesystem::path&) {
  return {};
}

std::vector<report::Figure> gridFigures(const std::filesystem::path&,
                                        const std::filesystem::path&) {
  return {};
}

#endif

}  // namespace

void writeTruthReport(const std::filesystem::path& replay, const std::filesystem::path& truth,
                      const std::filesystem::path& output, const std::string& title,
                      const std::function<void(const std::string&)>& note) {
  report::ReportOptions page;
  page.output = output;
  page.title = title;
  page.truth = truth;
  if (!truth.empty()) {
    std::string noted;  // several read the same files
    const auto add = [&](bool has_truth, auto figures) {
      try {
        if (!has_truth) return;
        for (auto& figure : figures(replay, truth)) page.errors.push_back(std::move(figure));
      } catch (const InputError& error) {
        if (std::exchange(noted, error.what()) != error.what()) {
          note("no errors computed: " + noted);
        }
      }
    };
    add(true, errorsOf);
    add(std::filesystem::exists(truth / "objects.csv"), peopleFigures);
    add(std::filesystem::exists(truth / "depth"), gridFigures);
  }
  report::writeReport(replay, page);
}

}  // namespace headway::program
