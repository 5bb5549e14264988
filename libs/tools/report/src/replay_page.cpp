// SPDX-License-Identifier: BSD-3-Clause
// The interactive page of a replay.
#include <headway/core/ellipse.h>
#include <headway/core/error.h>
#include <headway/core/object_class.h>
#include <headway/core/output_file.h>
#include <headway/io/calibration_file.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/replay_page.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <random>

#include "html.h"
#include "page_data.h"
#include "page_files.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kMaxStep = 65535.0;  // of 16 bits

/// What keeps a page below 15 MB.
struct PageLimits {
  std::size_t frames = 2000, true_poses = 4000, keyframes = 4000;
  std::size_t images = 160, image_bytes = 2500000;
  int image_width = 448;  ///< [px]; about 15 kB each
  int image_quality = 65;
  std::size_t dense_points = 450000, landmarks = 60000;
  std::size_t boxes = 20000, prediction_points = 80000;  ///< of all frames
};
constexpr PageLimits kLimits{};

/// Positions and speeds in steps of 1 cm, angles in steps of 1 mrad.
std::int64_t hundredths(double value) {
  return std::isfinite(value) ? std::llround(std::clamp(100.0 * value, -1e12, 1e12)) : 0;
}
std::int64_t thousandths(double value) { return hundredths(10.0 * value); }

Json poseJson(const Pose& pose) {
  const Eigen::Vector3d& t = pose.translation();
  const Eigen::Quaterniond q(pose.linear());
  Json json = Json::array();
  for (const double value : {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()}) {
    json.push_back(std::round(1e4 * value) / 1e4);
  }
  return json;
}

void append(Json& list, const Eigen::Vector3d& vector) {
  for (const double value : vector) list.push_back(hundredths(value));
}

/// Numbers the tracks in order of their first appearance.
class TrackNumbers {
 public:
  explicit TrackNumbers(const std::vector<ReplayFrame>& frames) {
    for (const auto& frame : frames) {
      for (const auto& track : frame.tracks) {
        const auto [number, is_new] = numbers_.try_emplace(track.id, numbers_.size());
        if (is_new) votes_.emplace_back(), ids_.push_back(track.id);
        votes_[number->second][track.object_class] += 1;
      }
    }
  }
  [[nodiscard]] std::size_t of(TrackId id) const { return numbers_.at(id); }
  /// Ids, and the number of frames with each class.
  [[nodiscard]] Json json() const {
    Json list = Json::array();
    for (std::size_t i = 0; i < ids_.size(); ++i) {
      Json votes = Json::object();
      for (const auto& [object_class, count] : votes_[i]) votes[classNumber(object_class)] = count;
      list.push_back({{"id", ids_[i].value}, {"votes", votes}});
    }
    return list;
  }
  static std::string classNumber(ObjectClass object_class) {
    return std::to_string(static_cast<int>(object_class));
  }

 private:
  std::map<TrackId, std::size_t> numbers_;
  std::vector<TrackId> ids_;
  std::vector<std::map<ObjectClass, int>> votes_;
};

/// number, class, moving + 2 * coasting, x, y, z, yaw, vx, vy, length, width, height.
Json stateJson(const Track& track, std::size_t number) {
  Json state = {number, static_cast<int>(track.object_class),
                (isMoving(track) ? 1 : 0) + (track.status == TrackStatus::kCoasting ? 2 : 0)};
  append(state, track.position);
  state.push_back(thousandths(track.yaw));
  for (const double speed : {track.velocity.x(), track.velocity.y()}) {
    state.push_back(hundredths(speed));
  }
  append(state, track.size);
  return state;
}

/// number of the track, percent, then for each point: horizon [0.1 s], position, half axes of one
/// standard deviation, angle of the major one.
Json predictionJson(const PredictedPath& path, std::size_t number) {
  Json json = {number, std::llround(100.0 * path.probability)};
  for (const auto& point : path.points) {
    const Ellipse ellipse = sigmaEllipse(point.covariance);
    json.push_back(std::llround(10.0 * point.horizon_s));
    append(json, point.position);
    json.push_back(hundredths(ellipse.major));
    json.push_back(hundredths(ellipse.minor));
    json.push_back(thousandths(ellipse.angle));
  }
  return json;
}

