#include "run_record.h"

#include <headway/core/version.h>

#include <nlohmann/json.hpp>

#include "output_folder.h"

namespace headway::replay {
namespace {

using Json = nlohmann::ordered_json;

Json indexJson(const std::optional<std::size_t>& index) {
  return index ? Json(*index) : Json(nullptr);
}

Json pathJson(const std::string& path) {
  return path.empty() ? Json(nullptr)
                      : Json(std::filesystem::absolute(path).lexically_normal().string());
}

}  // namespace

void writeRunRecord(const std::filesystem::path& path, const Options& options,
                    const Params& params) {
  Json json;
  json["version"] = kVersion;
  json["input"] = {{"rawlog", pathJson(options.input)},
                   {"detections", pathJson(options.detections)},
                   {"map", pathJson(options.load_map)},
                   {"sensor_label", options.sensor_label}};
  json["options"] = {{"realtime", options.realtime},
                     {"from_index", indexJson(options.from_index)},
                     {"to_index", indexJson(options.to_index)},
                     {"snapshots", options.snapshots}};
  json["configuration"] = Json(params.values());
  OutputFile file(path);
  file.stream() << json.dump(2) << '\n';
  file.flush();
}

}  // namespace headway::replay
