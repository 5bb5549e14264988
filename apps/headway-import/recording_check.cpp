// SPDX-License-Identifier: BSD-3-Clause
// Checks of a recording: rates, gaps and clocks of its sensors, exposure, blur, rows and
// registration of its images, and the camera's mounting.
#include "recording_check.h"

#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/core/pose.h>
#include <headway/core/statistics.h>
#include <headway/core/text.h>
#include <headway/io/mrpt_time.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <headway/pipeline/perception.h>
#include <headway/program/progress.h>
#include <mrpt/obs/CObservation3DRangeScan.h>
#include <mrpt/obs/CObservationIMU.h>
#include <mrpt/obs/CObservationImage.h>
#include <mrpt/obs/CObservationStereoImages.h>
#include <unistd.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <limits>
#include <map>
#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "registration_check.h"

namespace headway::import {
namespace {

enum class Rating { kOk, kUnknown, kWarning, kBad };

/// One line of a check.
struct CheckItem {
  std::string name;
  std::string value;
  Rating rating = Rating::kOk;
  std::string advice;  ///< cause and what to do; empty if it is ok
};

/// The rating of a value that should be low.
Rating ratingOf(double value, double warning, double bad) {
  if (value > bad) return Rating::kBad;
  return value > warning ? Rating::kWarning : Rating::kOk;
}

/// An angular velocity of an inertial sensor, robot frame.
struct RotationSample {
  Time time = 0.0;
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();  ///< [rad/s]
};

/// Times of all sensors of a recording: rates, gaps, clocks, and offsets of left and right images.
class TimeCheck {
 public:
  /// @param sensor_label  stereo camera to check, `LEFT,RIGHT` of single images; may be empty
  explicit TimeCheck(std::string sensor_label) : sensor_label_(std::move(sensor_label)) {}

  void add(const mrpt::obs::CObservation& observation);
  [[nodiscard]] std::vector<CheckItem> items() const;
  /// Number of images, of pairs or single.
  [[nodiscard]] std::size_t images() const { return images_; }
  /// Up to 200,000 samples of the gyroscope.
  [[nodiscard]] const std::vector<RotationSample>& rotations() const { return rotations_; }

 private:
  struct Sensor {
    bool is_needed = false;  ///< images or an IMU
    std::size_t count = 0;
    std::size_t without_time = 0;
    std::size_t backwards = 0;
    Time last = 0.0;
    std::vector<float> intervals;  ///< up to 200,000 [s]
    std::vector<Time> times;       ///< of single images, up to 200,000
    std::optional<Time> newest;    ///< since the last image
    std::vector<float> offsets;    ///< from the images between which it came, up to 200,000 [s]
  };
  using Name = std::pair<std::string, std::string>;  ///< label and class
  void compareClocks(const Name& image, Time time);
  void addRotation(Time time, const mrpt::obs::CObservationIMU& imu);
  [[nodiscard]] static CheckItem rateOf(const Name& name, const Sensor& sensor);
  [[nodiscard]] bool isChosen(const std::string& label) const;
  [[nodiscard]] static CheckItem pairOffset(const std::string& labels,
                                            std::vector<double> distances);

