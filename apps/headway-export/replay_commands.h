// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::exporting {

// headway-export COMMAND OUTDIR -o OUTPUT: results of a finished replay in the formats of others.
// Each returns the exit status and throws UsageError or InputError.

/// For Foxglove and other viewers of MCAP files.
int runMcapExport(int argc, const char** argv);
/// The path as TUM poses.
int runTumExport(int argc, const char** argv);
/// The path, the tracks and the calibration as KITTI's files.
int runKittiExport(int argc, const char** argv);
/// The dense map or the landmarks as a PLY file.
int runPlyExport(int argc, const char** argv);
/// The occupancy grid for a map server of ROS.
int runRosmapExport(int argc, const char** argv);
/// The path and the tracks on the earth.
int runGeojsonExport(int argc, const char** argv);

}  // namespace headway::exporting
