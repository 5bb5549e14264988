// SPDX-License-Identifier: BSD-3-Clause
// Evaluation of predictors and of a replay's predictions.
#include <headway/core/error.h>
#include <headway/core/statistics.h>
#include <headway/eval/figures.h>
#include <headway/eval/labelled_frames.h>
#include <headway/eval/prediction_evaluation.h>
#include <headway/io/calibration_file.h>
#include <headway/io/track_file.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <tuple>

namespace headway::eval {
namespace {

Pose readExtrinsic(const std::string& path) {
  return path.empty() ? robotFromOptical() : io::readCalibration(path).T_robot_cam;
}

/// Rows of one file, grouped by frame and track.
std::vector<TrackPrediction> readPredictions(const std::string& path) {
  std::map<std::tuple<std::size_t, std::int64_t>, TrackPrediction> tracks;
  std::map<std::tuple<std::size_t, std::int64_t, int>, PredictedPath> paths;
  for (const auto& row : io::readPredictionCsv(path)) {
    if (!row.point.position.allFinite() || !row.point.covariance.allFinite() ||
        !std::isfinite(row.time + row.probability)) {
      throw InputError(path + ": frame " + std::to_string(row.frame) + ": a number is not finite");
    }
    auto& track = tracks[{row.frame, row.id.value}];
    track.frame = row.frame;
    track.time = row.time;
    track.id = row.id;
    track.object_class = row.object_class;
    auto& predicted = paths[{row.frame, row.id.value, row.mode}];
    predicted.mode = row.mode;
    predicted.probability = row.probability;
    predicted.points.push_back(row.point);
  }
  for (auto& [key, predicted] : paths) {
    const auto [frame, id, mode] = key;
    if (predicted.points.size() != kHorizons) {
      throw InputError(path + ": frame " + std::to_string(frame) + ", track " + std::to_string(id) +
                       ", mode " + std::to_string(mode) + " has " +
                       std::to_string(predicted.points.size()) +
                       " horizons; 0.1 s, 0.2 s ... 3.0 s are required");
    }
    std::sort(predicted.points.begin(), predicted.points.end(),
              [](const auto& a, const auto& b) { return a.horizon_s < b.horizon_s; });
    tracks[{frame, id}].paths.push_back(std::move(predicted));
  }
  std::vector<TrackPrediction> result;
  for (auto& [key, track] : tracks) result.push_back(std::move(track));
  return result;
}

/// Times of frames: those in the predictions, and evenly spaced times for the other frames.
class FrameTimes {
 public:
  explicit FrameTimes(const std::vector<TrackPrediction>& predictions) {
    for (const auto& prediction : predictions) known_[prediction.frame] = prediction.time;
    std::vector<double> intervals;
    for (auto it = known_.begin(); it != known_.end() && std::next(it) != known_.end(); ++it) {
      const auto [later_frame, later_time] = *std::next(it);
      intervals.push_back((later_time - it->second) / static_cast<double>(later_frame - it->first));
    }
    if (intervals.empty()) return;
    interval_ = median(std::move(intervals));
  }

  [[nodiscard]] double interval() const { return interval_; }

  [[nodiscard]] Time of(std::size_t frame) const {
    if (known_.empty()) return interval_ * static_cast<double>(frame);
    auto nearest = known_.lower_bound(frame);
    if (nearest == known_.end()) --nearest;
    return nearest->second +
           interval_ * (static_cast<double>(frame) - static_cast<double>(nearest->first));
  }

 private:
  std::map<std::size_t, Time> known_;
  double interval_ = kNominalFrameInterval_s;
};

double medianInterval(const std::vector<Stamped<Pose>>& poses) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    intervals.push_back(poses[i].time - poses[i - 1].time);
  }
  if (intervals.empty()) return kNominalFrameInterval_s;
  return median(std::move(intervals));
}

/// Reads the poses of all frames from a file with one row per frame.
void readPoses(const std::string& path, const Pose& T_robot_cam, PredictionSequence& sequence) {
  sequence.T_map_cam = readCameraPoses(path, T_robot_cam);
  if (poseFormatOf(path) == PoseFormat::kTum) {
    sequence.frame_interval_s = medianInterval(sequence.T_map_cam);
    for (const auto& prediction : sequence.predictions) {
      const bool exists = prediction.frame < sequence.T_map_cam.size();
      const double difference =
          exists ? std::abs(sequence.T_map_cam[prediction.frame].time - prediction.time) : 0.0;
      if (exists && difference < 0.5 * sequence.frame_interval_s) continue;
      throw InputError(path + ": row " + std::to_string(prediction.frame) +
                       " is not the pose of frame " + std::to_string(prediction.frame) +
                       "; the file must have one row per frame");
    }
    return;
  }
  const FrameTimes times(sequence.predictions);
  sequence.frame_interval_s = times.interval();
  for (std::size_t k = 0; k < sequence.T_map_cam.size(); ++k) {
    sequence.T_map_cam[k].time = times.of(k);
  }
}