  std::string sensor_label_;
  std::map<Name, Sensor> sensors_;
  std::optional<Name> first_camera_;    ///< that other sensors' clocks are compared with
  std::optional<Time> last_image_;      ///< of that camera
  std::size_t of_further_sensors_ = 0;  ///< observations
  std::vector<RotationSample> rotations_;
  std::size_t images_ = 0;
};

constexpr std::size_t kMaxSamples = 200000;
constexpr std::size_t kMaxSensors = 200;
const double kPairTolerance = io::RawlogSourceOptions().pair_tolerance_s;
constexpr double kMaxRate = 1000.0;  // of rotation [rad/s]
constexpr double kSlowSensor = 0.2;  // latency after which places no longer fit the images [s]
constexpr double kOtherClock = 1.0;  // of headway's readers: latencies are shorter [s]

std::string classNameOf(const mrpt::obs::CObservation& observation) {
  const std::string name = observation.GetRuntimeClass()->className;
  return name.substr(name.rfind(':') + 1);
}

/// Distances of times from the nearest of others, both ascending, with their sign.
std::vector<double> offsets(const std::vector<Time>& times, const std::vector<Time>& others) {
  std::vector<double> result;
  for (const Time time : times) {
    const auto after = std::lower_bound(others.begin(), others.end(), time);
    double best = after != others.end() ? *after - time : 1e9;
    if (after != others.begin() && time - *(after - 1) < std::abs(best)) best = *(after - 1) - time;
    result.push_back(best);
  }
  return result;
}

/// States how far a sensor's times are from those of the images that arrive with them.
void addClock(const std::vector<float>& offsets, CheckItem& item) {
  const double offset = median(std::vector<double>(offsets.begin(), offsets.end()));
  item.value += formatted(", %+.3f s from the images", offset);
  const Rating rating = ratingOf(std::abs(offset), kSlowSensor, kOtherClock);
  if (rating <= item.rating) return;
  item.rating = rating;
  item.advice =
      "its times are not those of the images that arrive with it: use one clock (chrony), and "
      "times of capture";
}

void TimeCheck::add(const mrpt::obs::CObservation& observation) {
  if (observation.sensorLabel == io::kTimesAssumed) return;  // said by the images' reader
  const std::string class_name = classNameOf(observation);
  const auto& label = observation.sensorLabel;
  const std::pair<std::string, std::string> key{label.empty() ? class_name : label, class_name};
  if (sensors_.size() >= kMaxSensors && sensors_.count(key) == 0) {
    ++of_further_sensors_;
    return;
  }
  Sensor& sensor = sensors_[key];
  const auto* imu = dynamic_cast<const mrpt::obs::CObservationIMU*>(&observation);
  sensor.is_needed = isAnyImage(observation) || imu != nullptr;
  ++sensor.count;
  images_ += isAnyImage(observation) ? 1 : 0;
  if (observation.timestamp == INVALID_TIMESTAMP) {
    ++sensor.without_time;
    return;
  }
  const Time time = io::timeFrom(observation.timestamp);
  if (sensor.count - sensor.without_time > 1) {
    if (time <= sensor.last) ++sensor.backwards;
    if (sensor.intervals.size() < kMaxSamples) {
      sensor.intervals.push_back(static_cast<float>(time - sensor.last));
    }
  }
  sensor.last = time;
  sensor.newest = time;
  if (isAnyImage(observation)) compareClocks(key, time);
  if (isAnyImage(observation) && sensor.times.size() < kMaxSamples) sensor.times.push_back(time);
  if (imu != nullptr) addRotation(time, *imu);
}

/// How far the times of what arrived between two images are from the time between these.
void TimeCheck::compareClocks(const Name& image, Time time) {
  if (!first_camera_) first_camera_ = image;
  if (*first_camera_ != image) return;
  const auto before = std::exchange(last_image_, time);
  for (auto& [name, sensor] : sensors_) {
    const auto newest = std::exchange(sensor.newest, std::nullopt);
    if (!before || !newest || name == image || sensor.offsets.size() >= kMaxSamples) continue;
    const Time nearest = std::clamp(*newest, std::min(*before, time), std::max(*before, time));
    sensor.offsets.push_back(static_cast<float>(*newest - nearest));
  }
}

void TimeCheck::addRotation(Time time, const mrpt::obs::CObservationIMU& imu) {
  using namespace mrpt::obs;  // names of the IMU's fields
  if (rotations_.size() >= kMaxSamples || !imu.has(IMU_WX) || !imu.has(IMU_WY) ||
      !imu.has(IMU_WZ)) {
    return;
  }
  const Eigen::Vector3d rate = fromMrpt(imu.sensorPose).linear() *
                               Eigen::Vector3d(imu.get(IMU_WX), imu.get(IMU_WY), imu.get(IMU_WZ));
  if (rate.norm() < kMaxRate) rotations_.push_back({time, rate});
}

CheckItem TimeCheck::rateOf(const Name& name, const Sensor& sensor) {
  CheckItem item{"times of " + name.first + " (" + name.second + ")", "", Rating::kOk, ""};
  if (sensor.without_time > 0) {
    item.value = formatted("%zu of %zu without a time", sensor.without_time, sensor.count);
    item.rating = Rating::kBad;
    item.advice = "the driver sets no timestamps: set them to the capture's time";
    return item;
  }
  const std::vector<double> intervals(sensor.intervals.begin(), sensor.intervals.end());
  const double usual = median(intervals);
  const double longest =
      intervals.empty() ? 0.0 : *std::max_element(intervals.begin(), intervals.end());
  const auto gaps = std::count_if(intervals.begin(), intervals.end(),
                                  [&](double interval) { return interval > 2.5 * usual; });
  item.value = formatted("%zu, %.2f Hz, longest gap %.3f s, %zd gaps", sensor.count,
                         usual > 0.0 ? 1.0 / usual : 0.0, longest, gaps);
  const double ratio =
      static_cast<double>(gaps) / std::max(1.0, static_cast<double>(intervals.size()));
  if (sensor.backwards > 0) {
    item.rating = Rating::kBad;
    item.advice = formatted(
        "%zu times are not after the one before: the clock was set, or two sensors "
        "share a label; slew clocks (chrony), give labels",
        sensor.backwards);
  } else if (gaps > 0) {
    const bool is_bad = sensor.is_needed && (longest > 1.0 || ratio > 0.05);
    item.rating = is_bad ? Rating::kBad : Rating::kWarning;
    item.advice = "samples are missing: check bandwidth, disk and driver";
  }
  if (!sensor.offsets.empty()) addClock(sensor.offsets, item);
  return item;
}

std::vector<CheckItem> TimeCheck::items() const {
  std::vector<CheckItem> items;
  std::vector<std::pair<std::string, const Sensor*>> single;  // images, with their labels
  for (const auto& [name, sensor] : sensors_) {
    if (name.first.rfind("truth_", 0) != 0) items.push_back(rateOf(name, sensor));
    if (name.second == "CObservationImage" && isChosen(name.first)) {
      single.emplace_back(name.first, &sensor);
    }
  }
  if (of_further_sensors_ > 0) {
    items.push_back({"further sensors", formatted("%zu observations", of_further_sensors_),
                     Rating::kWarning, formatted("only %zu sensors are checked", kMaxSensors)});
  }
  // Which of more than two belong together, --sensor-label tells.
  if (single.size() == 2 && !single[0].second->times.empty() && !single[1].second->times.empty()) {
    items.push_back(pairOffset(single[0].first + " and " + single[1].first,
                               offsets(single[0].second->times, single[1].second->times)));
  }
  return items;
}

/// Whether images with this label are those to check.
bool TimeCheck::isChosen(const std::string& label) const {
  return sensor_label_.empty() ||
         ("," + sensor_label_ + ",").find("," + label + ",") != std::string::npos;
}

CheckItem TimeCheck::pairOffset(const std::string& labels, std::vector<double> distances) {
  const double middle = median(distances);
  for (double& distance : distances) distance = std::abs(distance);
  const double usual = median(distances), most = percentile(distances, 0.95);
  CheckItem item{"times between " + labels,
                 formatted("median %+.1f ms, 95 %% within %.1f ms", 1e3 * middle, 1e3 * most),
                 ratingOf(most, 0.002, kPairTolerance), ""};
  if (usual > kPairTolerance) {
    item.advice = formatted(
        "the images of a pair are %.0f ms apart, allowed are %.0f ms: trigger both cameras "
        "together",
        1e3 * usual, 1e3 * kPairTolerance);
  } else if (item.rating != Rating::kOk) {
    item.advice = "the cameras are not triggered together: moving things get a wrong depth";
  }
  return item;
}

/// Rotation of a camera between two images.
struct RotationStep {
  Time begin = 0.0, end = 0.0;
  Eigen::Vector3d turn = Eigen::Vector3d::Zero();  ///< from begin to end, camera frame [rad]
};

struct ClockOffset {
  double offset_s = 0.0;  ///< of the inertial sensor's times against the images'
  double correlation = 0.0;
};

constexpr double kMaxOffset = 0.5;  // [s]
constexpr double kStep = 0.001;     // [s]
constexpr std::size_t kMinSteps = 20;
constexpr double kMinDeviation = 0.02;  // of the rates [rad/s]
constexpr double kMinCorrelation = 0.7;
constexpr double kMaxSampleGap = 0.25;  // [s]

/// The gyroscope's rotation vector, summed from its start and interpolated between samples. Steps
/// are short, so that their rotations commute to 1 %.
class RotationSum {
 public:
  explicit RotationSum(const std::vector<RotationSample>& samples) {
    for (const auto& sample : samples) {
      if (!times_.empty() && sample.time <= times_.back()) continue;
      const double dt = times_.empty() ? 0.0 : sample.time - times_.back();
      sums_.push_back(times_.empty()
                          ? Eigen::Vector3d(Eigen::Vector3d::Zero())
                          : Eigen::Vector3d(sums_.back() + 0.5 * dt * (sample.rate + last_rate_)));
      times_.push_back(sample.time);
      last_rate_ = sample.rate;
    }
  }

