// SPDX-License-Identifier: BSD-3-Clause
// headway-eval people: the people of a simulated world that a replay finds, and false rows.
#include <headway/eval/people_error.h>
#include <headway/eval/plots.h>
#include <headway/plot/text_table.h>

#include <iostream>
#include <nlohmann/json.hpp>

#include "commands.h"

namespace headway::app {
namespace {

void report(const eval::PeopleError& error) {
  plot::writeTable(std::cout, tableOf(error));
  std::cout << "\n"
            << error.rows << " confirmed rows in " << error.frames << " frames, "
            << error.false_rows << " false (" << plot::percentText(error.falseRatio(), 1) << " %)\n"
            << error.person_rows << " rows say person, " << error.person_rows_right << " right ("
            << plot::percentText(error.personRowsRatio(), 1) << " %)\n"
            << error.moving_tracks << " moving tracks, " << error.false_moving_tracks.size()
            << " false (" << plot::fixedText(error.falseTracksPer10Min(), 1) << " in 10 min)\n";
}

}  // namespace

int runPeople(int argc, const char** argv) {
  std::string replay, truth;
  double reach_m = 0.0;  // that of the replay's rig
  Outputs outputs;
  program::CommandLine line("headway-eval people",
                            "Counts the people of a simulated world that a replay finds, by "
                            "distance, walking and standing, and its false rows.");
  line.positional(replay, "REPLAY", "Output folder of headway-replay");
  line.option(truth, 0, "truth", "NAME.truth", "Truth folder written by headway-sim", true);
  line.option(reach_m, 0, "reach", "M",
              "Distance up to which people count [m]; default: that of the replay's rig");
  if (!outputs.parse(line, argc, argv, {&truth, &replay})) return program::kDone;
  const auto error = eval::evaluatePeople(truth, replay, reach_m);
  if (!outputs.quiet()) report(error);
  outputs.write([&] { return toJson(error); }, [&] { return eval::peoplePlot(error); });
  return program::kDone;
}

}  // namespace headway::app
