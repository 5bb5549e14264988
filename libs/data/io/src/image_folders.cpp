// SPDX-License-Identifier: BSD-3-Clause
// Images of two cameras as a recording: a stereo pair, apart or side by side, or images with depth;
// and what their times are.
#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/calibration_file.h>
#include <headway/io/dataset.h>
#include <headway/io/raw_camera.h>
#include <headway/io/rawlog_source.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include "image_files.h"
#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr double kAssumedRateHz = 10.0;     // of images without times
constexpr double kYear2000 = 946684800.0;   // in Unix time [s]: earlier numbers are counters
constexpr double kYear2100 = 4102444800.0;  // below it the units of a number are told apart
constexpr char kTimesFile[] = "times.txt";

/// The last number in a file's name as Unix time in s, ms, µs or ns; nullopt if it is none, and the
/// units per second otherwise.
std::optional<std::array<double, 2>> timeInName(const std::string& path) {
  const std::string name = fs::path(path).stem().string();
  const std::size_t end = name.find_last_of("0123456789");
  if (end == std::string::npos) return std::nullopt;
  std::size_t begin = name.find_last_not_of("0123456789.", end);
  begin = name.find_first_not_of('.', begin == std::string::npos ? 0 : begin + 1);
  const auto number = parseNumber(name.substr(begin, end + 1 - begin));
  if (!number) return std::nullopt;
  for (const double units : {1.0, 1e3, 1e6, 1e9}) {
    const double seconds = *number / units;
    if (seconds >= kYear2000 && seconds < kYear2100) return std::array{seconds, units};
  }
  return std::nullopt;
}

/// The images of a folder.
class ImageFolder : public ImageSequence {
 public:
  explicit ImageFolder(const std::string& folder) : folder_(folder), paths_(imagesIn(folder)) {
    for (const fs::path& place : {fs::path(folder), fs::path(folder).parent_path()}) {
      const fs::path file = place / kTimesFile;
      if (!times_file_.empty() || !fs::is_regular_file(file)) continue;
      times_ = readTimes(file.string());
      times_file_ = file.string();
    }
    if (times_.size() > size()) times_.resize(size());
    if (times_file_.empty()) readNames();
  }

  [[nodiscard]] const std::string& name() const override { return folder_; }
  [[nodiscard]] std::size_t size() const override { return paths_.size(); }
  [[nodiscard]] std::string nameOf(std::size_t index) const override { return paths_.at(index); }
  [[nodiscard]] cv::Mat image(std::size_t index) const override {
    return requireImage(paths_.at(index));
  }
  [[nodiscard]] const std::vector<Time>& times() const override { return times_; }
  [[nodiscard]] std::string timesFile() const override { return times_file_; }

 private:
  /// Takes the times and their order from the names, if all have one, of one unit and each its own.
  void readNames() {
    std::vector<std::pair<Time, std::string>> named;
    double unit = 0.0;
    for (const auto& path : paths_) {
      const auto time = timeInName(path);
      if (!time || (unit != 0.0 && unit != (*time)[1])) return;
      unit = (*time)[1];
      named.emplace_back((*time)[0], path);
    }
    std::sort(named.begin(), named.end());
    for (std::size_t i = 1; i < named.size(); ++i) {
      if (!(named[i].first > named[i - 1].first)) return;
    }
    for (std::size_t i = 0; i < named.size(); ++i) {
      times_.push_back(named[i].first);
      paths_[i] = named[i].second;
    }
  }

  std::string folder_;
  std::vector<std::string> paths_;
  std::vector<Time> times_;
  std::string times_file_;
};

/// Whether each image has a time.
bool hasTimes(const ImageSequence& images) {
  return !images.times().empty() && images.times().size() == images.size();
}

/// Images of two cameras that belong together, and when they were taken.
class ImagePairs {
 public:
  /// @param max_gap_s  of images that are paired by time
  /// @throws InputError if there is no pair, or the numbers of images that are paired by order
  /// differ
  ImagePairs(const ImageSequence& left, const ImageSequence& other, const ImageTimes& stated,
             double max_gap_s) {
    if (left.size() == 0) throw InputError(left.name() + ": contains no images");
    const bool is_rate_stated = stated.rate_hz > 0.0;
    const bool are_stated = is_rate_stated || !stated.file.empty();
    for (const ImageSequence* side : {&left, &other}) {
      if (!are_stated && !side->timesFile().empty()) {
        requireTimesFor(side->size(), side->timesFile(), side->times());
      }
    }
    const bool have_times = hasTimes(left) && hasTimes(other);
    if (have_times) {
      pairByTime(left, other, max_gap_s);
    } else {
      pairByOrder(left, other);
    }
    if (!stated.file.empty()) {
      times_ = readTimes(stated.file);
      requireTimesFor(left.size(), stated.file, times_);
    } else if (!is_rate_stated && !left.times().empty()) {
      times_ = left.times();
    } else if (!is_rate_stated && !other.times().empty()) {
      times_ = other.times();
    } else {
      is_assumed_ = !is_rate_stated;
      const double rate_hz = is_rate_stated ? stated.rate_hz : kAssumedRateHz;
      for (std::size_t i = 0; i < left.size(); ++i) {
        times_.push_back(static_cast<double>(i) / rate_hz);
      }
    }
    if (have_times) noteUnpaired(left.times(), other.times());
  }

