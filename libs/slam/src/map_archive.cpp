#include "map_archive.h"

#include <headway/core/error.h>

#include <cmath>
#include <cstring>
#include <type_traits>

namespace headway::slam {
namespace {

constexpr std::uint32_t kMagic = 0x4d535748;  ///< "HWSM"
constexpr std::uint32_t kVersion = 1;

class Writer {
 public:
  template <typename T>
  void value(const T& x) {
    static_assert(std::is_arithmetic_v<T>);
    bytes.append(reinterpret_cast<const char*>(&x), sizeof(T));
  }
  template <typename T, std::size_t N>
  void values(const std::array<T, N>& all) {
    for (const T& x : all) value(x);
  }
  template <typename Derived>
  void matrix(const Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) value(m(i % m.rows(), i / m.rows()));
  }
  std::string bytes;
};

class Reader {
 public:
  explicit Reader(const std::string& bytes) : bytes_(bytes) {}

  template <typename T>
  T value() {
    static_assert(std::is_arithmetic_v<T>);
    if (bytes_.size() - at_ < sizeof(T)) throw InputError("map of slam: its data are cut off");
    T x;
    std::memcpy(&x, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(x)) throw InputError("map of slam: it holds a value that is not finite");
    }
    return x;
  }
  template <typename T, std::size_t N>
  void values(std::array<T, N>& all) {
    for (T& x : all) x = value<T>();
  }
  template <typename Derived>
  void matrix(Eigen::MatrixBase<Derived>& m) {
    for (Eigen::Index i = 0; i < m.size(); ++i) {
      m(i % m.rows(), i / m.rows()) = value<typename Derived::Scalar>();
    }
  }
  [[nodiscard]] bool atEnd() const { return at_ == bytes_.size(); }

 private:
  const std::string& bytes_;
  std::size_t at_ = 0;
};

void write(Writer& out, const StereoCamera& camera) {
  out.value<std::int32_t>(camera.width);
  out.value<std::int32_t>(camera.height);
  for (const double x : {camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline_m}) {
    out.value(x);
  }
}

void requireSame(Reader& in, const StereoCamera& camera) {
  constexpr double kTolerance = 1e-3;  ///< relative: a calibration read back from another file
  bool same = in.value<std::int32_t>() == camera.width;
  same = (in.value<std::int32_t>() == camera.height) && same;
  for (const double x : {camera.fx, camera.fy, camera.cx, camera.cy, camera.baseline_m}) {
    same = (std::abs(in.value<double>() - x) <= kTolerance * std::abs(x)) && same;
  }
  if (!same) {
    throw InputError(
        "map of slam: it was made with another camera (image size, focal length, "
        "principal point or baseline differ); use the rawlogs of one camera");
  }
}

void write(Writer& out, const Keyframe& keyframe) {
  out.value(keyframe.id.value);
  out.value<std::uint64_t>(keyframe.frame);
  out.value(keyframe.time);
  out.matrix(keyframe.T_map_cam.matrix());
  out.matrix(keyframe.covariance);
}

Keyframe readKeyframe(Reader& in) {
  Keyframe keyframe;
  keyframe.id.value = in.value<std::int64_t>();
  keyframe.frame = in.value<std::uint64_t>();
  keyframe.time = in.value<double>();
  Eigen::Matrix4d pose;
  in.matrix(pose);
  keyframe.T_map_cam.matrix() = pose;
  in.matrix(keyframe.covariance);
  return keyframe;
}

void write(Writer& out, const LandmarkObservation& observation) {
  const StereoMeasurement& measurement = observation.measurement;
  out.value(observation.keyframe.value);
  out.matrix(measurement.uv);
  out.value(measurement.disparity);
  out.value<std::uint8_t>(measurement.stereo ? 1 : 0);
  out.value(measurement.sigma_px);
  out.value(measurement.sigma_disparity_px);
}

LandmarkObservation readObservation(Reader& in) {
  LandmarkObservation observation;
  StereoMeasurement& measurement = observation.measurement;
  observation.keyframe.value = in.value<std::int64_t>();
  in.matrix(measurement.uv);
  measurement.disparity = in.value<double>();
  measurement.stereo = in.value<std::uint8_t>() != 0;
  measurement.sigma_px = in.value<double>();
  measurement.sigma_disparity_px = in.value<double>();
  if (!(measurement.sigma_px > 0.0) || !(measurement.sigma_disparity_px > 0.0)) {
    throw InputError("map of slam: a measurement has no positive sigma");
  }
  return observation;
}

void write(Writer& out, const Landmark& landmark) {
  out.value(landmark.id.value);
  out.matrix(landmark.position);
  out.value(landmark.reference.value);
  out.value<std::int32_t>(landmark.reference_level);
  out.values(landmark.patch.pixels);
  out.matrix(landmark.patch.centre);
  out.values(landmark.descriptor);
  for (const int count : {landmark.tried, landmark.found, landmark.agreed}) {
    out.value<std::int32_t>(count);
  }
  out.value<std::uint64_t>(landmark.observations.size());
  for (const auto& observation : landmark.observations) write(out, observation);
}

Landmark readLandmark(Reader& in) {
  constexpr int kMaxLevel = 16;
  Landmark landmark;
  landmark.id.value = in.value<std::int64_t>();
  in.matrix(landmark.position);
  landmark.reference.value = in.value<std::int64_t>();
  landmark.reference_level = in.value<std::int32_t>();
  in.values(landmark.patch.pixels);
  in.matrix(landmark.patch.centre);
  in.values(landmark.descriptor);
  landmark.tried = in.value<std::int32_t>();
  landmark.found = in.value<std::int32_t>();
  landmark.agreed = in.value<std::int32_t>();
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) landmark.observations.push_back(readObservation(in));
  const float last = ReferencePatch::kSize - 1;
  if (landmark.reference_level < 0 || landmark.reference_level > kMaxLevel ||
      landmark.patch.centre.minCoeff() < 0.0F || landmark.patch.centre.maxCoeff() > last) {
    throw InputError("map of slam: a landmark's patch lies outside its range");
  }
  return landmark;
}

}  // namespace

std::string packMap(const SparseMap& map, const StereoCamera& camera) {
  Writer out;
  out.value(kMagic);
  out.value(kVersion);
  write(out, camera);
  out.value(map.disparityOffset());
  out.value<std::uint64_t>(map.keyframes().size());
  for (const auto& [id, keyframe] : map.keyframes()) write(out, keyframe);
  out.value<std::uint64_t>(map.landmarks().size());
  for (const auto& [id, landmark] : map.landmarks()) write(out, landmark);
  return out.bytes;
}

SparseMap unpackMap(const std::string& bytes, const StereoCamera& camera) {
  Reader in(bytes);
  if (in.value<std::uint32_t>() != kMagic) throw InputError("map of slam: it is none");
  const auto version = in.value<std::uint32_t>();
  if (version != kVersion) {
    throw InputError("map of slam: version " + std::to_string(version) + ", this program reads " +
                     std::to_string(kVersion));
  }
  requireSame(in, camera);
  const double disparity_offset_px = in.value<double>();
  std::vector<Keyframe> keyframes;
  const auto keyframe_count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < keyframe_count; ++i) keyframes.push_back(readKeyframe(in));
  std::vector<Landmark> landmarks;
  const auto landmark_count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < landmark_count; ++i) landmarks.push_back(readLandmark(in));
  if (!in.atEnd()) throw InputError("map of slam: there are data after its end");
  SparseMap map(keyframes, landmarks);
  map.setDisparityOffset(disparity_offset_px);
  return map;
}

}  // namespace headway::slam
