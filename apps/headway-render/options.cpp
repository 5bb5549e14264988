// SPDX-License-Identifier: BSD-3-Clause
#include "options.h"

#include <charconv>
#include <filesystem>

namespace headway::render_program {
namespace {

using program::UsageError;

constexpr int kMinSide = 16;
constexpr int kMaxSide = 7680;

int parseSide(const std::string& text, const std::string& whole) {
  int side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error != std::errc() || end != text.data() + text.size() || side < kMinSide ||
      side > kMaxSide) {
    throw UsageError("--size: '" + whole + "' is not WIDTHxHEIGHT with sides of 16 to 7680 pixels");
  }
  return side;
}

OutputKind kindOf(const std::string& output) {
  const std::string extension = std::filesystem::path(output).extension();
  if (extension == ".png" || extension == ".jpg") return OutputKind::kPicture;
  if (extension == ".mp4") return OutputKind::kVideo;
  if (extension == ".3Dscene") return OutputKind::kScene;
  if (std::filesystem::path(output).filename() == "replay.html") return OutputKind::kReplayPage;
  if (extension == ".html") return OutputKind::kReport;
  throw UsageError("--output: '" + output + "' must end in .png, .jpg, .mp4, .3Dscene or .html");
}

}  // namespace

void describe(Options& options, program::CommandLine& line) {
  line.option(options.input, 'i', "input", "OUTDIR|MAPFILE",
              "Folder of a finished replay, or a map.headway", true);
  line.option(options.output, 'o', "output",
              "PICTURE.png|VIDEO.mp4|SCENE.3Dscene|REPORT.html|replay.html",
              "Output file; its extension selects the kind, and the name replay.html the page with "
              "a 3D view and a timeline",
              true);
  line.option(options.frame, 0, "frame", "N", "Frame of a picture or scene; default: the last");
  line.option(options.from_index, 0, "from-index", "N", "First frame of a video");
  line.option(options.to_index, 0, "to-index", "N", "Last frame of a video");
  line.option(options.view, 0, "view", "follow|top|orbit|camera", "Viewpoint; default follow");
  line.option(options.size, 0, "size", "WxH",
              "Size of the picture or video [px]; default 1280x720");
  line.option(options.theme, 0, "theme", "dark|light", "Colours of a picture, video or scene");
  line.flag(options.without_dense, 0, "no-dense", "Leave out the dense map");
  line.option(options.truth, 0, "truth", "DIR",
              "Folder with trajectory.tum and objects.csv to draw as truth");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing output");
}

void resolve(Options& options) {
  options.kind = kindOf(options.output);
  const auto view = scene::viewFrom(options.view);
  if (!view) {
    throw UsageError("--view: '" + options.view + "' is not one of follow, top, orbit, camera");
  }
  options.snapshot.view = *view;
  const auto theme = scene::themeFrom(options.theme);
  if (!theme) throw UsageError("--theme: '" + options.theme + "' is neither dark nor light");
  options.snapshot.theme = *theme;
  options.snapshot.dense = !options.without_dense;
  const auto x = options.size.find('x');
  options.snapshot.width = parseSide(options.size.substr(0, x), options.size);
  options.snapshot.height =
      parseSide(x == std::string::npos ? "" : options.size.substr(x + 1), options.size);
  const bool video = options.kind == OutputKind::kVideo;
  if (video && options.frame) throw UsageError("--frame is for a picture or scene, not a video");
  if (!video && (options.from_index || options.to_index)) {
    throw UsageError("--from-index and --to-index are for a video; a picture takes --frame");
  }
  if (options.from_index && options.to_index && *options.to_index < *options.from_index) {
    throw UsageError("--to-index is less than --from-index");
  }
}

}  // namespace headway::render_program
