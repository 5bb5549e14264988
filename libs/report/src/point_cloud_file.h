#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

namespace headway::report {

/// The points of a binary little-endian PLY file whose vertices start with float x, y, z [m].
///
/// @param most  every n-th point is taken, so that there are no more than this
/// @throws InputError if it is not such a file or ends early
[[nodiscard]] std::vector<Eigen::Vector3f> readPoints(const std::filesystem::path& path,
                                                      std::size_t most);

}  // namespace headway::report
