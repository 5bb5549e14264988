// SPDX-License-Identifier: BSD-3-Clause
// The sub-commands of headway-export.
#pragma once

#include <headway/program/command_line.h>

#include <functional>
#include <string>

namespace headway::exporting {

// Each returns the exit status and throws UsageError or InputError.

/// The rectified stereo frames of a rawlog as a KITTI odometry sequence.
int runKittiOdometryExport(int argc, const char** argv);
/// The map of a replay, cut to a box.
int runMapExport(int argc, const char** argv);
/// A replay for Foxglove and other viewers of MCAP files.
int runMcapExport(int argc, const char** argv);
/// The path of a replay as TUM poses.
int runTumExport(int argc, const char** argv);
/// The path or the tracks of a replay as a file of KITTI.
int runKittiExport(int argc, const char** argv);
/// The dense map or the landmarks of a replay as a PLY file.
int runPlyExport(int argc, const char** argv);
/// The occupancy grid of a replay for a map server of ROS.
int runRosmapExport(int argc, const char** argv);
/// The path and the tracks of a replay on the earth.
int runGeojsonExport(int argc, const char** argv);

/// What all exports read and write.
struct ExportOptions {
  std::string input = {};
  std::string output = {};
  bool overwrite = false;
  bool quiet = false;
};

/// One sub-command's arguments as --help shows them.
struct ExportText {
  std::string command;
  std::string summary;
  std::string input_type, input;  ///< name and meaning of the argument
  std::string output_type;
  bool is_folder = false;  ///< the output
};

/// Reads the command line of an export.
///
/// @param more  declares the options that only this one has
/// @return false if the program has nothing more to do
[[nodiscard]] bool parse(int argc, const char** argv, const ExportText& text,
                         ExportOptions& options,
                         const std::function<void(program::CommandLine&)>& more = {});

}  // namespace headway::exporting
