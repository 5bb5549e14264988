// SPDX-License-Identifier: BSD-3-Clause
// The sub-commands of headway-import.
#pragma once

#include <headway/io/dataset.h>
#include <headway/program/command_line.h>

#include <memory>
#include <string>

namespace headway::import {

// Each parses its arguments, returns the exit status, and throws UsageError or InputError.

/// Converts a dataset to a rawlog.
///
/// @param dataset  name of the sub-command
/// @param about    what it does, for --help
int runDataset(const std::string& dataset, const std::string& about, int argc, const char** argv);
/// Lists the topics of a bag, or writes it as a rawlog.
int runRosbag(int argc, const char** argv);
/// Checks a rawlog, or thins its frames.
int runRawlog(int argc, const char** argv);

/// Images of a folder, or of a video (MP4, AVI and others) with the times of its container.
///
/// @throws InputError if it is neither
[[nodiscard]] std::unique_ptr<io::ImageSequence> openImages(const std::string& path);

}  // namespace headway::import
