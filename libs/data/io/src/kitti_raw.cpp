// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/dataset.h>

#include <set>

#include "kitti_raw_drive.h"
#include "kitti_tracklets.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kDateLength = 10;  // of "2011_09_26", at the start of a drive's name

class KittiRaw : public Dataset {
 public:
  KittiRaw(const fs::path& folder, OxtsPath path) : drive_(readKittiRawDrive(folder, path)) {
    const fs::path tracklets = folder / "tracklet_labels.xml";
    if (!fs::exists(tracklets)) return;
    tracklets_ = readKittiTracklets(tracklets.string(), drive_.T_cam_velo, drive_.dropped);
    std::set<std::size_t> numbers;
    for (const auto& frame : drive_.frames) numbers.insert(frame.images.number);
    for (const auto& [number, objects] : *tracklets_) {
      if (numbers.count(number) == 0) drive_.dropped["frame_without_image"] += objects.items.size();
    }
  }

  std::size_t size() const override { return drive_.frames.size(); }

  DatasetFrame frame(std::size_t index) const override {
    const auto& recorded = drive_.frames.at(index);
    DatasetFrame frame = recorded.load();
    if (!tracklets_) return frame;
    const auto objects = tracklets_->find(recorded.images.number);
    frame.truth_objects = objects == tracklets_->end() ? Detections{} : objects->second;
    frame.truth_objects->time = recorded.time;
    return frame;
  }

  std::optional<RawStereoCamera> camera() const override { return drive_.camera; }
  std::vector<DatasetInertial> inertial() const override { return drive_.inertial; }
  std::vector<RecordedGnss> gnss() const override { return drive_.gnss; }
  std::map<std::string, std::size_t> dropped() const override { return drive_.dropped; }

 private:
  KittiRawDrive drive_;
  std::optional<std::map<std::size_t, Detections>> tracklets_;  ///< by number of the image
};

}  // namespace

OxtsPath oxtsPathFrom(const std::string& name) {
  if (name == "positions") return OxtsPath::kPositions;
  if (name == "velocities") return OxtsPath::kVelocities;
  throw InputError("path '" + name + "' is unknown; known are positions, velocities");
}

std::unique_ptr<Dataset> openKittiRaw(const std::string& folder, const std::string& drive,
                                      OxtsPath path) {
  return std::make_unique<KittiRaw>(fs::path(folder) / drive.substr(0, kDateLength) / drive, path);
}

}  // namespace headway::io