  [[nodiscard]] std::size_t size() const { return pairs_.size(); }
  [[nodiscard]] std::size_t left(std::size_t index) const { return pairs_.at(index)[0]; }
  [[nodiscard]] std::size_t other(std::size_t index) const { return pairs_.at(index)[1]; }
  [[nodiscard]] Time time(std::size_t index) const { return times_.at(left(index)); }
  [[nodiscard]] bool isAssumed() const { return is_assumed_; }
  /// Times of images without partner.
  [[nodiscard]] std::map<std::string, std::vector<Time>> dropped() const {
    return {{"unpaired_image", unpaired_}};
  }

 private:
  void pairByTime(const ImageSequence& left, const ImageSequence& other, double max_gap_s) {
    const auto& times = left.times();
    const auto& others = other.times();
    for (const auto* side : {&left, &other}) {
      if (std::is_sorted(side->times().begin(), side->times().end())) continue;
      throw InputError(side->name() + ": the times of its images do not increase");
    }
    pairs_ = pairedByTime(times, others, max_gap_s);
    if (!pairs_.empty()) return;
    double nearest = std::abs(others.front() - times.front());
    for (const Time time : times) {
      const auto after = std::lower_bound(others.begin(), others.end(), time);
      if (after != others.end()) nearest = std::min(nearest, *after - time);
      if (after != others.begin()) nearest = std::min(nearest, time - *(after - 1));
    }
    throw InputError(left.name() + " and " + other.name() +
                     formatted(": their images are %.3g s apart or more, allowed are %g s: the "
                               "cameras are not synchronised, or their clocks differ",
                               nearest, max_gap_s));
  }

  /// Images without partner have the time of the left image next to them, as it counts here.
  void noteUnpaired(const std::vector<Time>& lefts, const std::vector<Time>& others) {
    unpaired_ = unpairedTimes(times_, pairs_, 0);
    for (const Time time : unpairedTimes(others, pairs_, 1)) {
      const auto next = std::lower_bound(lefts.begin(), lefts.end(), time);
      const auto index = static_cast<std::size_t>(next - lefts.begin());
      unpaired_.push_back(times_.at(std::min(index, lefts.size() - 1)));
    }
  }

  void pairByOrder(const ImageSequence& left, const ImageSequence& other) {
    if (left.size() != other.size()) {
      throw InputError(left.name() + " contains " + std::to_string(left.size()) + " images and " +
                       other.name() + " " + std::to_string(other.size()) +
                       "; without times both must contain the same number");
    }
    for (std::size_t i = 0; i < left.size(); ++i) pairs_.push_back({i, i});
  }

  std::vector<std::array<std::size_t, 2>> pairs_;  ///< indices of left and other image
  std::vector<Time> times_;                        ///< of the left images
  bool is_assumed_ = false;
  std::vector<Time> unpaired_;
};

/// Times that the user states, else those that a calibration, `file` read from `path`, states.
template <typename CalibrationFile>
ImageTimes statedTimes(const ImageTimes& by_user, const CalibrationFile& file,
                       const std::string& path) {
  if (by_user.rate_hz > 0.0 || !by_user.file.empty()) return by_user;
  if (file.times.empty()) return {file.frame_rate, ""};
  return {0.0, (fs::path(path).parent_path() / file.times).string()};
}

Warnings warningsOf(const ImagePairs& pairs) {
  Warnings warnings;
  if (pairs.isAssumed()) addWarning(kTimesAssumed, 0, kTimesAssumedText, warnings);
  return warnings;
}

