// SPDX-License-Identifier: BSD-3-Clause
// headway-render: picture, video, 3D scene or report of a finished replay.
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/core/stereo_camera.h>
#include <headway/core/text.h>
#include <headway/io/calibration_file.h>
#include <headway/map/map_file.h>
#include <headway/map/perception_map.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway/program/picture_files.h>
#include <headway/program/progress.h>
#include <headway/program/truth_report.h>
#include <headway/report/replay_frames.h>
#include <headway/report/replay_page.h>
#include <headway/scene/snapshot.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <string>
#include <vector>

namespace headway::render_program {
namespace {

using report::Note;
using report::ReplayFrame;

/// The results of a replay that can be drawn.
struct FinishedReplay {
  map::PerceptionMap map;                      ///< its moving objects are replaced at each frame
  std::shared_ptr<const StereoCamera> camera;  ///< null if the poses were recorded
  std::vector<ReplayFrame> frames;             ///< ascending; at least one
  report::ReplayInput input;
};

namespace fs = std::filesystem;

constexpr double kSameTimeS = 1e-3;  // of a frame in two files, which round

FinishedReplay replayOf(map::StoredMap stored) {
  FinishedReplay replay;
  replay.map = std::move(stored.map);
  if (stored.camera) replay.camera = std::make_shared<StereoCamera>(*stored.camera);
  return replay;
}

/// A track at an earlier time: where its smoothed path has it, or else where its velocity does; its
/// predictions are of the same places.
///
/// @param moment  of the track [s]
Track movedBack(Track track, Time moment, Time time) {
  const auto& path = track.recent_path;
  const auto after = std::lower_bound(
      path.begin(), path.end(), time - kSameTimeS,
      [](const TrajectoryPoint& point, Time wanted) { return point.time < wanted; });
  if (after != path.end() && std::abs(after->time - time) <= kSameTimeS) {
    track.position = after->position;
    track.yaw = after->yaw;
  } else {
    track.position -= (moment - time) * track.velocity;
  }
  track.recent_path.erase(track.recent_path.begin() + (after - path.begin()),
                          track.recent_path.end());
  for (auto& prediction : track.predictions) {
    for (auto& point : prediction.points) point.horizon_s += moment - time;
  }
  return track;
}

/// The tracks of a map as they were at a time before the map's; later ones are left out.
std::vector<Track> tracksAt(Time time, const CMovingObjectsMap& objects) {
  std::vector<Track> tracks;
  for (const auto& track : objects.tracks()) {
    if (track.first_seen > time + kSameTimeS) continue;
    tracks.push_back(movedBack(track, objects.time(), time));
  }
  return tracks;
}

/// Reads a map file without its replay: its keyframes, and its objects at the last one.
FinishedReplay readMapAlone(const std::string& path) {
  FinishedReplay replay = replayOf(map::loadMap(path));
  for (const auto& keyframe : replay.map.staticMap()->keyframes) {
    replay.frames.push_back({keyframe.frame, keyframe.time, keyframe.T_map_robot, {}, {}});
  }
  if (replay.frames.empty()) replay.frames.emplace_back();
  const auto& objects = replay.map.movingObjects();
  ReplayFrame& last = replay.frames.back();
  if (last.time > 0.0) {
    last.tracks = tracksAt(last.time, objects);
  } else {
    last.tracks = objects.tracks();  // without a keyframe
  }
  return replay;
}

/// Reads a replay's folder, or a map file alone (one frame: its last keyframe).
///
/// Missing map, tracks, predictions and calibration are omitted and noted.
///
/// @throws InputError if there is neither a trajectory nor a map, or a file is malformed
FinishedReplay readReplay(const std::string& input, const Note& note) {
  if (fs::is_regular_file(input)) return readMapAlone(input);
  const fs::path folder(input);
  if (!fs::is_directory(folder)) throw InputError(input + ": no such folder or map file");
  const fs::path map_file = folder / "map.headway";
  if (!fs::exists(folder / "trajectory.tum") && !fs::exists(map_file)) {
    throw InputError(input +
                     ": contains neither trajectory.tum nor map.headway; is it the "
                     "output folder of a replay?");
  }
  if (!fs::exists(folder / "trajectory.tum")) return readMapAlone(map_file);
  FinishedReplay replay;
  if (fs::exists(map_file)) {
    replay = replayOf(map::loadMap(map_file));
  } else {
    note("no map.headway in " + input + ": drawn without landmarks");
  }
  if (replay.camera == nullptr && fs::exists(folder / "calibration.yaml")) {
    replay.camera =
        std::make_shared<StereoCamera>(io::readCalibration(folder / "calibration.yaml"));
  }
  replay.frames = report::readReplayFrames(input, {}, note);
  replay.input = report::readReplayInput(folder);
  return replay;
}

using program::UsageError;

enum class OutputKind { kPicture, kVideo, kScene, kReport, kReplayPage };

/// Command-line options.
struct Options {
  std::string input;  ///< folder of a finished replay, or a map file
  std::string output;
  std::optional<std::size_t> frame;                 ///< of a picture or scene; empty: the last
  std::optional<std::size_t> from_index, to_index;  ///< of a video; empty: all frames
  std::string view = "follow";
  std::string size = "1280x720";
  std::string theme = "dark";
  bool without_dense = false;
  std::string truth;  ///< folder of the truth, or empty
  bool overwrite = false;
  bool quiet = false;