PredictionSequence readSequence(const FilePair& files, const std::string& poses, bool with_estimate,
                                const Pose& T_robot_cam) {
  PredictionSequence sequence;
  sequence.name = files.name;
  if (with_estimate) sequence.predictions = readPredictions(files.estimate);
  readPoses(poses, T_robot_cam, sequence);
  try {
    sequence.objects = trueObjects(readLabels(files.truth), sequence.T_map_cam);
  } catch (const InputError& error) {
    throw InputError(files.truth + " and " + poses + ": " + error.what());
  }
  return sequence;
}

}  // namespace

std::vector<PredictionSequence> readPredictionInput(const PredictionFiles& files) {
  const Pose T_robot_cam = readExtrinsic(files.extrinsic);
  const bool with_estimate = !files.estimate.empty();
  const auto paired = with_estimate ? pairedFiles(files.labels, files.estimate)
                                    : pairedFiles(files.labels, files.poses);
  std::vector<PredictionSequence> sequences;
  for (const auto& pair : paired.pairs) {
    const auto poses = with_estimate ? fileNamed(pair.name, files.poses) : pair.estimate;
    sequences.push_back(readSequence(pair, poses, with_estimate, T_robot_cam));
  }
  return sequences;
}

namespace {

/// Which predictions are drawn.
struct Drawing {
  std::size_t every = 15;     ///< frames between predictions of an object
  std::size_t max = 50;       ///< more would cover the paths
  double min_length_m = 1.0;  ///< shorter ones are not drawn
};
constexpr Drawing kDrawing{};

std::string errorPair(const PredictionError& error) {
  return plot::fixedText(error.ade_m, 3) + " / " + plot::fixedText(error.fde_m, 3);
}

/// An evenly spaced sample, small enough for one picture.
std::vector<DrawnPrediction> thinned(const std::vector<DrawnPrediction>& all) {
  std::vector<DrawnPrediction> kept;
  const std::size_t count = std::min(kDrawing.max, all.size());
  for (std::size_t i = 0; i < count; ++i) kept.push_back(all[i * all.size() / count]);
  return kept;
}

/// Intervals of a quantity: below limits[0], from there to limits[1] ... above the last.
struct Intervals {
  std::vector<double> limits;
  std::string unit;

  [[nodiscard]] std::size_t of(double value) const {
    return static_cast<std::size_t>(std::upper_bound(limits.begin(), limits.end(), value) -
                                    limits.begin());
  }
  [[nodiscard]] std::vector<std::string> names() const {
    const auto text = [&](std::size_t i) { return plot::fixedText(limits[i], 1); };
    std::vector<std::string> result = {"below " + text(0) + " " + unit};
    for (std::size_t i = 1; i < limits.size(); ++i) {
      result.push_back(text(i - 1) + " to " + text(i) + " " + unit);
    }
    result.push_back("from " + text(limits.size() - 1) + " " + unit);
    return result;
  }
};
const Intervals kSpeeds{{0.5, 2.0, 4.0, 8.0, 16.0}, "m/s"};
const Intervals kRanges{{10.0, 20.0, 30.0, 50.0}, "m"};
constexpr std::size_t kSecond = 9;  // index of 1.0 s

/// How an object goes on, by its truth.
enum Course : std::size_t { kStands, kStraightOn, kTurns };
const std::vector<std::string> kCourses = {"stands", "straight on", "turns"};

struct CourseLimits {
  double half_s = 0.5;        ///< of the ways before and after
  std::size_t half_s_on = 4;  ///< index of that horizon
  double walking_mps = 0.3;   ///< slower: weight is shifted from foot to foot
  double turn_rad = 0.35;     ///< 40 degrees a second
};
constexpr CourseLimits kCourse;

/// True speed over the first second after the prediction [m/s].
double speedOf(const HorizonPath& future) {
  return (future[kSecond] - future.front()).norm() / (kHorizonStep_s * kSecond);
}

/// By the ways in the half seconds before and after; a place before it appeared is not known.
Course courseOf(const TrueObject& object, Time now, const HorizonPath& future) {
  const auto before = object.positionAt(now - kCourse.half_s, kCourse.half_s);
  const auto here = object.positionAt(now, kCourse.half_s);
  if (!before || !here) return speedOf(future) < kCourse.walking_mps ? kStands : kStraightOn;
  const Eigen::Vector2d to = (*here - *before).head<2>();
  const Eigen::Vector2d on = future[kCourse.half_s_on] - here->head<2>();
  if (to.norm() + on.norm() < 2.0 * kCourse.half_s * kCourse.walking_mps) return kStands;
  const double cross = to.x() * on.y() - to.y() * on.x();
  return std::abs(std::atan2(cross, to.dot(on))) > kCourse.turn_rad ? kTurns : kStraightOn;
}

/// Cases of each class in named groups.
class GroupedCases {
 public:
  explicit GroupedCases(std::vector<std::string> names) : names_(std::move(names)) {}

