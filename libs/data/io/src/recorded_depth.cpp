// SPDX-License-Identifier: BSD-3-Clause
// Depth images in rawlogs: their objects, files and calibration.
#include "recorded_depth.h"

#include <headway/core/error.h>
#include <headway/core/mrpt_pose.h>
#include <headway/io/image_file.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "frame_collector.h"
#include "image_files.h"
#include "object_reader.h"
#include "text_rows.h"

namespace headway::io {
namespace {

namespace fs = std::filesystem;

constexpr float kOldUnits = 1e-3F;  // of ranges that are stored as floats [m]
constexpr auto kFarthest = std::numeric_limits<std::uint16_t>::max();  // units; a hole, too
constexpr std::size_t kMaxLayers = 16;  // of one frame; none of MRPT's drivers makes any

/// Sets what MRPT sets only when it reads or writes a file itself.
class StoredDepthScan : public mrpt::obs::CObservation3DRangeScan {
 public:
  void setExternalRanges(const std::string& file) {
    m_rangeImage_external_stored = true;
    m_rangeImage_external_file = file;
  }
};

cv::Size readSize(ObjectReader& in) {
  const std::int64_t rows = in.value<std::uint32_t>();
  const std::int64_t columns = in.value<std::uint32_t>();
  if (rows > kMaxImageSide || columns > kMaxImageSide || rows * columns > kMaxImagePixels) {
    throw BrokenObject("a depth image is too large");
  }
  return {static_cast<int>(columns), static_cast<int>(rows)};
}

std::size_t areaOf(const cv::Size& size) {
  return static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
}

/// A depth image of 16 bits.
cv::Mat readRanges(ObjectReader& in) {
  const cv::Size size = readSize(in);
  const auto values = in.values<std::uint16_t>(areaOf(size), kMaxImagePixels);
  if (values.empty()) return {};
  cv::Mat ranges(size, CV_16U);
  std::memcpy(ranges.data, values.data(), values.size() * sizeof(std::uint16_t));
  return ranges;
}

/// A matrix object of floats [m], as versions before 9 store depth.
cv::Mat readFloatRanges(ObjectReader& in) {
  if (in.enter({"CMatrixF", "CMatrix"}) != 0) throw BrokenObject("a matrix of unknown version");
  const cv::Size size = readSize(in);
  const auto metres = in.values<float>(areaOf(size), kMaxImagePixels);
  in.leave();
  if (metres.empty()) return {};
  cv::Mat ranges(size, CV_16U, cv::Scalar(0));
  for (std::size_t i = 0; i < metres.size(); ++i) {
    const float units = std::round(metres[i] / kOldUnits);
    if (units > 0.0F && units < static_cast<float>(kFarthest)) {
      ranges.ptr<std::uint16_t>()[i] = static_cast<std::uint16_t>(units);
    }
  }
  return ranges;
}

void skipPoints(std::uint8_t version, ObjectReader& in) {
  const std::size_t points = in.value<std::uint32_t>();
  if (points > kMaxImagePixels) throw BrokenObject("too many points");
  std::size_t bytes = 3 * sizeof(float);
  if (version == 0) bytes += 1;                          // validity
  if (version >= 8) bytes += 2 * sizeof(std::uint16_t);  // pixels
  (void)in.skip(points * bytes);
}

void setRanges(const cv::Mat& ranges, mrpt::obs::CObservation3DRangeScan& scan) {
  scan.rangeImage_setSize(ranges.rows, ranges.cols);
  if (!ranges.empty()) {
    std::memcpy(scan.rangeImage.data(), ranges.data, ranges.total() * ranges.elemSize());
  }
}

/// Images and calibration, which versions from 1 on store; returns the intensity image.
RecordedImage readImages(std::uint8_t version, StoredDepthScan& scan, ObjectReader& in) {
  scan.hasRangeImage = in.flag();
  scan.rangeUnits = version >= 9 ? in.value<float>() : kOldUnits;
  if (scan.hasRangeImage) setRanges(version >= 9 ? readRanges(in) : readFloatRanges(in), scan);
  RecordedImage intensity;
  scan.hasIntensityImage = in.flag();
  if (scan.hasIntensityImage) intensity = readImage(in);
  if (in.flag()) (void)readImage(in);  // confidence
  if (version < 2) return intensity;
  scan.cameraParams = readCamera(in);
  scan.cameraParamsIntensity = scan.cameraParams;
  if (version < 4) return intensity;  // both cameras are one: the default pose
  scan.cameraParamsIntensity = readCamera(in);
  scan.relativePoseIntensityWRTDepth = readPose3D(in);
  return intensity;
}

void readStorage(StoredDepthScan& scan, ObjectReader& in) {
  (void)in.flag();
  (void)in.text();  // file of the points
  const bool is_external = in.flag();
  const std::string file = in.text();
  if (is_external) scan.setExternalRanges(file);
}

void skipLayers(ObjectReader& in) {
  const std::size_t layers = in.value<std::uint8_t>();
  if (layers > kMaxLayers) throw BrokenObject("too many depth layers");
  for (std::size_t i = 0; i < layers; ++i) {
    (void)in.text();
    (void)in.skip(areaOf(readSize(in)) * sizeof(std::uint16_t));
  }
}

/// The lens for images of another size of the same view.
RawCamera scaledTo(const RawCamera& lens, const cv::Size& size) {
  const bool is_same_view = lens.width > 0 && lens.height > 0 &&
                            static_cast<std::int64_t>(lens.width) * size.height ==
                                static_cast<std::int64_t>(lens.height) * size.width;
  if (size.width == lens.width || !is_same_view) return lens;
  const double ratio = static_cast<double>(size.width) / lens.width;
  RawCamera scaled = lens;
  scaled.width = size.width;
  scaled.height = size.height;
  scaled.fx *= ratio;
  scaled.fy *= ratio;
  scaled.cx = ratio * (lens.cx + 0.5) - 0.5;
  scaled.cy = ratio * (lens.cy + 0.5) - 0.5;
  return scaled;
}

/// A file of ranges as MRPT writes it, of 16 bits or, before version 9, of floats.
cv::Mat readRangeFile(const std::string& path) {
  CompressedInput input(path);
  const std::string_view start = input.peek(1);
  const bool is_object = !start.empty() && (static_cast<unsigned char>(start[0]) & 0x80) != 0;
  const bool is_matrix = is_object && input.peek(30).find("CMatrix") != std::string_view::npos;
  input.mark();
  ObjectReader in(input);
  return is_matrix ? readFloatRanges(in) : readRanges(in);
}

/// The same as text, a row a line.
cv::Mat readRangeText(const std::string& path) {
  TextRows rows(path);
  std::vector<std::uint16_t> values;
  int count = 0;
  while (rows.next()) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const double value = rows.number(i);
      if (values.size() >= kMaxImagePixels) throw BrokenObject("a depth image is too large");
      if (value != std::floor(value)) throw BrokenObject("a range is not an integer");
      values.push_back(value > 0.0 && value < kFarthest ? static_cast<std::uint16_t>(value) : 0);
    }
    ++count;
  }
  if (count == 0 || values.size() % static_cast<std::size_t>(count) != 0) return {};
  return cv::Mat(values, true).reshape(1, count);
}

}  // namespace

