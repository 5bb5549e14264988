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

void writeLens(std::ostream& out, const std::string& name, const io::RawCamera& lens) {
  out << name << ":\n  width: " << lens.width << "\n  height: " << lens.height
      << "\n  fx: " << lens.fx << "\n  fy: " << lens.fy << "\n  cx: " << lens.cx
      << "\n  cy: " << lens.cy << "\n  distortion: [";
  for (std::size_t i = 0; i < lens.distortion.size(); ++i) {
    out << (i > 0 ? ", " : "") << lens.distortion[i];
  }
  out << "]\n";
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

void writeYamlCalibration(const std::string& path, const StereoCamera& camera,
                          const io::RawStereoCamera& recorded) {
  std::ostringstream out;
  out << std::setprecision(12);
  out << "# rectified pair; recorded lenses below (OpenCV's k1 k2 p1 p2 k3)\n"
      << "width: " << camera.width << "\nheight: " << camera.height << "\nfx: " << camera.fx
      << "\nfy: " << camera.fy << "\ncx: " << camera.cx << "\ncy: " << camera.cy
      << "\nbaseline_m: " << camera.baseline_m << "\n# 3x4, row by row: left camera on the robot\n"
      << "T_robot_cam: [";
  writeRows(out, camera.T_robot_cam, ", ");
  out << "]\n";
  writeLens(out, "recorded_left", recorded.left);
  writeLens(out, "recorded_right", recorded.right);
  writeFile(path, out.str());
}

}  // namespace headway::sim