  void add(ObjectClass object_class, std::size_t group, const std::vector<PredictedPath>& paths,
           const HorizonPath& future) {
    cases_[{object_class, group}].add(object_class, paths, future);
  }

  void appendTo(std::vector<PredictionGroup>& groups) const {
    for (const auto& [key, evaluator] : cases_) {
      groups.push_back(
          {std::string(toString(key.first)) + ", " + names_[key.second], evaluator.errors()});
    }
  }

 private:
  std::vector<std::string> names_;
  std::map<std::pair<ObjectClass, std::size_t>, PredictionEvaluator> cases_;
};

/// Collects the cases of consecutive sequences.
class CaseCollector {
 public:
  explicit CaseCollector(std::string name) { result_.name = std::move(name); }

  void begin() {
    sequence_ = {};
    drawn_.clear();
  }

  void add(ObjectClass object_class, Course course, std::size_t object, std::size_t frame,
           const Eigen::Vector3d& now, const std::vector<PredictedPath>& paths,
           const HorizonPath& future, const Pose& T_map_cam) {
    sequence_.add(object_class, paths, future);
    by_speed_.add(object_class, kSpeeds.of(speedOf(future)), paths, future);
    const double range = (T_map_cam.translation().head<2>() - future.front()).norm();
    by_range_.add(object_class, kRanges.of(range), paths, future);
    by_course_.add(object_class, course, paths, future);
    const bool moves = (paths.front().points.back().position - now).norm() > kDrawing.min_length_m;
    if (moves && frame % kDrawing.every == 0) drawn_.push_back({object, now.head<2>(), paths});
  }

  void end(const std::string& name, std::size_t index) {
    const auto errors = sequence_.errors();
    if (errors.all.cases > max_cases_) {
      max_cases_ = errors.all.cases;
      result_.drawn = thinned(drawn_);
      result_.drawn_sequence = index;
    }
    result_.sequences.emplace_back(name, errors);
    all_.add(sequence_);
  }

  [[nodiscard]] EvaluatedPredictor result() {
    result_.errors = all_.errors();
    result_.evaluator = all_;
    by_speed_.appendTo(result_.groups);
    by_range_.appendTo(result_.groups);
    by_course_.appendTo(result_.groups);
    return std::move(result_);
  }

 private:
  EvaluatedPredictor result_;
  PredictionEvaluator all_;
  PredictionEvaluator sequence_;
  GroupedCases by_speed_{kSpeeds.names()};
  GroupedCases by_range_{kRanges.names()};
  GroupedCases by_course_{kCourses};
  std::vector<DrawnPrediction> drawn_;
  std::size_t max_cases_ = 0;
};

}  // namespace

EvaluatedPredictor evaluatePredictor(const std::vector<PredictionSequence>& sequences,
                                     const std::string& name,
                                     const objects::PredictorParams& params) {
  const auto predictor = objects::makePredictor(objects::predictorKindFrom(name), params);
  CaseCollector collector(name);
  std::vector<PredictedPath> paths;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    collector.begin();
    const auto& truth = sequences[s].objects;
    for (auto& item : historyCases(truth, sequences[s].frame_interval_s)) {
      const auto object_class = truth[item.object].object_class;
      const auto now = item.history.back();
      predictor->predictInto({object_class, std::move(item.history)}, paths);
      collector.add(object_class, courseOf(truth[item.object], now.time, item.future), item.object,
                    now.frame, now.position, paths, item.future,
                    sequences[s].T_map_cam[now.frame].value);
    }
    collector.end(sequences[s].name, s);
  }
  return collector.result();
}

