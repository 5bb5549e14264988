#include "pose_format.h"

#include <headway/core/error.h>

#include <fstream>
#include <sstream>

namespace headway::app {

PoseFormat poseFormatOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened");
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::size_t columns = 0;
    for (std::string word; words >> word;) ++columns;
    if (columns == 8) return PoseFormat::kTum;
    if (columns == 12) return PoseFormat::kKitti;
    if (columns > 0) {
      throw InputError(path + ": rows have " + std::to_string(columns) +
                       " columns; TUM has 8 (t x y z qx qy qz qw), KITTI 12 (3x4 matrix)");
    }
  }
  throw InputError(path + ": contains no poses");
}

}  // namespace headway::app