  /// nullopt beyond the samples and in gaps.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(Time time) const {
    const auto after = std::lower_bound(times_.begin(), times_.end(), time);
    if (after == times_.begin() || after == times_.end()) return std::nullopt;
    const auto i = static_cast<std::size_t>(after - times_.begin());
    const double gap = times_[i] - times_[i - 1];
    if (gap > kMaxSampleGap) return std::nullopt;
    const double ratio = (time - times_[i - 1]) / gap;
    return Eigen::Vector3d((1.0 - ratio) * sums_[i - 1] + ratio * sums_[i]);
  }

 private:
  std::vector<Time> times_;
  std::vector<Eigen::Vector3d> sums_;
  Eigen::Vector3d last_rate_ = Eigen::Vector3d::Zero();
};

struct Correlation {
  double value = 0.0;
  double camera_deviation = 0.0;  ///< [rad/s]
};

/// Of the mean rates in all steps, the gyroscope's times taken to be later by an offset, in the
/// rotation of the gyroscope's axes that fits best: lengths alone fit worse, since the noise of a
/// still camera is positive. See Kabsch 1976.
std::optional<Correlation> correlationAt(const std::vector<RotationStep>& steps,
                                         const RotationSum& sum, double offset) {
  double n = 0.0, aa = 0.0, bb = 0.0;
  Eigen::Vector3d a_sum = Eigen::Vector3d::Zero(), b_sum = a_sum;
  Eigen::Matrix3d products = Eigen::Matrix3d::Zero();
  for (const auto& step : steps) {
    const auto begin = sum.at(step.begin + offset), end = sum.at(step.end + offset);
    if (!begin || !end) continue;
    const double dt = step.end - step.begin;
    const Eigen::Vector3d a = step.turn / dt, b = (*end - *begin) / dt;
    n += 1.0, a_sum += a, b_sum += b, aa += a.squaredNorm(), bb += b.squaredNorm();
    products += a * b.transpose();
  }
  if (n < static_cast<double>(kMinSteps)) return std::nullopt;
  const double a_variance = aa / n - (a_sum / n).squaredNorm();
  const double b_variance = bb / n - (b_sum / n).squaredNorm();
  if (!(a_variance > 0.0 && b_variance > 0.0)) return std::nullopt;
  const Eigen::Matrix3d covariance = products / n - a_sum / n * (b_sum / n).transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> squares(covariance.transpose() * covariance,
                                                               Eigen::EigenvaluesOnly);
  const Eigen::Vector3d singular = squares.eigenvalues().cwiseMax(0.0).cwiseSqrt();  // ascending
  const double sign = covariance.determinant() < 0.0 ? -1.0 : 1.0;
  const double fit = singular[2] + singular[1] + sign * singular[0];
  return Correlation{fit / std::sqrt(a_variance * b_variance), std::sqrt(a_variance)};
}

/// The offset at which the rotations of camera and gyroscope correlate best, whatever the mounting
/// of both; nullopt if they rotate too little, or do not correlate.
std::optional<ClockOffset> clockOffset(const std::vector<RotationStep>& steps,
                                       const std::vector<RotationSample>& samples) {
  const RotationSum sum(samples);
  std::optional<ClockOffset> best;
  const int count = static_cast<int>(kMaxOffset / kStep);
  for (int i = -count; i <= count; ++i) {
    const auto correlation = correlationAt(steps, sum, i * kStep);
    if (!correlation || correlation->camera_deviation < kMinDeviation) continue;
    if (best && !(correlation->value > best->correlation)) continue;
    best = ClockOffset{i * kStep, correlation->value};
  }
  if (!best || !(best->correlation >= kMinCorrelation)) return std::nullopt;
  if (std::abs(best->offset_s) > kMaxOffset - 0.5 * kStep) return std::nullopt;  // may lie beyond
  return best;
}

/// Images of a recording: exposure, blur, vertical offset, and the camera's rotations, which are
/// compared with the gyroscope.
class ImageCheck {
 public:
  /// @param every_nth_pair  of the pairs, one is matched for its vertical offset
  explicit ImageCheck(std::size_t every_nth_pair) : every_nth_pair_(every_nth_pair) {}

