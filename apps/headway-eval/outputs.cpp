#include <headway/core/error.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "commands.h"

namespace headway::app {

void Outputs::describe(program::CommandLine& line) {
  line.option(json_, 0, "json", "FILE", "Write the figures as JSON to FILE");
  line.option(plot_, 0, "plot", "FILE.png", "Plot the comparison");
  line.flag(overwrite_, 'w', "overwrite", "Overwrite existing files");
}

void Outputs::requireWritable() const {
  if (!plot_.empty() && std::filesystem::path(plot_).extension() != ".png") {
    throw program::UsageError("--plot: '" + plot_ + "' must end in .png");
  }
  for (const auto& path : {json_, plot_}) {
    if (!path.empty()) program::requireWritable(path, overwrite_);
  }
}

void Outputs::write(const std::function<nlohmann::ordered_json()>& figures,
                    const std::function<cv::Mat()>& plot) const {
  if (!json_.empty()) {
    std::ofstream file(json_);
    file << figures().dump(2) << std::endl;
    if (!file) throw InputError(json_ + ": cannot be written; does its folder exist?");
  }
  if (plot_.empty()) return;
  std::vector<unsigned char> png;
  cv::imencode(".png", plot(), png);
  std::ofstream file(plot_, std::ios::binary);
  file.write(reinterpret_cast<const char*>(png.data()), static_cast<std::streamsize>(png.size()));
  file.flush();
  if (!file) throw InputError(plot_ + ": cannot be written; does its folder exist?");
}

}  // namespace headway::app
