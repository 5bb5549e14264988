// SPDX-License-Identifier: BSD-3-Clause
// libFuzzer target of the files from which a report is made; the first byte selects the file that
// the input replaces in a folder of results.
#include <headway/core/error.h>
#include <headway/report/report.h>

#include <cstddef>
#include <cstdint>

#include "file_tree.h"

namespace {

constexpr char kFlat[] = "P5\n4 3\n255\n............";

/// A short replay's results; the pictures are no seeds.
headway::test::FileTree makeResults() {
  headway::test::FileTree tree("report_files");
  for (const char* name : {"summary.json", "replay.json", "tracks.csv", "trajectory.tum",
                           "map_points.ply", "map_grid.yaml", "truth/objects.csv"}) {
    tree.addSeed(name);
  }
  tree.add("map_grid.png", kFlat);
  tree.add("snapshots/000003.png", kFlat);
  tree.add("truth/trajectory.tum", tree.seed("trajectory.tum"));
  return tree;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  static headway::test::FileTree results = makeResults();
  const auto replaced = results.replace(data[0], data + 1, size - 1);
  headway::report::ReportOptions options;
  options.truth = results.path() / "truth";
  options.output = "/dev/null";
  try {
    (void)headway::report::writeReport(results.path(), options);
  } catch (const headway::InputError&) {  // expected of most inputs
  }
  return 0;
}
