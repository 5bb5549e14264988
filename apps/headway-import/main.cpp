// SPDX-License-Identifier: BSD-3-Clause
// headway-import: converts datasets to rawlogs, and checks recordings.
#include "commands.h"

int main(int argc, char** argv) {
  using namespace headway;
  const auto dataset = [](const std::string& name, const std::string& about) {
    const auto run = [name, about](int count, const char** arguments) {
      return import::runDataset(name, about, count, arguments);
    };
    return program::Subcommand{name, about, run};
  };
  return program::run("headway-import", [&] {
    return program::runSubcommand(
        argc, const_cast<const char**>(argv),
        "Converts datasets to rawlogs, and checks recordings.",
        {dataset("kitti-odometry", "Converts a sequence of KITTI's odometry benchmark to a rawlog"),
         dataset("kitti-raw", "Converts a drive of KITTI's raw data to a rawlog"),
         dataset("kitti-tracking", "Converts a sequence of KITTI's tracking benchmark to a rawlog"),
         dataset("euroc", "Converts a flight of the EuRoC dataset to a rawlog"),
         dataset("tum-rgbd", "Converts a sequence of TUM's RGB-D benchmark to a rawlog"),
         dataset("images", "Converts folders of images of a stereo or depth camera to a rawlog"),
         {"rosbag", "Converts a bag of ROS 1 or ROS 2 to a rawlog", import::runRosbag},
         {"rawlog", "Checks a rawlog, or thins its frames", import::runRawlog}});
  });
}