  void add(const StereoFrame& frame);
  [[nodiscard]] std::vector<CheckItem> items() const;
  /// The offset of the gyroscope's clock; nothing without samples.
  [[nodiscard]] std::vector<CheckItem> clockItems(
      const std::vector<RotationSample>& rotations) const;

 private:
  void addPair(const StereoFrame& frame);
  void addRotation(const StereoFrame& frame);
  [[nodiscard]] CheckItem pairItem() const;
  [[nodiscard]] CheckItem depthItem() const;
  [[nodiscard]] CheckItem registrationItem() const;

  std::size_t every_nth_pair_;
  std::size_t frames_ = 0;
  std::vector<double> brightness_, difference_, saturated_, sharpness_, vertical_, matches_, rows_;
  std::vector<double> known_depth_;  ///< ratio of the pixels, of a depth camera
  RegistrationCheck registration_;
  std::vector<RotationStep> steps_;
  cv::Mat last_;
  Time last_time_ = 0.0;
};

constexpr int kCheckedWidth = 640;  // images are reduced to this [px]

double ratioAbove(const std::vector<double>& values, double limit) {
  if (values.empty()) return 0.0;
  const auto count =
      std::count_if(values.begin(), values.end(), [&](double value) { return value > limit; });
  return static_cast<double>(count) / static_cast<double>(values.size());
}

/// Energy of the second derivative over that of the first, which falls with blur; 0 without
/// structure.
double sharpnessOf(const cv::Mat& image) {
  cv::Mat smooth, second, dx, dy;
  cv::GaussianBlur(image, smooth, {}, 1.0);
  cv::Laplacian(smooth, second, CV_32F);
  cv::Sobel(smooth, dx, CV_32F, 1, 0, 3, 0.125);
  cv::Sobel(smooth, dy, CV_32F, 0, 1, 3, 0.125);
  const double first = dx.dot(dx) + dy.dot(dy);
  return first > static_cast<double>(image.total()) ? second.dot(second) / first : 0.0;
}

/// Points of an image that are found in the next one.
void track(const cv::Mat& before, const cv::Mat& after, std::vector<cv::Point2f>& from,
           std::vector<cv::Point2f>& to) {
  std::vector<cv::Point2f> corners, moved, back;
  cv::goodFeaturesToTrack(before, corners, 250, 0.01, 12.0);
  if (corners.size() < 20) return;
  std::vector<uchar> found, found_back;
  std::vector<float> errors;
  cv::calcOpticalFlowPyrLK(before, after, corners, moved, found, errors);
  cv::calcOpticalFlowPyrLK(after, before, moved, back, found_back, errors);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (found[i] == 0 || found_back[i] == 0 || cv::norm(back[i] - corners[i]) > 0.5) continue;
    from.push_back(corners[i]);
    to.push_back(moved[i]);
  }
}

