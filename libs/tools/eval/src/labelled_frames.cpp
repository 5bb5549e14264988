// SPDX-License-Identifier: BSD-3-Clause
// Labels and tracks of recordings, and the files that contain them.
#include <headway/core/error.h>
#include <headway/eval/labelled_frames.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway/io/trajectory_file.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>

namespace headway::eval {
namespace {

constexpr double kSameTime_s = 1e-4;

std::vector<TrueObject> objectsOf(const std::vector<LabelledFrame>& frames,
                                  std::vector<LabelledBox> LabelledFrame::*which,
                                  const std::vector<Stamped<Pose>>& T_map_cam) {
  std::map<std::int64_t, TrueObject> objects;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (k >= T_map_cam.size() && !(frames[k].*which).empty()) {
      throw InputError("only " + std::to_string(T_map_cam.size()) + " poses are given, but frame " +
                       std::to_string(k) + " has labels too");
    }
    for (const auto& box : frames[k].*which) {
      if (!box.box3d) continue;
      const auto& [time, pose] = T_map_cam[k];
      const Eigen::Vector3d front = pose.linear() * frontOf(*box.box3d);
      auto& object = objects[box.id];
      object.id = box.id;
      object.object_class = box.object_class;
      object.path.push_back({k, time, pose * box.box3d->centre, std::atan2(front.y(), front.x())});
    }
  }
  std::vector<TrueObject> result;
  for (auto& [id, object] : objects) result.push_back(std::move(object));
  return result;
}

}  // namespace

bool isPerson(ObjectClass object_class) {
  return object_class == ObjectClass::kPedestrian || object_class == ObjectClass::kPersonSitting;
}

std::optional<Eigen::Vector3d> TrueObject::positionAt(Time time, double max_gap_s) const {
  const auto after =
      std::lower_bound(path.begin(), path.end(), time - kSameTime_s,
                       [](const TrajectoryPoint& point, Time t) { return point.time < t; });
  if (after == path.end()) return std::nullopt;
  if (after->time <= time + kSameTime_s) return after->position;
  if (after == path.begin()) return std::nullopt;
  const auto before = after - 1;
  const double gap = after->time - before->time;
  if (gap > max_gap_s) return std::nullopt;
  const double ratio = (time - before->time) / gap;
  return (1.0 - ratio) * before->position + ratio * after->position;
}

std::vector<TrueObject> trueObjects(const std::vector<LabelledFrame>& frames,
                                    const std::vector<Stamped<Pose>>& T_map_cam) {
  return objectsOf(frames, &LabelledFrame::truth, T_map_cam);
}

std::vector<TrueObject> estimatedObjects(const std::vector<LabelledFrame>& frames,
                                         const std::vector<Stamped<Pose>>& T_map_cam) {
  return objectsOf(frames, &LabelledFrame::estimates, T_map_cam);
}

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxFrames = 10'000'000;  // a larger frame index is an error in the file

std::map<std::string, std::string> filesByName(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    const auto [other, is_new] = files.emplace(entry.path().stem(), entry.path());
    if (!is_new) {
      throw InputError(folder + ": contains two files named '" + other->first + "'; remove one");
    }
  }
  return files;
}

void requireExists(const std::string& path) {
  if (!fs::exists(path)) throw InputError(path + ": no such file or folder");
}

std::string locationOf(const std::string& path, std::size_t frame) {
  return path + ": frame " + std::to_string(frame) + ": ";
}

void requireUsable(const LabelledBox& box, std::size_t frame, const std::string& path) {
  const bool finite = std::isfinite(box.score) && std::isfinite(box.truncation) &&
                      (!box.box2d || isFinite(*box.box2d)) && (!box.box3d || isFinite(*box.box3d));
  if (!finite) throw InputError(locationOf(path, frame) + "a number is not finite");
}

LabelledFrame& frameAt(std::vector<LabelledFrame>& frames, std::size_t frame,
                       const std::string& path) {
  if (frame > kMaxFrames)
    throw InputError(locationOf(path, frame) + "the frame index is too large");
  if (frames.size() <= frame) frames.resize(frame + 1);
  return frames[frame];
}

