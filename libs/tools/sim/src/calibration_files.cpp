// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_files.h"

#include <headway/core/output_file.h>

#include <iomanip>
#include <sstream>

namespace headway::sim {
namespace {

/// The upper three rows, row by row.
void writeRows(std::ostream& out, const Pose& pose, const char* separator) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      out << (row + column > 0 ? separator : "") << pose.matrix()(row, column);
    }
  }
}

}  // namespace

void writeKittiCalibration(const std::string& path, const StereoCamera& camera) {
  std::ostringstream out;
  out << std::setprecision(12);
  for (int i = 0; i < 4; ++i) {
    const double shift = i % 2 == 0 ? 0.0 : -camera.fx * camera.baseline_m;
    out << "P" << i << ": " << camera.fx << " 0 " << camera.cx << " " << shift << " 0 " << camera.fy
        << " " << camera.cy << " 0 0 0 1 0\n";
  }
  out << "R0_rect: 1 0 0 0 1 0 0 0 1\nTr_velo_to_cam: ";
  writeRows(out, camera.T_robot_cam.inverse(), " ");
  out << "\nTr_imu_to_velo: 1 0 0 0 0 1 0 0 0 0 1 0\n";
  writeFile(path, out.str());
}

}  // namespace headway::sim
