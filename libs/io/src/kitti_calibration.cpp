#include <headway/core/error.h>
#include <headway/io/kitti_dataset.h>

#include "text_rows.h"

namespace headway::io {

std::map<std::string, Eigen::Matrix<double, 3, 4>> readKittiProjections(const std::string& path) {
  std::map<std::string, Eigen::Matrix<double, 3, 4>> matrices;
  TextRows rows(path);
  while (rows.next()) {
    if (rows.size() != 13 || rows.fields()[0].back() != ':') continue;  // R0_rect has 9 numbers
    Eigen::Matrix<double, 3, 4> matrix;
    for (Eigen::Index i = 0; i < 12; ++i) {
      matrix(i / 4, i % 4) = rows.number(static_cast<std::size_t>(i + 1));
    }
    const std::string name = rows.fields()[0];
    matrices[name.substr(0, name.size() - 1)] = matrix;
  }
  if (matrices.count("P0") == 0 || matrices.count("P1") == 0) {
    throw InputError(path + ": is not a KITTI calibration: no line 'P0:' or 'P1:' of 12 numbers");
  }
  return matrices;
}

}  // namespace headway::io
