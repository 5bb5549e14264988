#include "point_cloud_file.h"

#include <headway/core/error.h>

#include <cstring>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace headway::report {
namespace {

struct Header {
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes of one vertex
};

std::size_t sizeOf(const std::string& type) {
  static const std::map<std::string, std::size_t> kSizes = {
      {"char", 1}, {"uchar", 1}, {"short", 2}, {"ushort", 2},
      {"int", 4},  {"uint", 4},  {"float", 4}, {"double", 8}};
  const auto size = kSizes.find(type);
  return size == kSizes.end() ? 0 : size->second;
}

Header readHeader(std::istream& file, const std::string& name) {
  Header header;
  std::string text;
  for (std::string line; std::getline(file, line) && line != "end_header"; text += line + "\n") {
    std::istringstream words(line);
    std::string word, type;
    words >> word >> type;
    if (word == "element" && type == "vertex") words >> header.count;
    if (word == "property") header.stride += sizeOf(type);
  }
  const bool known =
      text.rfind("ply\nformat binary_little_endian 1.0\n", 0) == 0 &&
      text.find("property float x\nproperty float y\nproperty float z") != std::string::npos;
  if (!file || !known) throw InputError(name + ": is not a binary PLY file of points");
  return header;
}

}  // namespace

std::vector<Eigen::Vector3f> readPoints(const std::filesystem::path& path, std::size_t most) {
  std::ifstream file(path, std::ios::binary);
  const Header header = readHeader(file, path.string());
  const std::size_t step = most == 0 ? 1 : (header.count + most - 1) / most;
  std::vector<Eigen::Vector3f> points;
  std::vector<char> vertex(header.stride);
  for (std::size_t i = 0; i < header.count; ++i) {
    file.read(vertex.data(), static_cast<std::streamsize>(vertex.size()));
    if (!file) throw InputError(path.string() + ": ends early");
    if (i % step != 0) continue;
    Eigen::Vector3f point;
    std::memcpy(point.data(), vertex.data(), 3 * sizeof(float));
    points.push_back(point);
  }
  return points;
}

}  // namespace headway::report