EvaluatedPredictor evaluateEstimate(const std::vector<PredictionSequence>& sequences) {
  CaseCollector collector("predictions");
  std::size_t unmatched = 0;
  std::size_t cut_short = 0;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    collector.begin();
    const auto& predictions = sequences[s].predictions;
    const auto found = trackCases(sequences[s].objects, predictions, kMatchDistance_m,
                                  2.5 * sequences[s].frame_interval_s);
    unmatched += found.unmatched;
    cut_short += found.cut_short;
    for (const auto& item : found.cases) {
      const auto& prediction = predictions[item.prediction];
      const auto& first = prediction.paths.front().points.front().position;
      const Course course =
          courseOf(sequences[s].objects[item.object], prediction.time, item.future);
      collector.add(prediction.object_class, course, item.object, prediction.frame, first,
                    prediction.paths, item.future, sequences[s].T_map_cam[prediction.frame].value);
    }
    collector.end(sequences[s].name, s);
  }
  auto result = collector.result();
  result.not_evaluated = {{"no object of their class is near", unmatched},
                          {"the truth ends within 3 s", cut_short}};
  return result;
}

void requireCases(const EvaluatedPredictor& predictor, const std::string& labels) {
  if (predictor.errors.all.cases > 0) return;
  throw InputError(labels +
                   ": nothing to evaluate: no object is labelled for 2 s before and 3 s after a "
                   "frame, or no prediction is near one");
}

nlohmann::ordered_json toJson(const EvaluatedPredictor& predictor) {
  auto json = toJson(predictor.errors);
  for (const auto& [name, errors] : predictor.sequences) {
    json["sequences"][name] = toJson(errors);
  }
  for (const auto& group : predictor.groups) {
    json["groups"][group.name] = toJson(group.errors).at("all");
  }
  for (const auto& [reason, count] : predictor.not_evaluated) json["not_judged"][reason] = count;
  return json;
}

plot::TextTable predictorTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table;
  for (const auto& predictor : predictors) {
    auto rows = tableOf(predictor.errors);
    if (table.empty()) {
      table.push_back(rows.front());
      table.front().front() = "predictor";
    }
    table.push_back(rows.back());  // all classes
    table.back().front() = predictor.name;
  }
  return table;
}

plot::TextTable classTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table = {{"predictor"}};
  for (const auto& [object_class, error] : predictors.front().errors.classes) {
    table.front().push_back(std::string(toString(object_class)) + " (" +
                            std::to_string(error.cases) + ")");
  }
  for (const auto& predictor : predictors) {
    table.push_back({predictor.name});
    for (const auto& [object_class, error] : predictor.errors.classes) {
      table.back().push_back(errorPair(error));
    }
  }
  return table;
}

plot::TextTable coverageTable(const EvaluatedPredictor& predictor) {
  plot::TextTable table = {
      {"cases of", "cases", "ADE m", "FDE m", "in 90% 1s", "in 90% 2s", "in 90% 3s"}};
  const auto add = [&table](const std::string& name, const PredictionError& error) {
    table.push_back({name, std::to_string(error.cases), plot::fixedText(error.ade_m, 3),
                     plot::fixedText(error.fde_m, 3)});
    for (const auto& ratio : error.coverage[1]) {  // of the 90 % ellipse
      table.back().push_back(plot::percentText(ratio, 1));
    }
  };
  for (const auto& [name, errors] : predictor.sequences) {
    if (errors.all.cases > 0) add("sequence " + name, errors.all);
  }
  for (const auto& group : predictor.groups) add(group.name, group.errors.all);
  add("all", predictor.errors.all);
  return table;
}

plot::TextTable sequenceTable(const std::vector<EvaluatedPredictor>& predictors) {
  plot::TextTable table = {{"sequence"}};
  for (const auto& predictor : predictors) table.front().push_back(predictor.name);
  for (std::size_t s = 0; s < predictors.front().sequences.size(); ++s) {
    const auto& [name, first] = predictors.front().sequences[s];
    table.push_back({name + " (" + std::to_string(first.all.cases) + ")"});
    for (const auto& predictor : predictors) {
      table.back().push_back(errorPair(predictor.sequences[s].second.all));
    }
  }
  return table;
}

}  // namespace headway::eval
