// SPDX-License-Identifier: BSD-3-Clause
// headway-import: converts a dataset to a rawlog.
#include <headway/core/text.h>
#include <headway/program/command_line.h>
#include <headway/program/progress.h>

#include <iostream>

#include "check_command.h"
#include "importer.h"
#include "rosbag_command.h"

namespace headway::import {
namespace {

void report(const ImportOptions& options, const ImportSummary& summary) {
  std::cout << options.output << ": " << summary.frames << " frames"
            << (summary.interrupted ? ", interrupted" : "");
  for (const auto& [reason, count] : summary.dropped) {
    std::cout << ", skipped " << printable(reason) << " " << count;
  }
  std::cout << std::endl;
}

int runImport(int argc, const char** argv) {
  if (argc > 1 && std::string(argv[1]) == "rosbag") return runRosbag(argc, argv);
  if (argc > 1 && std::string(argv[1]) == "rawlog") return runRawlog(argc, argv);
  auto options = parseOptions(argc, argv);
  if (!options) return program::kDone;
  const ImportOutput output(options->output, options->check);
  options->output = output.path();
  program::requireWritable(options->output, options->overwrite,
                           {options->detections, options->poses});
  const auto dataset = openDataset(*options);
  program::catchInterrupts();
  const auto summary = importDataset(*dataset, *options);
  if (!options->quiet) report(*options, summary);
  return options->check ? checkRawlog(options->output) : program::kDone;
}

}  // namespace
}  // namespace headway::import

int main(int argc, char** argv) {
  return headway::program::run("headway-import", [&] {
    return headway::import::runImport(argc, const_cast<const char**>(argv));
  });
}