Json frameJson(const ReplayFrame& frame, const TrackNumbers& numbers, Time start) {
  Json states = Json::array(), predictions = Json::array();
  for (const auto& track : frame.tracks) {
    const std::size_t number = numbers.of(track.id);
    states.push_back(stateJson(track, number));
    if (!isMoving(track)) continue;
    for (const auto& path : track.predictions) {
      if (!path.points.empty()) predictions.push_back(predictionJson(path, number));
    }
  }
  return {{"frame", frame.frame},
          {"time", std::round(1e4 * (frame.time - start)) / 1e4},
          {"pose", poseJson(frame.T_map_robot)},
          {"states", states},
          {"predictions", predictions}};
}

/// Leaves out the predictions of the farthest tracks of each frame where there are too many.
void keepNearestPredictions(std::vector<ReplayFrame>& frames, const Note& note) {
  const auto pointsOf = [](const Track& track) {
    std::size_t points = 0;
    for (const auto& path : track.predictions) points += isMoving(track) ? path.points.size() : 0;
    return points;
  };
  std::size_t all = 0, left_out = 0;
  for (const auto& frame : frames) {
    for (const auto& track : frame.tracks) all += pointsOf(track);
  }
  if (all <= kLimits.prediction_points) return;
  for (auto& frame : frames) {
    sortByDistance(frame.T_map_robot, frame.tracks);
    std::size_t points = 0;
    for (auto& track : frame.tracks) {
      points += pointsOf(track);
      if (points <= kLimits.prediction_points / frames.size() || pointsOf(track) == 0) continue;
      track.predictions.clear();
      ++left_out;
    }
  }
  note("predictions of " + std::to_string(left_out) +
       " boxes are left out: those of the nearest ones of each frame are shown");
}

Json classesJson() {
  Json classes = Json::array();
  for (std::size_t i = 0; i < kObjectClassCount; ++i) {
    const auto object_class = static_cast<ObjectClass>(i);
    classes.push_back({displayName(object_class), hex(colourOf(object_class))});
  }
  return classes;
}

/// Notes that a page shows some of very many.
void noteRest(std::size_t shown, std::size_t all, const std::string& what, const Note& note) {
  if (shown < all) note("of " + grouped(all) + " " + what + " " + grouped(shown) + " are shown");
}

Json cameraJson(const fs::path& calibration) {
  if (!fs::exists(calibration)) return nullptr;
  const StereoCamera camera = io::readCalibration(calibration);
  return {{"width", camera.width},
          {"height", camera.height},
          {"fx", camera.fx},
          {"fy", camera.fy},
          {"cx", camera.cx},
          {"cy", camera.cy},
          {"pose", poseJson(camera.T_robot_cam)}};
}

Json gridJson(const fs::path& description) {
  const auto grid = readGrid(description);
  if (!grid) return nullptr;
  const GridPicture picture = gridPicture(grid->picture);
  return {{"picture", picture.uri},
          {"x", grid->origin.x()},
          {"y", grid->origin.y()},
          {"width", picture.width * grid->resolution_m},
          {"height", picture.height * grid->resolution_m}};
}

/// Ground height under the robot's origin, and the rig's reach [m]; as of a car if they are
/// unknown.
void addRig(const Json& record, Json& data) {
  data["ground"] = 0.0;
  data["reach"] = 20.0;
  if (!record.is_object() || !record.contains("rig") || !record["rig"].is_object()) return;
  const Json& rig = record["rig"];
  data["reach"] = rig.value("obstacles_to_m", 20.0);
  if (data["camera"].is_null()) return;
  data["ground"] = data["camera"]["pose"][2].get<double>() - rig.value("camera_height_m", 0.0);
}