void ImageCheck::add(const StereoFrame& frame) {
  const double left = cv::mean(frame.left)[0];
  brightness_.push_back(left);
  saturated_.push_back(static_cast<double>(cv::countNonZero(frame.left > 250)) /
                       static_cast<double>(frame.left.total()));
  sharpness_.push_back(sharpnessOf(frame.left));
  if (frame.right.empty()) {
    known_depth_.push_back(static_cast<double>(cv::countNonZero(frame.disparity > 0.0F)) /
                           static_cast<double>(frame.left.total()));
    if (frames_ % every_nth_pair_ == 0) registration_.add(frame);
  } else {
    difference_.push_back(std::abs(left - cv::mean(frame.right)[0]));
    if (frames_ % every_nth_pair_ == 0) addPair(frame);
  }
  addRotation(frame);
  ++frames_;
}

void ImageCheck::addPair(const StereoFrame& frame) {
  const auto report = io::measureCalibration(frame.left, frame.right, *frame.camera);
  matches_.push_back(static_cast<double>(report.matches));
  if (report.matches < 20) return;
  vertical_.push_back(report.vertical_disparity_px);
  rows_.push_back(report.row_offset_px);
}

void ImageCheck::addRotation(const StereoFrame& frame) {
  const double scale = std::min(1.0, static_cast<double>(kCheckedWidth) / frame.left.cols);
  cv::Mat image;
  cv::resize(frame.left, image, {}, scale, scale, cv::INTER_AREA);
  const cv::Mat before = std::exchange(last_, image);
  const Time begin = std::exchange(last_time_, frame.time);
  constexpr double kLongestStep = 0.5;  // [s]
  if (before.empty() || frame.time - begin > kLongestStep || frame.time <= begin) return;
  std::vector<cv::Point2f> from, to;
  track(before, image, from, to);
  if (from.size() < 20) return;
  const auto& camera = *frame.camera;
  const cv::Matx33d lens(camera.fx * scale, 0, camera.cx * scale, 0, camera.fy * scale,
                         camera.cy * scale, 0, 0, 1);
  cv::Mat inliers, rotation, shift;
  const cv::Mat essential = cv::findEssentialMat(from, to, lens, cv::RANSAC, 0.999, 0.7, inliers);
  if (essential.rows != 3 ||
      cv::recoverPose(essential, from, to, lens, rotation, shift, inliers) < 15) {
    return;
  }
  using Rotation = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
  // The rotation maps points of the image before into this one: the camera turned by its inverse.
  const Eigen::Vector3d turn = -logSo3(Eigen::Map<const Rotation>(rotation.ptr<double>()));
  constexpr double kImplausible = 0.7;  // [rad]
  if (turn.norm() <= kImplausible) steps_.push_back({begin, frame.time, turn});
}

