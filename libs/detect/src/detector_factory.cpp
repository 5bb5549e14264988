#include <headway/core/error.h>
#include <headway/detect/detector_factory.h>

#include <sstream>

namespace headway::detect {
namespace {

/// Lets a detector look at one frame in n, and passes on what it counted.
class EveryNth : public Detector {
 public:
  EveryNth(std::unique_ptr<Detector> detector, int n) : detector_(std::move(detector)), n_(n) {}

  [[nodiscard]] bool needsPose() const override { return detector_->needsPose(); }

  [[nodiscard]] std::optional<Detections> detect(const StereoFrame& frame,
                                                 const std::optional<Pose>& T_map_robot) override {
    if (frames_++ % n_ != 0) return std::nullopt;
    return detector_->detect(frame, T_map_robot);
  }

  [[nodiscard]] MovingRegions movingRegions() const override { return detector_->movingRegions(); }
  [[nodiscard]] const DropCounts& dropped() const override { return detector_->dropped(); }

 private:
  std::unique_ptr<Detector> detector_;
  int n_;
  int frames_ = 0;
};

std::unique_ptr<Detector> bareDetector(const std::string& name,
                                       std::shared_ptr<const StereoCamera> camera,
                                       const DetectParams& params) {
  if (name == "stereo_motion") {
    return std::make_unique<StereoMotion>(std::move(camera), params.stereo_motion,
                                          params.disparity);
  }
  if (name == "dnn") return std::make_unique<NetworkDetector>(params.network);
  if (name == "hog") return std::make_unique<PersonDetector>(params.person);
  std::string known;
  for (const auto& other : detectorNames()) known += (known.empty() ? "" : ", ") + other;
  throw InputError("detector \"" + name + "\" is not known; there are " + known);
}

}  // namespace

void DetectParams::describe(Params& params) {
  params.section("detect").add("every_nth_frame", every_nth_frame, 1, 1000, "frames",
                               "Detectors look at one frame in so many; tracks coast between");
  disparity.describe(params.section("disparity"));
  stereo_motion.describe(params.section("stereo_motion"));
  network.describe(params.section("dnn"));
  person.describe(params.section("hog"));
}

const std::vector<std::string>& detectorNames() {
  static const std::vector<std::string> names = {"stereo_motion", "dnn", "hog"};
  return names;
}

std::unique_ptr<Detector> makeDetector(const std::string& name,
                                       std::shared_ptr<const StereoCamera> camera,
                                       const DetectParams& params) {
  auto detector = bareDetector(name, std::move(camera), params);
  if (params.every_nth_frame == 1) return detector;
  return std::make_unique<EveryNth>(std::move(detector), params.every_nth_frame);
}

std::vector<std::unique_ptr<Detector>> makeDetectors(
    const std::string& names, const std::shared_ptr<const StereoCamera>& camera,
    const DetectParams& params) {
  std::vector<std::unique_ptr<Detector>> detectors;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, '+');) {
    detectors.push_back(makeDetector(name, camera, params));
  }
  return detectors;
}

}  // namespace headway::detect