Json truthJson(const ReplayTruth& truth, const std::vector<ReplayFrame>& frames, const Note& note) {
  if (truth.path.empty()) return nullptr;
  const std::size_t in_a_frame = std::max<std::size_t>(1, kLimits.boxes / frames.size());
  std::size_t left_out = 0;
  Json path = Json::array(), objects = Json::array();
  const std::size_t step = 1 + (truth.path.size() - 1) / kLimits.true_poses;
  for (std::size_t i = 0; i < truth.path.size(); i += step) {
    append(path, truth.path[i].value.translation());
  }
  for (const auto& frame : frames) {
    Json boxes = Json::array();
    const auto found = truth.objects.find(frame.frame);
    if (found != truth.objects.end()) {
      std::vector<Track> shown = found->second;
      if (shown.size() > in_a_frame) {
        left_out += shown.size() - in_a_frame;
        sortByDistance(frame.T_map_robot, shown);
        shown.resize(in_a_frame);
      }
      for (const auto& track : shown) {
        Json box = Json::array();
        append(box, track.position);
        box.push_back(thousandths(track.yaw));
        append(box, track.size);
        boxes.push_back(box);
      }
    }
    objects.push_back(boxes);
  }
  if (left_out > 0) {
    note(std::to_string(left_out) + " true boxes are left out: at most the nearest " +
         std::to_string(in_a_frame) + " of each frame are shown");
  }
  return {{"path", path}, {"objects", objects}};
}

/// Median distance from points in random order to their nearest other [m]; 0 of fewer than two.
double spacingOf(const std::vector<ColouredPoint>& points) {
  std::vector<float> nearest(points.size() < 2 ? 0 : std::min<std::size_t>(101, points.size()));
  for (std::size_t i = 0; i < nearest.size(); ++i) {
    nearest[i] = std::numeric_limits<float>::max();
    for (std::size_t j = 0; j < points.size(); ++j) {
      if (i == j) continue;
      nearest[i] = std::min(nearest[i], (points[j].position - points[i].position).squaredNorm());
    }
  }
  if (nearest.empty()) return 0.0;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return std::sqrt(*middle);
}

}  // namespace

PackedPoints packed(std::vector<ColouredPoint> points) {
  points.erase(std::remove_if(points.begin(), points.end(),
                              [](const auto& point) { return !point.position.allFinite(); }),
               points.end());
  PackedPoints result;
  result.count = points.size();
  if (points.empty()) return result;
  std::mt19937 random(1);
  for (std::size_t i = points.size() - 1; i > 0; --i)
    std::swap(points[i], points[random() % (i + 1)]);
  result.spacing = spacingOf(points);
  Eigen::AlignedBox3f bounds;
  for (const auto& point : points) bounds.extend(point.position);
  result.origin = bounds.min().cast<double>();
  result.step = (bounds.sizes().cast<double>() / kMaxStep).cwiseMax(1e-6);
  result.bytes.reserve(9 * points.size());
  for (const auto& point : points) {
    const Eigen::Vector3d steps =
        (point.position.cast<double>() - result.origin).cwiseQuotient(result.step);
    for (const double step : steps) {
      const auto value = static_cast<unsigned>(std::lround(std::clamp(step, 0.0, kMaxStep)));
      result.bytes.push_back(static_cast<std::uint8_t>(value & 0xFFU));
      result.bytes.push_back(static_cast<std::uint8_t>(value >> 8U));
    }
  }
  for (const auto& point : points) {
    for (const auto part : {point.colour.red, point.colour.green, point.colour.blue}) {
      result.bytes.push_back(part);
    }
  }
  return result;
}

Json pageData(const fs::path& folder, const std::vector<ReplayFrame>& frames,
              const ReplayTruth& truth, const std::vector<Stamped<Pose>>& keyframes,
              const Note& note) {
  Json data = {{"classes", classesJson()},
               {"camera", cameraJson(folder / "calibration.yaml")},
               {"grid", gridJson(folder / "map_grid.yaml")},
               {"truth", truthJson(truth, frames, note)},
               {"prediction_colour", hex(kPredictionColour)},
               {"keyframes", Json::array()}};
  const fs::path record = folder / "replay.json";
  addRig(fs::exists(record) ? readJson(record) : Json(), data);
  const std::size_t step = 1 + keyframes.size() / kLimits.keyframes;
  for (std::size_t i = 0; i < keyframes.size(); i += step) {
    data["keyframes"].push_back(poseJson(keyframes[i].value));
  }
  return data;
}