std::vector<CheckItem> ImageCheck::items() const {
  std::vector<CheckItem> items;
  CheckItem exposure{"exposure",
                     formatted("mean grey %.0f, overexposed %.1f %%", median(brightness_),
                               100.0 * median(saturated_)),
                     Rating::kOk, ""};
  if (!difference_.empty()) {
    exposure.value += formatted(", left and right differ by %.1f", median(difference_));
  }
  if (median(brightness_) < 25.0 || median(saturated_) > 0.3) {
    exposure.rating = Rating::kBad;
    exposure.advice = "too dark or overexposed: change light, exposure or gain";
  } else if (median(brightness_) < 45.0 || median(saturated_) > 0.1 || median(difference_) > 25.0) {
    exposure.rating = Rating::kWarning;
    exposure.advice = difference_.empty()
                          ? "let the camera use the whole range of grey"
                          : "let both cameras use the same exposure and gain, and the whole range "
                            "of grey";
  }
  items.push_back(exposure);
  const double usual = median(sharpness_);
  std::vector<double> softness;
  for (const double sharpness : sharpness_) softness.push_back(usual / std::max(sharpness, 1e-9));
  const double blurred = ratioAbove(softness, 2.0);
  CheckItem blur{"blur",
                 formatted("%.1f %% of the images less than half as sharp as usual (%.2f)",
                           100.0 * blurred, usual),
                 usual < 0.05 ? Rating::kBad : ratingOf(blurred, 0.03, 0.2), ""};
  if (blur.rating != Rating::kOk) {
    blur.advice = usual < 0.05 ? "all images are blurred: check the focus"
                               : "shorten the exposure and raise the gain, or turn more slowly";
  }
  items.push_back(blur);
  items.push_back(known_depth_.empty() ? pairItem() : depthItem());
  if (!known_depth_.empty()) items.push_back(registrationItem());
  return items;
}

CheckItem ImageCheck::depthItem() const {
  const double known = median(known_depth_);
  CheckItem depth{"depth", formatted("%.0f %% of the pixels", 100.0 * known),
                  ratingOf(1.0 - known, 0.7, 0.95), ""};
  if (depth.rating != Rating::kOk) {
    depth.advice = "little within reach of the depth camera, sunlight, or a wrong calibration";
  }
  return depth;
}

CheckItem ImageCheck::registrationItem() const {
  const auto found = registration_.result();
  if (!found) return {"registration", "not measurable: too few contours", Rating::kUnknown, ""};
  const auto& [value, sigma] = *found;
  CheckItem item{"registration",
                 formatted("depth fits colour if moved by %+.0f +- %.0f mm right, %+.0f +- %.0f mm "
                           "down, and grown by %+.1f +- %.1f %%",
                           1e3 * value[0], 1e3 * sigma[0], 1e3 * value[1], 1e3 * sigma[1],
                           1e2 * value[2], 1e2 * sigma[2]),
                 Rating::kOk, ""};
  constexpr double kSignificant = 3.0;  // standard deviations
  if ((value.array().abs() > kSignificant * sigma.array()).any()) {
    item.rating = Rating::kWarning;
    item.advice =
        "colour and depth are out of register: check the pose between both cameras (T_left_depth) "
        "and that each has its own lens (left, depth) in the calibration";
  }
  return item;
}

