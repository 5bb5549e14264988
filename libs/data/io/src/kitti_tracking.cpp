// SPDX-License-Identifier: BSD-3-Clause
// KITTI's tracking benchmark: labels and boxes, with poses or with the images of their drive.
#include <headway/core/error.h>
#include <headway/io/dataset.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <filesystem>

#include "kitti_raw.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

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

using BoxFrames = std::map<std::size_t, Detections>;
using Dropped = std::map<std::string, std::size_t>;

/// Reads all boxes of the sequence, from one file or from one folder per class.
BoxFrames readBoxes(const fs::path& training, const std::string& file, KittiBoxes boxes,
                    Dropped& dropped) {
  const fs::path folder = training / nameOf(boxes);
  if (boxes == KittiBoxes::kLabels) return readDetections((folder / file).string(), dropped);
  BoxFrames frames;
  bool found = false;
  for (const char* class_name : {"Car", "Pedestrian", "Cyclist"}) {
    const fs::path path = folder / class_name / file;
    if (!fs::exists(path)) continue;
    found = true;
    for (auto& [index, detections] : readDetections(path.string(), dropped)) {
      auto& items = frames[index].items;
      items.insert(items.end(), detections.items.begin(), detections.items.end());
    }
  }
  if (!found) throw InputError(folder.string() + ": no class folder contains " + file);
  return frames;
}

/// The labelled objects, without DontCare regions; nullopt if the sequence has no labels.
std::optional<BoxFrames> readTruthObjects(const fs::path& training, const std::string& file) {
  const fs::path labels = training / "label_02" / file;
  if (!fs::exists(labels)) return std::nullopt;
  Dropped not_objects;
  return readDetections(labels.string(), not_objects);
}

/// Boxes of a frame; a frame without boxes is a result too.
Detections boxesAt(const BoxFrames& frames, std::size_t index, Time time) {
  const auto found = frames.find(index);
  Detections detections = found == frames.end() ? Detections{} : found->second;
  detections.time = time;
  return detections;
}

void countBeyond(const BoxFrames& frames, std::size_t size, const char* reason, Dropped& dropped) {
  for (const auto& [index, detections] : frames) {
    if (index >= size) dropped[reason] += detections.items.size();
  }
}

/// Poses and boxes without images.
class KittiTracking : public Dataset {
 public:
  KittiTracking(const fs::path& training, const std::string& file, KittiBoxes boxes) {
    const Pose T_robot_cam = robotFromOptical();
    for (const auto& T_first_cam : readKittiPoses((training / "pose_orbslam3" / file).string())) {
      poses_.push_back(T_robot_cam * T_first_cam * T_robot_cam.inverse());
    }
    truth_ = readTruthObjects(training, file);
    detections_ = readBoxes(training, file, boxes, dropped_);
    if (truth_) countBeyond(*truth_, size(), "frame_without_pose", dropped_);
    countBeyond(detections_, size(), "frame_without_pose", dropped_);
  }

  std::size_t size() const override { return poses_.size(); }

  DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = kKittiFramePeriod * static_cast<double>(index);
    frame.T_map_robot = poses_.at(index);
    frame.detections = boxesAt(detections_, index, frame.time);
    if (truth_) frame.truth_objects = boxesAt(*truth_, index, frame.time);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return std::nullopt; }
  Dropped dropped() const override { return dropped_; }

 private:
  std::vector<Pose> poses_;
  BoxFrames detections_;
  std::optional<BoxFrames> truth_;
  Dropped dropped_;
};

constexpr double kSameCamera = 1e-3;  // largest difference of equal projections

/// Displacement of an image point from camera 0 to camera 2 times its depth [px m], from the
/// sequence's calibration, which must be that of the drive; 0 without a calibration.
double cameraTwoOffset(const fs::path& path, const RawStereoCamera& drive) {
  if (!fs::exists(path)) return 0.0;
  const auto projections = readKittiProjections(path.string());
  const auto& P0 = projections.at("P0");
  const auto& lens = drive.left;
  const Eigen::Vector4d difference(P0(0, 0) - lens.fx, P0(1, 1) - lens.fy, P0(0, 2) - lens.cx,
                                   P0(1, 2) - lens.cy);
  if (difference.cwiseAbs().maxCoeff() > kSameCamera) {
    throw InputError(path.string() +
                     ": P0 is not the left camera of the drive; is it another sequence's drive?");
  }
  const auto P2 = projections.find("P2");
  return P2 == projections.end() ? 0.0 : P2->second(0, 3);
}

/// Moves 2D boxes with a known depth from camera 2's image to camera 0's.
void moveToCameraZero(BoxFrames& frames, double offset) {
  for (auto& [index, detections] : frames) {
    for (auto& item : detections.items) {
      if (!item.box2d || !item.box3d || !(item.box3d->centre.z() > 1.0)) continue;
      const double shift = offset / item.box3d->centre.z();
      item.box2d->left -= shift;
      item.box2d->right -= shift;
    }
  }
}

/// Labels and boxes with the images of the raw drive.
class KittiTrackingImages : public Dataset {
 public:
  KittiTrackingImages(const fs::path& training, const std::string& file,
                      std::optional<KittiBoxes> boxes, const fs::path& drive, OxtsPath path)
      : drive_(readKittiRawDrive(drive, path)), dropped_(drive_.dropped) {
    for (std::size_t k = 0; k < size(); ++k) {
      if (drive_.frames[k].images.number == k) continue;
      throw InputError(drive.string() + ": image " + std::to_string(k) +
                       " is missing; labels and images must start at 0 without gaps");
    }
    const double offset = cameraTwoOffset(training / "calib" / file, drive_.camera);
    truth_ = readDetections((training / "label_02" / file).string(), dropped_);
    dropped_.erase("dont_care");
    prepare(truth_, offset);
    if (!boxes) return;
    detections_ = readBoxes(training, file, *boxes, dropped_);
    prepare(*detections_, offset);
  }

  std::size_t size() const override { return drive_.frames.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const auto& recorded = drive_.frames.at(index);
    DatasetFrame frame = recorded.load();
    frame.truth_objects = boxesAt(truth_, index, frame.time);
    if (detections_) frame.detections = boxesAt(*detections_, index, frame.time);
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return drive_.camera; }
  std::vector<DatasetInertial> inertial() const override { return drive_.inertial; }
  std::vector<RecordedGnss> gnss() const override { return drive_.gnss; }
  Dropped dropped() const override { return dropped_; }

 private:
  void prepare(BoxFrames& frames, double offset) {
    countBeyond(frames, size(), "frame_without_image", dropped_);
    moveToCameraZero(frames, offset);
  }

  KittiRawDrive drive_;
  BoxFrames truth_;
  std::optional<BoxFrames> detections_;
  Dropped dropped_;
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
  return std::make_unique<KittiTracking>(fs::path(folder) / "training", sequence + ".txt", boxes);
}

std::unique_ptr<Dataset> openKittiTracking(const std::string& folder, const std::string& sequence,
                                           std::optional<KittiBoxes> boxes,
                                           const std::string& drive, OxtsPath path) {
  return std::make_unique<KittiTrackingImages>(fs::path(folder) / "training", sequence + ".txt",
                                               boxes, drive, path);
}

}  // namespace headway::io
