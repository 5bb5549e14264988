#pragma once

#include <string>

namespace headway::app {

enum class PoseFormat { kTum, kKitti };

/// Format of a trajectory file, by the number of columns in its first row.
///
/// @throws InputError naming the file if it is neither format or contains no poses
[[nodiscard]] PoseFormat poseFormatOf(const std::string& path);

}  // namespace headway::app