  OutputKind kind = OutputKind::kPicture;  ///< from the extension of the output
  scene::SnapshotOptions snapshot;         ///< from view, size, theme and layers
};

int parseSide(const std::string& text, const std::string& whole) {
  int side = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), side);
  if (error != std::errc() || end != text.data() + text.size() || side < 16 || side > 7680) {
    throw UsageError("--size: '" + whole + "' is not WIDTHxHEIGHT with sides of 16 to 7680 pixels");
  }
  return side;
}

OutputKind kindOf(const std::string& output) {
  const std::string extension = std::filesystem::path(output).extension();
  if (extension == ".png" || extension == ".jpg") return OutputKind::kPicture;
  if (extension == ".mp4") return OutputKind::kVideo;
  if (extension == ".3Dscene") return OutputKind::kScene;
  if (std::filesystem::path(output).filename() == "replay.html") return OutputKind::kReplayPage;
  if (extension == ".html") return OutputKind::kReport;
  throw UsageError("--output: '" + output + "' must end in .png, .jpg, .mp4, .3Dscene or .html");
}

/// Adds the options to a command line.
void describe(Options& options, program::CommandLine& line) {
  line.option(options.input, 'i', "input", "OUTDIR|MAPFILE",
              "Folder of a finished replay, or a map.headway", true);
  line.option(options.output, 'o', "output",
              "PICTURE.png|VIDEO.mp4|SCENE.3Dscene|REPORT.html|replay.html",
              "Output file; its extension selects the kind, and the name replay.html the page with "
              "a 3D view and a timeline",
              true);
  line.option(options.frame, 0, "frame", "N", "Frame of a picture or scene; default: the last");
  line.option(options.from_index, 0, "from-index", "N", "First frame of a video");
  line.option(options.to_index, 0, "to-index", "N", "Last frame of a video");
  line.option(options.view, 0, "view", "follow|top|orbit|camera", "Viewpoint; default follow");
  line.option(options.size, 0, "size", "WxH",
              "Size of the picture or video [px]; default 1280x720");
  line.option(options.theme, 0, "theme", "dark|light", "Colours of a picture, video or scene");
  line.flag(options.without_dense, 0, "no-dense", "Leave out the dense map");
  line.option(options.truth, 0, "truth", "DIR",
              "Folder with trajectory.tum and objects.csv to draw as truth");
  line.flag(options.overwrite, 'w', "overwrite", "Overwrite an existing output");
}

