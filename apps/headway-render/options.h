// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/program/command_line.h>
#include <headway/scene/snapshot.h>

#include <optional>
#include <string>

namespace headway::render_program {

enum class OutputKind { kPicture, kVideo, kScene, kReport, kReplayPage };

/// Command-line options.
struct Options {
  std::string input;  ///< folder of a finished replay, or a map file
  std::string output;
  std::optional<std::size_t> frame;                 ///< of a picture or scene; empty: the last
  std::optional<std::size_t> from_index, to_index;  ///< of a video; empty: all frames
  std::string view = "follow";
  std::string size = "1280x720";
  std::string theme = "dark";
  bool without_dense = false;
  std::string truth;  ///< folder of the truth, or empty
  bool overwrite = false;
  bool quiet = false;

  OutputKind kind = OutputKind::kPicture;  ///< from the extension of the output
  scene::SnapshotOptions snapshot;         ///< from view, size, theme and layers
};

/// Adds the options to a command line.
void describe(Options& options, program::CommandLine& line);

/// Derives `kind` and `snapshot` from the options.
///
/// @throws program::UsageError naming the invalid option
void resolve(Options& options);

/// Draws the requested picture, video, scene, report or page.
///
/// @throws InputError
void render(const Options& options);

}  // namespace headway::render_program
