// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "run_program.h"

namespace headway::eval {

/// A short drive through a simulated street among people and cars, with all truth, and its replay:
/// w.rawlog, w.truth and out.
class SimulatedDrive {
 public:
  /// @param replay_options  of headway-replay
  SimulatedDrive(int frames, const std::string& replay_options) {
    run("headway-sim -q --seed 5 --frames " + std::to_string(frames) +
        " --depth --masks -c " HEADWAY_SOURCE_DIR
        "/config/worlds/street.ini --set camera.width=400 --set camera.height=152 "
        "--set camera.focal_px=232 -o " +
        at("w.rawlog"));
    run("headway-replay -q --snapshots 0 " + replay_options + " -i " + at("w.rawlog") + " -o " +
        at("out"));
  }

  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

 private:
  void run(const std::string& command) const {
    const std::string line =
        std::string(HEADWAY_BIN_DIR "/") + command + " > " + at("log") + " 2>&1";
    ASSERT_EQ(0, std::system(line.c_str())) << contentOf(at("log"));
  }

  test::TemporaryFolder folder_;
};

}  // namespace headway::eval