CheckItem ImageCheck::pairItem() const {
  const double vertical = median(vertical_);
  CheckItem offset{"vertical offset", formatted("median %.2f px", vertical),
                   ratingOf(vertical, 0.5, 1.5), ""};
  if (offset.rating != Rating::kOk) offset.advice = "calibrate again and tighten the cameras";
  if (vertical_.empty()) {
    offset.rating = Rating::kBad;
    offset.advice = io::kNothingMatches;
  } else {
    // Rows of one rig are constant; those of cameras that expose at other times are not.
    const double low = percentile(rows_, 0.05), high = percentile(rows_, 0.95);
    offset.value += formatted(", %+.1f to %+.1f px from pair to pair", low, high);
    if (const Rating rating = ratingOf(high - low, 1.0, 4.0); rating > offset.rating) {
      offset.rating = rating;
      offset.advice = "the cameras are not synchronised, or one is loose: trigger both together";
    }
  }
  offset.value += formatted(", %.0f matches a pair", median(matches_));
  return offset;
}

std::vector<CheckItem> ImageCheck::clockItems(const std::vector<RotationSample>& samples) const {
  if (samples.empty()) return {};
  const auto offset = clockOffset(steps_, samples);
  CheckItem item{"camera against inertial sensor", "", Rating::kOk, ""};
  if (!offset) {
    item.value = "not measurable";
    item.rating = Rating::kWarning;
    item.advice = "turn the camera in the recording, so that both sensors see it";
  } else {
    item.value = formatted("inertial times %+.0f ms, correlation %.2f", 1e3 * offset->offset_s,
                           offset->correlation);
    item.rating = ratingOf(std::abs(offset->offset_s), 0.01, 0.03);
    if (item.rating != Rating::kOk) {
      item.advice = "the clocks or latencies differ: use one clock, and times of capture";
    }
  }
  return {item};
}

constexpr std::size_t kMatchedPairs = 100;

const char* wordOf(Rating rating) {
  constexpr std::array kWords{"ok", "unknown", "warning", "bad"};
  return kWords.at(static_cast<std::size_t>(rating));
}

void print(const CheckItem& item) {
  std::cout << std::left << std::setw(9) << wordOf(item.rating) << printable(item.name) << ": "
            << printable(item.value) << '\n';
  if (!item.advice.empty()) std::cout << std::string(9, ' ') << printable(item.advice) << '\n';
}

CheckItem rigOf(const io::RawlogSource& source) {
  if (source.camera() == nullptr) {
    return {"rig", "no camera, poses only", Rating::kWarning, "images are not checked"};
  }
  const auto& camera = *source.camera();
  const auto& position = camera.T_robot_cam.translation();
  const std::string kind = camera.isDepthCamera()
                               ? formatted("depth camera to %.1f m", camera.depth_reach_m)
                               : formatted("baseline %.4f m", camera.baseline_m);
  return {
      "rig",
      formatted("%dx%d px, %s, focal length %.1f px, camera at (%.2f, %.2f, %.2f) m", camera.width,
                camera.height, kind.c_str(), camera.fx, position.x(), position.y(), position.z()),
      Rating::kOk, ""};
}

/// Counts of what cannot be used.
std::vector<CheckItem> skippedItems(const std::map<std::string, std::size_t>& skipped) {
  std::vector<CheckItem> items;
  for (const auto& [reason, count] : skipped) {
    if (reason == "truth") continue;
    items.push_back({"unused", reason + " " + std::to_string(count), Rating::kWarning,
                     "doc/formats.md has every reason"});
  }
  return items;
}

void append(std::vector<CheckItem>& items, std::vector<CheckItem> more) {
  for (auto& item : more) items.push_back(std::move(item));
}

/// What the pipeline says about calibration and mounting, by its first half minute.
class PipelineCheck {
 public:
  explicit PipelineCheck(std::shared_ptr<const StereoCamera> camera)
      : perception_(std::move(camera), parameters()) {}

  void add(RecordedFrame frame) {
    if (!first_) first_ = frame.time;
    const bool is_over = frame.time - *first_ > kSeconds || perception_.mounting();
    if (is_over || fatal_ || (last_ && frame.time - *last_ < kInterval_s)) return;
    last_ = frame.time;
    frame.T_map_robot.reset();
    const auto update = perception_.process(frame);
    if (const auto* finding = update.fatalFinding()) fatal_ = *finding;
  }

  [[nodiscard]] std::vector<CheckItem> items() const {
    std::vector<CheckItem> items;
    if (fatal_) items.push_back({fatal_->name, "refused", Rating::kBad, fatal_->text});
    for (const auto& [name, warning] : perception_.warnings()) {
      if (name != "camera_mounting" && name != "odometry_scale" && name != "too_near") continue;
      items.push_back({name, "", Rating::kWarning, warning.text});
    }
    if (perception_.warnings().count("camera_mounting") > 0) return items;
    const auto mounting = perception_.mounting();
    items.push_back({"mounting",
                     mounting ? "as the floor in view shows it: " + *mounting
                              : "not compared: no floor was seen for 2 s of motion",
                     mounting ? Rating::kOk : Rating::kUnknown, ""});
    return items;
  }