/// Derives `kind` and `snapshot` from the options.
///
/// @throws UsageError naming the invalid option
void resolve(Options& options) {
  options.kind = kindOf(options.output);
  const auto view = scene::viewFrom(options.view);
  if (!view) {
    throw UsageError("--view: '" + options.view + "' is not one of follow, top, orbit, camera");
  }
  options.snapshot.view = *view;
  const auto theme = scene::themeFrom(options.theme);
  if (!theme) throw UsageError("--theme: '" + options.theme + "' is neither dark nor light");
  options.snapshot.theme = *theme;
  options.snapshot.dense = !options.without_dense;
  const auto x = options.size.find('x');
  options.snapshot.width = parseSide(options.size.substr(0, x), options.size);
  options.snapshot.height =
      parseSide(x == std::string::npos ? "" : options.size.substr(x + 1), options.size);
  const bool video = options.kind == OutputKind::kVideo;
  if (video && options.frame) throw UsageError("--frame is for a picture or scene, not a video");
  if (!video && (options.from_index || options.to_index)) {
    throw UsageError("--from-index and --to-index are for a video; a picture takes --frame");
  }
  if (options.from_index && options.to_index && *options.to_index < *options.from_index) {
    throw UsageError("--to-index is less than --from-index");
  }
}

/// Reconstructs the map, images and truth of frames in ascending order.
class Playback {
 public:
  Playback(const FinishedReplay& replay, report::ReplayTruth truth, std::size_t first_frame,
           const Note& note)
      : replay_(replay),
        truth_(std::move(truth)),
        images_(replay.input, first_frame, note),
        map_(replay.map),
        input_{map_} {
    input_.camera = replay_.camera;
  }

  /// @param position  in the list of frames, not less than the one before
  /// @return          valid until the next call
  const scene::SnapshotInput& at(std::size_t position) {
    const ReplayFrame& frame = replay_.frames[position];
    map_.update(frame.time, frame.tracks);
    input_.frame = frame.frame;
    input_.time = frame.time;
    input_.T_map_robot = frame.T_map_robot;
    input_.image = images_.at(frame.frame);
    for (auto i = input_.path.size(); i <= position; ++i) {
      input_.path.push_back({replay_.frames[i].time, replay_.frames[i].T_map_robot});
    }
    for (; true_poses_ < truth_.path.size() && truth_.path[true_poses_].time <= frame.time;
         ++true_poses_) {
      input_.true_path.push_back(truth_.path[true_poses_]);
    }
    const auto objects = truth_.objects.find(frame.frame);
    input_.true_objects = objects != truth_.objects.end() ? objects->second : std::vector<Track>();
    return input_;
  }

 private:
  const FinishedReplay& replay_;
  report::ReplayTruth truth_;
  report::RecordedImages images_;
  map::PerceptionMap map_;
  scene::SnapshotInput input_;  ///< its paths grow
  std::size_t true_poses_ = 0;  ///< of the truth, in the input's path
};

/// Position of a frame in the list of tracked frames.
std::size_t positionOf(std::size_t frame, const FinishedReplay& replay) {
  const auto& frames = replay.frames;
  const auto found = std::find_if(frames.begin(), frames.end(),
                                  [&](const ReplayFrame& f) { return f.frame == frame; });
  if (found != frames.end()) return static_cast<std::size_t>(found - frames.begin());
  throw InputError("--frame " + std::to_string(frame) + ": is not one of the tracked frames, " +
                   std::to_string(frames.front().frame) + " to " +
                   std::to_string(frames.back().frame));
}

/// Frame rate of the recording [Hz], limited to 1 to 60.
double rateOf(const FinishedReplay& replay) {
  std::vector<double> gaps;
  for (std::size_t i = 1; i < replay.frames.size(); ++i) {
    const double frames = static_cast<double>(replay.frames[i].frame - replay.frames[i - 1].frame);
    gaps.push_back((replay.frames[i].time - replay.frames[i - 1].time) / std::max(1.0, frames));
  }
  if (gaps.empty()) return 10.0;
  const double gap = median(std::move(gaps));
  return gap > 0.0 ? std::clamp(std::round(10.0 / gap) / 10.0, 1.0, 60.0) : 10.0;
}

