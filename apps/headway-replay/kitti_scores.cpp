#include "kitti_scores.h"

#include <iomanip>
#include <sstream>
#include <string>

#include "output_folder.h"

namespace headway::replay {

void rescoreKittiResults(const std::filesystem::path& file,
                         const std::map<std::int64_t, double>& scores) {
  auto rescored = file;
  rescored += ".new";
  {
    std::ifstream old_rows(file);
    OutputFile new_rows(rescored);
    new_rows.stream() << std::fixed << std::setprecision(6);
    for (std::string row; std::getline(old_rows, row);) {
      std::istringstream fields(row);
      std::int64_t frame = 0;
      std::int64_t id = 0;
      fields >> frame >> id;
      const auto score = scores.find(id);
      if (score == scores.end()) {
        new_rows.stream() << row << '\n';
      } else {
        new_rows.stream() << row.substr(0, row.rfind(' ') + 1) << score->second << '\n';
      }
    }
    new_rows.flush();
  }
  std::filesystem::rename(rescored, file);
}

}  // namespace headway::replay