LabelledBox labelledBox(const Detection& detection) {
  LabelledBox box;
  box.id = detection.detector_id.value_or(-1);
  box.object_class = detection.object_class;
  box.score = detection.score;
  box.box2d = detection.box2d;
  box.box3d = detection.box3d;
  return box;
}

/// The file of a track, as headway's programs write it: its header names the columns.
bool isTrackCsv(const std::string& path) {
  std::ifstream file(path);
  std::string header;
  std::getline(file, header);
  return header.find("track_id") != std::string::npos;
}

/// A box of a track in a camera frame at the map's origin, so that both files of a comparison are
/// in the same frame.
LabelledBox labelledBox(const TrackSample& sample) {
  LabelledBox box;
  box.id = sample.track.id.value;
  box.object_class = sample.track.object_class;
  box.score = sample.track.score;
  box.box3d = opticalBox(sample.track.position, sample.track.size, sample.track.yaw,
                         robotFromOptical().inverse());
  return box;
}

/// KITTI's occlusion level of a visible ratio, as simulated labels have it.
int occlusionOf(double visible) {
  if (visible >= 0.8) return 0;
  if (visible >= 0.4) return 1;
  return visible >= 0.1 ? 2 : 3;
}

std::vector<LabelledFrame> readObjectLabels(const std::string& path) {
  std::vector<LabelledFrame> frames;
  for (const auto& [sample, visible] : io::readObjectCsv(path)) {
    LabelledBox box = labelledBox(sample);
    box.occlusion = occlusionOf(visible);
    requireUsable(box, sample.frame, path);
    frameAt(frames, sample.frame, path).truth.push_back(box);
  }
  if (frames.empty()) throw InputError(path + ": contains no labels");
  return frames;
}

void addTrackSamples(const std::string& path, std::vector<LabelledFrame>& frames) {
  std::set<std::pair<std::size_t, std::int64_t>> seen;
  io::visitTrackCsv(path, [&](const TrackSample& sample) {
    const auto box = labelledBox(sample);
    requireUsable(box, sample.frame, path);
    if (!seen.insert({sample.frame, box.id}).second) {
      throw InputError(locationOf(path, sample.frame) + "id " + std::to_string(box.id) +
                       " occurs twice; a track has one box per frame");
    }
    frameAt(frames, sample.frame, path).estimates.push_back(box);
  });
}

std::vector<std::string> rawFiles(const std::string& name, const std::string& path) {
  requireExists(path);
  if (!fs::is_directory(path)) return {path};
  std::vector<std::string> files;
  std::vector<std::string> folders = {path};
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.is_directory() && objectClassFrom(entry.path().filename().string())) {
      folders.push_back(entry.path());
    }
  }
  std::sort(folders.begin(), folders.end());
  for (const auto& folder : folders) {
    const auto named = filesByName(folder);
    if (const auto file = named.find(name); file != named.end()) files.push_back(file->second);
  }
  if (files.empty()) throw InputError(path + ": contains no file named '" + name + "'");
  return files;
}

std::map<std::size_t, Detections> rawDetections(const std::string& file) {
  std::map<std::string, std::size_t> dropped;
  if (!io::hasRawlogName(file)) return io::readDetections(file, dropped);
  std::map<std::size_t, Detections> frames;
  io::RawlogSource source(file, {});
  while (auto frame = source.next()) {
    if (frame->detections) frames[frame->index] = std::move(*frame->detections);
  }
  return frames;
}

}  // namespace

PairedFiles pairedFiles(const std::string& truth, const std::string& estimate) {
  requireExists(truth);
  requireExists(estimate);
  if (fs::is_directory(truth) != fs::is_directory(estimate)) {
    throw InputError(truth + " and " + estimate + ": must be two files or two folders");
  }
  if (!fs::is_directory(truth)) return {{{fs::path(truth).stem(), truth, estimate}}, {}};
  const auto true_files = filesByName(truth);
  const auto estimates = filesByName(estimate);
  PairedFiles result;
  for (const auto& [name, file] : estimates) {
    const auto labels = true_files.find(name);
    if (labels == true_files.end()) {
      throw InputError(file + ": no file named '" + name + "' in " + truth);
    }
    result.pairs.push_back({name, labels->second, file});
  }
  if (result.pairs.empty()) throw InputError(estimate + ": the folder contains no files");
  for (const auto& [name, file] : true_files) {
    if (estimates.count(name) == 0) result.truth_alone.push_back(name);
  }
  return result;
}