class StereoImages : public Dataset {
 public:
  StereoImages(std::unique_ptr<ImageSequence> left, std::unique_ptr<ImageSequence> right,
               const std::string& calibration, const ImageTimes& times)
      : left_(std::move(left)), right_(std::move(right)) {
    if (left_->size() == 0) throw InputError(left_->name() + ": contains no images");
    const cv::Mat first = left_->image(0);
    const int width = right_ == nullptr ? first.cols / 2 : first.cols;
    const auto file = readStereoCalibration(calibration, {width, first.rows});
    camera_ = file.camera;
    requireSizeOfImages(calibration, width, first.rows);
    pairs_.emplace(*left_, right_ == nullptr ? *left_ : *right_,
                   statedTimes(times, file, calibration), RawlogSourceOptions().pair_tolerance_s);
  }

  [[nodiscard]] std::size_t size() const override { return pairs_->size(); }

  [[nodiscard]] DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = pairs_->time(index);
    frame.left = left_->image(pairs_->left(index));
    if (right_ != nullptr) {
      frame.right = right_->image(pairs_->other(index));
      return frame;
    }
    frame.right = halfOf(frame.left, true);
    frame.left = halfOf(frame.left, false);
    return frame;
  }

  [[nodiscard]] std::optional<RawStereoCamera> camera() const override { return camera_; }
  [[nodiscard]] std::map<std::string, std::vector<Time>> droppedTimes() const override {
    return pairs_->dropped();
  }
  [[nodiscard]] Warnings warnings() const override { return warningsOf(*pairs_); }

 private:
  void requireSizeOfImages(const std::string& calibration, int width, int height) const {
    if (camera_.left.width == width && camera_.left.height == height) return;
    const bool is_double = right_ != nullptr && width == 2 * camera_.left.width;
    throw InputError(calibration + ": is of images of " + std::to_string(camera_.left.width) + "x" +
                     std::to_string(camera_.left.height) + " px, but " + left_->nameOf(0) +
                     " has " + std::to_string(width) + "x" + std::to_string(height) +
                     (is_double ? "; --side-by-side splits images that contain both" : ""));
  }

  std::unique_ptr<ImageSequence> left_;
  std::unique_ptr<ImageSequence> right_;  ///< null: the left images contain both, side by side
  RawStereoCamera camera_;
  std::optional<ImagePairs> pairs_;
};

class DepthFolders : public Dataset {
 public:
  DepthFolders(const std::string& left_folder, const std::string& depth_folder,
               const std::string& calibration, const ImageTimes& times)
      : left_(left_folder), depth_(depth_folder) {
    const auto file = readDepthCalibration(calibration);
    camera_ = file.camera;
    pairs_.emplace(left_, depth_, statedTimes(times, file, calibration), kMaxDepthGapS);
  }

  [[nodiscard]] std::size_t size() const override { return pairs_->size(); }

  [[nodiscard]] DatasetFrame frame(std::size_t index) const override {
    DatasetFrame frame;
    frame.time = pairs_->time(index);
    frame.left = requireImageOf(left_.nameOf(pairs_->left(index)), camera_.color);
    frame.depth = requireDepthImageOf(depth_.nameOf(pairs_->other(index)), camera_.depth);
    return frame;
  }

  [[nodiscard]] std::optional<RawStereoCamera> camera() const override {
    return leftAlone(camera_);
  }
  [[nodiscard]] std::optional<RawDepthCamera> depthCamera() const override { return camera_; }
  [[nodiscard]] std::map<std::string, std::vector<Time>> droppedTimes() const override {
    return pairs_->dropped();
  }
  [[nodiscard]] Warnings warnings() const override { return warningsOf(*pairs_); }

 private:
  ImageFolder left_, depth_;
  RawDepthCamera camera_;
  std::optional<ImagePairs> pairs_;
};

}  // namespace

std::unique_ptr<ImageSequence> imagesOfFolder(const std::string& folder) {
  return std::make_unique<ImageFolder>(folder);
}

std::unique_ptr<Dataset> openStereoImages(std::unique_ptr<ImageSequence> left,
                                          std::unique_ptr<ImageSequence> right,
                                          const std::string& calibration, const ImageTimes& times) {
  return std::make_unique<StereoImages>(std::move(left), std::move(right), calibration, times);
}

std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                          const std::string& right_folder,
                                          const std::string& calibration, const ImageTimes& times) {
  return openStereoImages(imagesOfFolder(left_folder), imagesOfFolder(right_folder), calibration,
                          times);
}

std::unique_ptr<Dataset> openDepthFolders(const std::string& left_folder,
                                          const std::string& depth_folder,
                                          const std::string& calibration, const ImageTimes& times) {
  return std::make_unique<DepthFolders>(left_folder, depth_folder, calibration, times);
}

}  // namespace headway::io
