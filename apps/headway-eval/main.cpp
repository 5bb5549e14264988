// SPDX-License-Identifier: BSD-3-Clause
// headway-eval: errors of results against the truth.
#include <headway/core/output_file.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "commands.h"

namespace headway::app {

std::string recordingName(const std::string& path) {
  const auto absolute = std::filesystem::weakly_canonical(path);
  return absolute.parent_path().filename() / absolute.filename();
}

bool Outputs::parse(program::CommandLine& line, int argc, const char** argv,
                    std::initializer_list<const std::string*> inputs) {
  line.option(json_, 0, "json", "FILE", "Write the figures as JSON to FILE");
  line.option(plot_, 0, "plot", "FILE.png", "Plot the comparison");
  line.flag(overwrite_, 'w', "overwrite", "Overwrite existing files");
  if (!line.parse(argc, argv)) return false;
  quiet_ = line.quiet();
  if (!plot_.empty() && std::filesystem::path(plot_).extension() != ".png") {
    throw program::UsageError("--plot: '" + plot_ + "' must end in .png");
  }
  std::vector<std::string> files;
  for (const auto* input : inputs) files.push_back(*input);
  for (const auto& path : {json_, plot_}) {
    if (!path.empty()) program::requireWritable(path, overwrite_, files);
  }
  return true;
}

void Outputs::write(const std::function<nlohmann::ordered_json()>& figures,
                    const std::function<cv::Mat()>& plot) const {
  if (!json_.empty()) writeFile(json_, figures().dump(2) + "\n");
  if (!plot_.empty()) program::writePicture(plot_, plot());
}

}  // namespace headway::app

int main(int argc, char** argv) {
  using namespace headway;
  return program::run("headway-eval", [&] {
    const char** arguments = const_cast<const char**>(argv);
    return program::runSubcommand(
        argc, arguments, "Computes errors of a replay's results against the truth.",
        {{"trajectory", "Errors of a trajectory against the true one", app::runTrajectory},
         {"tracks", "Errors of tracks against labels: positions, CLEAR MOT, HOTA, sAMOTA",
          app::runTracks},
         {"predictions", "Errors of predictions against the true future", app::runPredictions},
         {"movers", "Recall and precision of moving objects, false moving tracks", app::runMovers},
         {"people", "People of a simulated world that a replay finds, and false rows",
          app::runPeople},
         {"grid", "Errors of an occupancy grid against the simulated world", app::runGrid},
         {"dense", "Errors and coverage of a dense map against the simulated world", app::runDense},
         {"suite", "Tables of all errors over simulated worlds", app::runSuite}});
  });
}