/// As CObservation3DRangeScan::serializeFrom() of MRPT 2.5.8.
mrpt::obs::CObservation::Ptr readDepthScan(ObjectReader& in) {
  const auto version = in.value<std::uint8_t>();
  if (version > 10) throw UnknownVersion("", version);
  auto scan = std::make_shared<StoredDepthScan>();
  scan->maxRange = in.value<float>();
  scan->sensorPose = readPose3D(in);
  if (version == 0 || in.flag()) skipPoints(version, in);
  RecordedImage intensity;
  if (version >= 1) intensity = readImages(version, *scan, in);
  scan->stdError = in.value<float>();
  scan->timestamp = in.time();
  scan->sensorLabel = in.text();
  if (version >= 3) readStorage(*scan, in);
  scan->range_is_depth = version < 5 || in.flag();
  if (version >= 6) (void)in.value<std::int8_t>();  // visible or infrared
  if (version >= 7 && in.flag()) throw BrokenObject("pixels are labelled");
  if (version >= 10) skipLayers(in);
  in.leave();
  scan->intensityImage = mrptImage(intensity, in);
  return scan;
}

RecordedDepth depthOf(const mrpt::obs::CObservation3DRangeScan& scan) {
  RecordedDepth depth;
  if (scan.rangeImage.rows() > 0) {
    depth.ranges =
        cv::Mat(static_cast<int>(scan.rangeImage.rows()), static_cast<int>(scan.rangeImage.cols()),
                CV_16U, const_cast<std::uint16_t*>(scan.rangeImage.data()))
            .clone();
  } else if (scan.rangeImage_isExternallyStored()) {
    depth.file = scan.rangeImage_getExternalStorageFile("");
  }
  RawDepthCamera& camera = depth.camera;
  camera.color = rawCamera(scan.cameraParamsIntensity);
  camera.depth = rawCamera(scan.cameraParams);
  if (!depth.ranges.empty()) camera.depth = scaledTo(camera.depth, depth.ranges.size());
  const Pose T_sensor_color = fromMrpt(scan.relativePoseIntensityWRTDepth);
  camera.T_robot_color = fromMrpt(scan.sensorPose) * T_sensor_color;
  camera.T_color_depth = T_sensor_color.inverse() * robotFromOptical();
  camera.metres_per_unit = static_cast<double>(scan.rangeUnits);
  camera.max_range_m = static_cast<double>(scan.maxRange);
  camera.ranges_are_depths = scan.range_is_depth;
  return depth;
}

std::variant<cv::Mat, std::string> rangesOf(const RecordedDepth& depth,
                                            const std::string& image_folder) {
  if (depth.file.empty()) {
    if (depth.ranges.empty()) return std::string("broken_depth");
    return depth.ranges;
  }
  const fs::path path = fs::path(image_folder) / depth.file;
  std::error_code ignored;
  if (!isInside(image_folder, path)) return std::string("depth_outside_folder");
  if (!fs::is_regular_file(path, ignored)) return std::string("missing_depth");
  try {
    const cv::Mat ranges =
        path.extension() == ".txt" ? readRangeText(path.string()) : readRangeFile(path.string());
    if (!ranges.empty()) return ranges;
  } catch (const BrokenObject&) {
  } catch (const InputError&) {
  }
  return std::string("broken_depth");
}

}  // namespace headway::io
