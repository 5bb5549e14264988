// SPDX-License-Identifier: BSD-3-Clause
// Parameters of all detectors, and the making of one by its name.
#include <headway/core/error.h>
#include <headway/detect/detector_factory.h>

namespace headway::detect {

void DetectParams::describe(Params& params) {
  auto section = params.section("detect").user();
  section.add("period_s", period_s, 0.0, 100.0, "s",
              "Period of dnn and hog, which are slow; the other detectors run on every frame; 0: "
              "every frame");
  section.renamed("every_nth_frame", "period_s",
                  [](double frames) { return frames == 1.0 ? 0.0 : secondsOfFrames(frames); });
  disparity.describe(params.section("disparity"));
  stereo_motion.describe(params.section("stereo_motion"));
  network.describe(params.section("dnn"));
  person.describe(params.section("hog"));
  shape.describe(params.section("shape"));
}

void DetectParams::validate() const {
  validateRanges(*this);
  network.validate();
}

const std::vector<std::string>& detectorNames() {
  static const std::vector<std::string> names = {"stereo_motion", "dnn", "hog", "shape"};
  return names;
}

std::unique_ptr<Detector> makeDetector(const std::string& name, const DetectParams& params) {
  if (name == "dnn") return std::make_unique<NetworkDetector>(params.network);
  if (name == "hog") return std::make_unique<PersonDetector>(params.person);
  std::string known;
  for (const auto& other : detectorNames()) known += (known.empty() ? "" : ", ") + other;
  throw InputError("detector \"" + name + "\" is not known; there are " + known);
}

}  // namespace headway::detect
