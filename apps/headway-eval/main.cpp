// SPDX-License-Identifier: BSD-3-Clause
#include <headway/program/command_line.h>

#include <functional>
#include <map>

#include "commands.h"

int main(int argc, char** argv) {
  using namespace headway;
  return program::run("headway-eval", [&] {
    const std::map<std::string, std::function<int(int, const char**)>> commands = {
        {"trajectory", app::runTrajectory},
        {"tracks", app::runTracks},
        {"predictions", app::runPredictions},
        {"movers", app::runMovers},
        {"grid", app::runGrid},
        {"dense", app::runDense},
        {"suite", app::runSuite}};
    const char** arguments = const_cast<const char**>(argv);
    const auto name = program::takeSubcommand(
        argc, arguments, "Computes errors of a replay's results against the truth.",
        {{"trajectory", "Errors of a trajectory against the true one"},
         {"tracks", "Errors of tracks against labels: positions, CLEAR MOT, HOTA, sAMOTA"},
         {"predictions", "Errors of predictions against the true future"},
         {"movers", "Recall and precision of moving objects, false moving tracks"},
         {"grid", "Errors of an occupancy grid against the simulated world"},
         {"dense", "Errors and coverage of a dense map against the simulated world"},
         {"suite", "Tables of all errors over simulated worlds"}});
    return commands.at(name)(argc, arguments);
  });
}