 private:
  static constexpr double kSeconds = 30.0;     ///< of slow motion in which a floor is found
  static constexpr double kInterval_s = 0.06;  ///< of frames: more than 15 a second tell no more

  static pipeline::PerceptionParams parameters() {
    pipeline::PerceptionParams params;
    params.detection.detector = "none";
    return params;
  }

  pipeline::Perception perception_;
  std::optional<pipeline::Finding> fatal_;
  std::optional<Time> first_, last_;
};

/// Items of the images; one that is bad if they cannot be read.
std::vector<CheckItem> imageItems(const std::string& path, const std::string& sensor_label,
                                  const TimeCheck& times) {
  std::vector<CheckItem> items;
  try {
    io::RawlogSourceOptions options;
    options.sensor_label = sensor_label;
    options.use_laser = true;
    io::RawlogSource source(path, options);
    items.push_back(rigOf(source));
    ImageCheck images(std::max<std::size_t>(1, times.images() / kMatchedPairs));
    std::optional<PipelineCheck> pipeline;
    while (!program::interrupted()) {
      const auto frame = source.next();
      if (!frame) break;
      if (!frame->stereo) continue;
      images.add(*frame->stereo);
      if (!pipeline) pipeline.emplace(source.camera());
      pipeline->add(*frame);
    }
    if (pipeline) {
      append(items, images.items());
      append(items, pipeline->items());
      append(items, images.clockItems(times.rotations()));
    }
    const auto warnings = source.warnings();
    const auto assumed = warnings.find(io::kTimesAssumed);
    if (assumed != warnings.end()) {
      items.push_back({io::kTimesAssumed, "10 Hz", Rating::kWarning, assumed->second.text});
    }
    append(items, skippedItems(source.skipped()));
  } catch (const InputError& error) {
    items.push_back({"images", "cannot be used", Rating::kBad, error.what()});
  }
  return items;
}

}  // namespace

ImportOutput::ImportOutput(std::string path, bool check) : path_(std::move(path)) {
  if (!path_.empty()) return;
  if (!check) throw program::UsageError("give -o OUT.rawlog, or --check");
  std::string folder = (std::filesystem::temp_directory_path() / "headway-import-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw InputError(folder + ": no temporary folder can be made; set TMPDIR");
  }
  folder_ = folder;
  path_ = folder_ + "/checked.rawlog";
}

ImportOutput::~ImportOutput() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void addCheck(program::CommandLine& line, bool& check) {
  line.flag(check, 0, "check",
            "Check the recording: rates, gaps, time offsets, exposure, blur, vertical offset, "
            "registration, mounting, clocks; exit status 1 if something is bad; without -o nothing "
            "is kept");
}

bool isAnyImage(const mrpt::obs::CObservation& observation) {
  return dynamic_cast<const mrpt::obs::CObservationImage*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservationStereoImages*>(&observation) != nullptr ||
         dynamic_cast<const mrpt::obs::CObservation3DRangeScan*>(&observation) != nullptr;
}

int checkRawlog(const std::string& path, const std::string& sensor_label) {
  TimeCheck times(sensor_label);
  std::map<std::string, std::size_t> skipped;
  const auto truncation = io::visitObservations(
      path, skipped,
      [&times](const mrpt::obs::CObservation& observation) { times.add(observation); });
  std::vector<CheckItem> items = times.items();
  if (truncation) {
    items.push_back({"file", "truncated", Rating::kBad, *truncation + "; record it again"});
  }
  if (!program::interrupted()) append(items, imageItems(path, sensor_label, times));
  if (program::interrupted()) {
    std::cout << "interrupted: not checked" << std::endl;
    return program::kInputFault;
  }
  for (const auto& item : items) print(item);
  const auto count = [&](Rating rating) {
    return std::count_if(items.begin(), items.end(),
                         [rating](const CheckItem& item) { return item.rating == rating; });
  };
  std::cout << "result: " << count(Rating::kBad) << " bad, " << count(Rating::kWarning)
            << " warnings, " << count(Rating::kUnknown) << " unknown, " << count(Rating::kOk)
            << " ok" << std::endl;
  return count(Rating::kBad) > 0 ? program::kInputFault : program::kDone;
}

}  // namespace headway::import
