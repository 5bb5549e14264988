// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/output_file.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "commands.h"

namespace headway::app {

std::string recordingName(const std::string& path) {
  const auto absolute = std::filesystem::weakly_canonical(path);
  return absolute.parent_path().filename() / absolute.filename();
}

void Outputs::describe(program::CommandLine& line) {
  line.option(json_, 0, "json", "FILE", "Write the figures as JSON to FILE");
  line.option(plot_, 0, "plot", "FILE.png", "Plot the comparison");
  line.flag(overwrite_, 'w', "overwrite", "Overwrite existing files");
}

void Outputs::requireWritable(const std::vector<std::string>& inputs) const {
  if (!plot_.empty() && std::filesystem::path(plot_).extension() != ".png") {
    throw program::UsageError("--plot: '" + plot_ + "' must end in .png");
  }
  for (const auto& path : {json_, plot_}) {
    if (!path.empty()) program::requireWritable(path, overwrite_, inputs);
  }
}

void Outputs::write(const std::function<nlohmann::ordered_json()>& figures,
                    const std::function<cv::Mat()>& plot) const {
  if (!json_.empty()) writeFile(json_, figures().dump(2) + "\n");
  if (plot_.empty()) return;
  std::vector<unsigned char> png;
  cv::imencode(".png", plot(), png);
  writeFile(plot_, {reinterpret_cast<const char*>(png.data()), png.size()});
}

}  // namespace headway::app