namespace {

/// Text of a JSON value that cannot end the element around it.
std::string inlineJson(const Json& json) {
  const std::string plain = json.dump(-1, ' ', false, Json::error_handler_t::replace);
  std::string text;
  std::size_t start = 0;
  for (auto at = plain.find('<'); at != std::string::npos; at = plain.find('<', start)) {
    text.append(plain, start, at - start).append("\\u003c");
    start = at + 1;
  }
  return text.append(plain, start, std::string::npos);
}

/// Writes "[a,b,...]" without a copy of the whole.
template <typename Values, typename ToJson>
void writeList(std::ostream& out, const Values& values, const ToJson& to_json) {
  const char* before = "[";
  for (const auto& value : values) {
    out << before << inlineJson(to_json(value));
    before = ",";
  }
  out << (values.empty() ? "[]" : "]");
}

}  // namespace

void writePageData(std::ostream& out, const Json& data, const std::vector<ReplayFrame>& frames) {
  const TrackNumbers numbers(frames);
  out << "{\"tracks\":" << inlineJson(numbers.json()) << ",\"frames\":";
  writeList(out, frames, [&](const ReplayFrame& frame) {
    return frameJson(frame, numbers, frames.front().time);
  });
  for (const auto& [key, value] : data.items()) out << ",\"" << key << "\":" << inlineJson(value);
  out << '}';
}

void PageImages::add(std::size_t frame, const cv::Mat& image) {
  if (image.empty() || added_++ % step_ != 0) return;
  bytes_ += (jpegs_[frame] = jpegOf(image, kLimits.image_width, kLimits.image_quality)).size();
  if (jpegs_.size() <= kLimits.images && bytes_ <= kLimits.image_bytes) return;
  bytes_ = 0;
  std::size_t position = 0;
  for (auto jpeg = jpegs_.begin(); jpeg != jpegs_.end(); ++position) {
    if (position % 2 == 0) bytes_ += jpeg->second.size();
    jpeg = position % 2 == 0 ? std::next(jpeg) : jpegs_.erase(jpeg);
  }
  step_ *= 2;
}

namespace {

/// The source expression of Content-Security-Policy for an inline script or style.
std::string hashSource(const std::string& text) {
  std::vector<std::uint8_t> hash(EVP_MAX_MD_SIZE);
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), hash.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw InputError("the SHA-256 of the page's script cannot be computed");
  }
  hash.resize(size);
  return "'sha256-" + base64(hash) + "'";
}

std::string policy(const std::vector<std::string>& scripts, const std::string& style) {
  std::string text =
      "default-src 'none'; img-src data:; style-src " + hashSource(style) + "; script-src";
  for (const auto& script : scripts) text += " " + hashSource(script);
  return text + "; base-uri 'none'; form-action 'none'";
}

/// A data block, which browsers do not execute; the caller ends it.
std::ostream& startBlock(std::ostream& out, const std::string& id, const std::string& type) {
  return out << "<script type=\"" << type << "\" id=\"" << id << "\">";
}
constexpr char kEndBlock[] = "</script>\n";

Json boundsJson(const PackedPoints& points) {
  return {{"count", points.count},
          {"spacing", points.spacing},
          {"origin", {points.origin.x(), points.origin.y(), points.origin.z()}},
          {"step", {points.step.x(), points.step.y(), points.step.z()}}};
}

/// Writes the points of a file, and returns what the page needs to read them.
Json writePoints(std::ostream& out, const fs::path& path, std::size_t max_points,
                 const std::string& id, const Note& left_out) {
  if (!fs::exists(path)) return nullptr;
  const PackedPoints points = packed(readPoints(path, max_points));
  noteRest(points.count, countPoints(path), id == "dense" ? "points of the dense map" : id,
           left_out);
  startBlock(out, id, "text/plain") << base64(points.bytes) << kEndBlock;
  return boundsJson(points);
}

