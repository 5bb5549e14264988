#pragma once

#include <headway/program/command_line.h>
#include <headway/scene/snapshot.h>

#include <optional>
#include <string>

namespace headway::render_program {

enum class OutputKind { kPicture, kVideo, kScene, kReport };

/// What the command line asks for.
struct Options {
  std::string input;  ///< folder of a finished replay, or a map file
  std::string output;
  std::optional<std::size_t> frame;                 ///< of a picture or scene; empty: the last one
  std::optional<std::size_t> from_index, to_index;  ///< of a video; empty: all frames
  std::string view = "follow";
  std::string size = "1280x720";
  std::string truth;  ///< folder of the truth, or empty
  bool overwrite = false;
  bool quiet = false;

  OutputKind kind = OutputKind::kPicture;  ///< from the output's name
  scene::SnapshotOptions snapshot;         ///< from view and size
};

/// Binds the options to the command line.
void describe(Options& options, program::CommandLine& line);

/// Works out what follows from the texts given.
///
/// @throws program::UsageError naming the option that cannot be
void resolve(Options& options);

}  // namespace headway::render_program
