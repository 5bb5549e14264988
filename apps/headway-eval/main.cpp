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
        {"suite", app::runSuite}};
    std::vector<std::string> names;
    for (const auto& [name, command] : commands) names.push_back(name);
    const char** arguments = const_cast<const char**>(argv);
    const auto name = program::takeSubcommand(argc, arguments, names);
    return commands.at(name)(argc, arguments);
  });
}
