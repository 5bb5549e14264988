#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <filesystem>

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr double kTrackingFramePeriod = 0.1;  // [s]

const std::vector<std::pair<std::string, KittiBoxes>>& boxNames() {
  static const std::vector<std::pair<std::string, KittiBoxes>> names = {
      {"label_02", KittiBoxes::kLabels},
      {"det3d_pointrcnn", KittiBoxes::kPointRcnn3d},
      {"det2d_rrc", KittiBoxes::kRrc2d}};
  return names;
}

std::string nameOf(KittiBoxes boxes) {
  for (const auto& [name, value] : boxNames()) {
    if (value == boxes) return name;
  }
  return "";
}

class KittiTracking : public Dataset {
 public:
  KittiTracking(const fs::path& folder, const std::string& sequence, KittiBoxes boxes) {
    const fs::path training = folder / "training";
    const std::string file = sequence + ".txt";
    const Pose T_robot_cam = robotFromOptical();
    for (const auto& T_first_cam : readKittiPoses((training / "pose_orbslam3" / file).string())) {
      poses_.push_back(T_robot_cam * T_first_cam * T_robot_cam.inverse());
    }
    const fs::path labels = training / "label_02" / file;
    if (fs::exists(labels)) {
      std::map<std::string, std::size_t> not_objects;  // DontCare regions
      truth_ = inTime(readDetections(labels.string(), not_objects));
      has_truth_ = true;
    }
    detections_ = inTime(readBoxes(training / nameOf(boxes), file, boxes));
  }

  std::size_t size() const override { return poses_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = timeOf(index);
    frame.T_map_robot = poses_.at(index);
    frame.detections = atFrame(detections_, index);
    if (has_truth_) frame.truth_objects = atFrame(truth_, index);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return std::nullopt; }
  std::map<std::string, std::size_t> dropped() const override { return dropped_; }

 private:
  using Frames = std::map<std::size_t, Detections>;

  static Time timeOf(std::size_t index) { return kTrackingFramePeriod * static_cast<double>(index); }

  /// Reads all boxes of the sequence, from one file or from one folder per class.
  Frames readBoxes(const fs::path& folder, const std::string& file, KittiBoxes boxes) {
    if (boxes == KittiBoxes::kLabels) return readDetections((folder / file).string(), dropped_);
    Frames frames;
    bool found = false;
    for (const char* class_name : {"Car", "Pedestrian", "Cyclist"}) {
      const fs::path path = folder / class_name / file;
      if (!fs::exists(path)) continue;
      found = true;
      for (auto& [index, detections] : readDetections(path.string(), dropped_)) {
        auto& items = frames[index].items;
        items.insert(items.end(), detections.items.begin(), detections.items.end());
      }
    }
    if (!found) throw InputError(folder.string() + ": no class folder contains " + file);
    return frames;
  }

  Frames inTime(Frames frames) {
    for (auto& [index, detections] : frames) {
      detections.time = timeOf(index);
      if (index >= poses_.size()) dropped_["frame_without_pose"] += detections.items.size();
    }
    return frames;
  }

  static Detections atFrame(const Frames& frames, std::size_t index) {
    const auto found = frames.find(index);
    if (found != frames.end()) return found->second;
    Detections none;  // a frame without boxes is a result too
    none.time = timeOf(index);
    return none;
  }

  std::vector<Pose> poses_;
  Frames detections_;
  Frames truth_;
  bool has_truth_ = false;
  std::map<std::string, std::size_t> dropped_;
};

}  // namespace

KittiBoxes kittiBoxesFrom(const std::string& name) {
  std::string known;
  for (const auto& [candidate, boxes] : boxNames()) {
    if (candidate == name) return boxes;
    known += (known.empty() ? "" : ", ") + candidate;
  }
  throw InputError("boxes '" + name + "' are unknown; known are " + known);
}

std::unique_ptr<Dataset> openKittiTracking(const std::string& folder, const std::string& sequence,
                                           KittiBoxes boxes) {
  return std::make_unique<KittiTracking>(folder, sequence, boxes);
}

}  // namespace headway::io