std::string fileNamed(const std::string& name, const std::string& path) {
  requireExists(path);
  if (!fs::is_directory(path)) return path;
  const auto files = filesByName(path);
  const auto file = files.find(name);
  if (file == files.end()) throw InputError(path + ": contains no file named '" + name + "'");
  return file->second;
}

void requireSameFrame(const std::string& truth, const std::string& estimate) {
  if (isTrackCsv(truth) == isTrackCsv(estimate)) return;
  throw InputError(truth + " and " + estimate +
                   ": one is in the map and one in the camera; compare objects.csv with "
                   "tracks.csv, or KITTI labels with KITTI results");
}

std::vector<LabelledFrame> readLabels(const std::string& path) {
  if (isTrackCsv(path)) return readObjectLabels(path);
  std::vector<LabelledFrame> frames;
  const auto rows = io::readKittiRows(path);
  if (rows.empty()) throw InputError(path + ": contains no labels");
  for (const auto& row : rows) {
    auto& frame = frameAt(frames, row.frame, path);
    const auto detection = io::detectionFrom(row);
    if (row.type == "DontCare") frame.dont_care.push_back(row.box2d);
    if (!detection) continue;
    LabelledBox box;
    box.id = row.id;
    box.object_class = detection->object_class;
    box.box2d = detection->box2d;
    box.box3d = detection->box3d;
    box.occlusion = row.occlusion;
    box.truncation = row.truncation;
    requireUsable(box, row.frame, path);
    frame.truth.push_back(box);
  }
  return frames;
}

void addEstimates(const std::string& path, std::vector<LabelledFrame>& frames,
                  std::map<std::string, std::size_t>& dropped) {
  if (isTrackCsv(path)) return addTrackSamples(path, frames);
  std::int64_t next_id = -1;  // of boxes without a track id
  for (const auto& [index, detections] : io::readDetections(path, dropped)) {
    auto& frame = frameAt(frames, index, path);
    std::set<std::int64_t> ids;
    for (const auto& detection : detections.items) {
      auto box = labelledBox(detection);
      if (!detection.detector_id) box.id = next_id--;
      requireUsable(box, index, path);
      if (!ids.insert(box.id).second) {
        throw InputError(locationOf(path, index) + "id " + std::to_string(box.id) +
                         " occurs twice; a track has one box per frame");
      }
      frame.estimates.push_back(box);
    }
  }
}

std::vector<LabelledFrame> readRaw(const std::string& name, const std::string& path) {
  std::vector<LabelledFrame> frames;
  std::int64_t next_id = -1;
  for (const auto& file : rawFiles(name, path)) {
    for (const auto& [index, detections] : rawDetections(file)) {
      auto& frame = frameAt(frames, index, file);
      for (const auto& detection : detections.items) {
        frame.estimates.push_back(labelledBox(detection));
        frame.estimates.back().id = next_id--;
        requireUsable(frame.estimates.back(), index, file);
      }
    }
  }
  return frames;
}

PoseFormat poseFormatOf(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened");
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::size_t columns = 0;
    for (std::string word; words >> word;) ++columns;
    if (columns == 8) return PoseFormat::kTum;
    if (columns == 12) return PoseFormat::kKitti;
    if (columns > 0) {
      throw InputError(path + ": rows have " + std::to_string(columns) +
                       " columns; TUM has 8 (t x y z qx qy qz qw), KITTI 12 (3x4 matrix)");
    }
  }
  throw InputError(path + ": contains no poses");
}

std::vector<Stamped<Pose>> readCameraPoses(const std::string& path, const Pose& T_robot_cam) {
  std::vector<Stamped<Pose>> poses;
  if (poseFormatOf(path) == PoseFormat::kTum) {
    poses = io::readTum(path);
    for (auto& pose : poses) pose.value = pose.value * T_robot_cam;
    return poses;
  }
  for (const auto& pose : io::readKittiPoses(path)) {
    const double time = kNominalFrameInterval_s * static_cast<double>(poses.size());
    poses.push_back({time, T_robot_cam * pose});
  }
  return poses;
}

}  // namespace headway::eval