void writeImages(std::ostream& out, const JpegByFrame& images) {
  writeList(startBlock(out, "images", "application/json"), images, [](const auto& image) {
    return Json{image.first, base64(image.second)};
  });
  out << kEndBlock;
}

/// Name of the recording, or else of the folder.
std::string nameOf(const fs::path& folder) {
  const std::string rawlog = readReplayInput(folder).rawlog;
  if (!rawlog.empty()) return fs::path(io::rawlogStem(rawlog)).filename().string();
  return fs::weakly_canonical(folder).filename().string();
}

/// Whether the run was killed, interrupted or stopped by an error.
bool endedEarly(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  const auto reason = summary.is_object() ? summary.find("ended_early") : summary.end();
  return reason != summary.end() && reason->is_string();
}

/// The number of poses in the folder's trajectory.
std::size_t countPoses(const fs::path& folder) {
  std::size_t poses = 0;
  io::visitTum(folder / "trajectory.tum", [&](const Stamped<Pose>&) { ++poses; });
  return poses;
}

/// @param written  title, and bounds of the points that are written already
/// @param left_out  receives what the page is to say of itself
void writeData(std::ostream& out, const fs::path& folder, const ReplayPageOptions& options,
               const Json& written, const Note& left_out, const Note& note) {
  const Note both = [&](const std::string& text) {
    left_out(text);
    note(text);
  };
  ReplayFrameOptions reading;
  reading.max_frames = kLimits.frames;
  reading.past_s = 0.0;
  reading.horizon_step_s = 0.5;
  reading.max_boxes = kLimits.boxes;
  auto frames = readReplayFrames(folder, reading, both);
  keepNearestPredictions(frames, both);
  ReplayTruth truth;
  if (!options.truth.empty()) truth = readReplayTruth(options.truth, frames, both);
  Json data = pageData(folder, frames, truth, options.keyframes, both);
  const std::size_t poses = countPoses(folder);
  noteRest(frames.size(), poses, "frames", left_out);
  if (!options.images.empty()) noteRest(options.images.size(), poses, "camera images", left_out);
  noteRest(data["keyframes"].size(), options.keyframes.size(), "keyframes", left_out);
  data.update(written);
  writePageData(startBlock(out, "data", "application/json"), data, frames);
  out << kEndBlock;
}

/// One part after the other, so that memory is that of the largest one.
void writePage(std::ostream& out, const fs::path& folder, const ReplayPageOptions& options,
               const Note& note) {
  std::string title = options.title.empty() ? nameOf(folder) : options.title;
  if (endedEarly(folder)) title += " (ended early)";
  const std::string three(kThreeScript), script = pageScript(), style(kPageStyle);
  out << "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta http-equiv=\"Content-Security-Policy\" content=\""
      << policy({three, script}, style)
      << "\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>"
      << escaped(title) << " – headway replay</title><style>" << style << "</style></head><body>\n"
      << kPageBody;
  Json written = {{"title", title}, {"left_out", Json::array()}};
  const Note left_out = [&](const auto& text) { written["left_out"].push_back(text); };
  written["dense"] =
      writePoints(out, folder / "map_dense.ply", kLimits.dense_points, "dense", left_out);
  written["landmarks"] =
      writePoints(out, folder / "map_points.ply", kLimits.landmarks, "landmarks", left_out);
  writeImages(out, options.images);
  writeData(out, folder, options, written, left_out, note);
  out << "<!-- three.js r" << kThreeRevision
      << ", MIT licence, Copyright 2010-2019 three.js authors -->\n<script>" << three
      << "</script>\n<script>" << script << "</script>\n</body></html>\n";
}

}  // namespace

fs::path writeReplayPage(const fs::path& folder, const ReplayPageOptions& options,
                         const Note& note) {
  const fs::path path = options.output.empty() ? folder / "replay.html" : options.output;
  try {
    OutputFile file(path);
    writePage(file.stream(), folder, options, note);
    file.commit();
  } catch (const nlohmann::json::exception& error) {
    throw InputError((folder / "replay.json").string() +
                     ": an entry is not what a replay writes: " + error.what());
  }
  return path;
}

}  // namespace headway::report