void drawPicture(const Options& options, const FinishedReplay& replay, report::ReplayTruth truth,
                 const Note& note) {
  const std::size_t position =
      options.frame ? positionOf(*options.frame, replay) : replay.frames.size() - 1;
  if (options.kind == OutputKind::kScene) {
    Playback playback(replay, std::move(truth), replay.frames[position].frame,
                      [](const std::string&) {});  // a scene contains no image
    scene::saveScene(options.output, playback.at(position), options.snapshot);
    return;
  }
  Playback playback(replay, std::move(truth), replay.frames[position].frame, note);
  scene::SnapshotRenderer snapshots(options.snapshot);
  program::writePicture(options.output, snapshots.draw(playback.at(position)));
}

void drawVideo(const Options& options, const FinishedReplay& replay, report::ReplayTruth truth,
               const Note& note) {
  scene::SnapshotOptions snapshot = options.snapshot;
  snapshot.width += snapshot.width % 2;  // video encoders require even sizes
  snapshot.height += snapshot.height % 2;
  snapshot.supersampling = 1;  // antialiasing is not visible in motion and doubles the time
  const std::size_t first = options.from_index.value_or(0);
  const std::size_t last = options.to_index.value_or(replay.frames.back().frame);
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < replay.frames.size(); ++i) {
    if (replay.frames[i].frame >= first && replay.frames[i].frame <= last) positions.push_back(i);
  }
  if (positions.empty()) {
    throw InputError("no tracked frame between " + std::to_string(first) + " and " +
                     std::to_string(last));
  }
  scene::SnapshotRenderer snapshots(snapshot);
  Playback playback(replay, std::move(truth), replay.frames[positions.front()].frame, note);
  program::VideoOutput video(options.output, rateOf(replay), {snapshot.width, snapshot.height},
                             options.overwrite, note);
  program::catchInterrupts();
  program::Progress progress("drawing", options.quiet);
  for (std::size_t i = 0; i < positions.size() && !program::interrupted(); ++i) {
    video.add(snapshots.draw(playback.at(positions[i])));
    progress.update(i + 1, static_cast<double>(i + 1) / static_cast<double>(positions.size()));
  }
  video.finish();
}

/// The page is made from the folder's files; map and rawlog add keyframes and images.
void writePage(const Options& options, const FinishedReplay& replay, const Note& note) {
  report::ReplayPageOptions page;
  page.truth = options.truth;
  page.output = options.output;
  for (const auto& keyframe : replay.map.staticMap()->keyframes) {
    page.keyframes.push_back({keyframe.time, keyframe.T_map_robot});
  }
  report::RecordedImages images(replay.input, replay.frames.front().frame, note);
  report::PageImages small;
  for (const auto& frame : replay.frames) small.add(frame.frame, images.at(frame.frame));
  page.images = small.jpegs();
  report::writeReplayPage(options.input, page, note);
}

/// Draws the requested picture, video, scene, report or page.
void render(const Options& options) {
  program::requireWritable(options.output, options.overwrite, {options.input});
  const Note note = [&](const std::string& text) {
    if (!options.quiet) std::cerr << "headway-render: " << printable(text) << '\n';
  };
  if (options.kind == OutputKind::kReport) {
    program::writeTruthReport(options.input, options.truth, options.output, "", note);
    return;
  }
  const FinishedReplay replay = readReplay(options.input, note);
  if (options.kind == OutputKind::kReplayPage) return writePage(options, replay, note);
  report::ReplayTruth truth;
  if (!options.truth.empty()) {
    truth = report::readReplayTruth(options.truth, replay.frames, note);
  }
  if (options.kind == OutputKind::kVideo) {
    drawVideo(options, replay, std::move(truth), note);
  } else {
    drawPicture(options, replay, std::move(truth), note);
  }
}

}  // namespace
}  // namespace headway::render_program

int main(int argc, char** argv) {
  return headway::program::run("headway-render", [&] {
    headway::render_program::Options options;
    headway::program::CommandLine line("headway-render",
                                       "Draws a finished replay: the dense map, landmarks, the "
                                       "robot's path, boxes with ids, past paths and "
                                       "predictions.");
    headway::render_program::describe(options, line);
    if (!line.parse(argc, argv)) return headway::program::kDone;
    options.quiet = line.quiet();
    headway::render_program::resolve(options);
    headway::render_program::render(options);
    return headway::program::kDone;
  });
}
