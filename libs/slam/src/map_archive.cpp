#include "map_archive.h"

#include <headway/core/error.h>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <type_traits>

namespace headway::slam {
namespace {

constexpr std::uint32_t kMagic = 0x4d535748;  ///< "HWSM"
constexpr std::uint32_t kVersion = 2;

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
    if (bytes_.size() - at_ < sizeof(T)) throw InputError("the data of slam are cut off");
    T x;
    std::memcpy(&x, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(x)) throw InputError("the data of slam hold a value that is not finite");
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

StereoCamera readCamera(Reader& in) {
  StereoCamera camera;
  camera.width = in.value<std::int32_t>();
  camera.height = in.value<std::int32_t>();
  for (double* x : {&camera.fx, &camera.fy, &camera.cx, &camera.cy, &camera.baseline_m}) {
    *x = in.value<double>();
  }
  return camera;
}

std::string textOf(const StereoCamera& camera) {
  char text[160];
  std::snprintf(text, sizeof text, "%dx%d px, f %.2f %.2f px, centre %.2f %.2f px, baseline %.4f m",
                camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                camera.baseline_m);
  return text;
}

void requireSame(const StereoCamera& recorded, const StereoCamera& camera) {
  constexpr double kTolerance = 1e-3;  ///< relative: a calibration read back from another file
  const auto near = [](double a, double b) { return std::abs(a - b) <= kTolerance * std::abs(b); };
  const bool same = recorded.width == camera.width && recorded.height == camera.height &&
                    near(recorded.fx, camera.fx) && near(recorded.fy, camera.fy) &&
                    near(recorded.cx, camera.cx) && near(recorded.cy, camera.cy) &&
                    near(recorded.baseline_m, camera.baseline_m);
  if (!same) {
    throw InputError("it was made with another camera (" + textOf(recorded) + "; here " +
                     textOf(camera) + "); use rawlogs of one camera");
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
  const stereo::StereoMeasurement& measurement = observation.measurement;
  out.value(observation.keyframe.value);
  out.matrix(measurement.uv);
  out.value(measurement.disparity);
  out.value<std::uint8_t>(measurement.stereo ? 1 : 0);
  out.value(measurement.sigma_px);
  out.value(measurement.sigma_disparity_px);
}

LandmarkObservation readObservation(Reader& in) {
  LandmarkObservation observation;
  stereo::StereoMeasurement& measurement = observation.measurement;
  observation.keyframe.value = in.value<std::int64_t>();
  in.matrix(measurement.uv);
  measurement.disparity = in.value<double>();
  measurement.stereo = in.value<std::uint8_t>() != 0;
  measurement.sigma_px = in.value<double>();
  measurement.sigma_disparity_px = in.value<double>();
  if (!(measurement.sigma_px > 0.0) || !(measurement.sigma_disparity_px > 0.0)) {
    throw InputError("damaged: a measurement has no positive sigma");
  }
  return observation;
}

void write(Writer& out, const Landmark& landmark) {
  out.value(landmark.id.value);
  out.matrix(landmark.position);
  out.value(landmark.reference.value);
  out.value<std::int32_t>(landmark.reference_level);
  out.matrix(landmark.T_reference_cut.matrix());
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
  in.matrix(landmark.T_reference_cut.matrix());
  in.values(landmark.patch.pixels);
  in.matrix(landmark.patch.centre);
  in.values(landmark.descriptor);
  landmark.tried = in.value<std::int32_t>();
  landmark.found = in.value<std::int32_t>();
  landmark.agreed = in.value<std::int32_t>();
  const auto count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < count; ++i) landmark.observations.push_back(readObservation(in));
  const float last = stereo::ReferencePatch::kSize - 1;
  if (landmark.reference_level < 0 || landmark.reference_level > kMaxLevel ||
      landmark.patch.centre.minCoeff() < 0.0F || landmark.patch.centre.maxCoeff() > last) {
    throw InputError("damaged: a landmark's patch lies outside its range");
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
  if (in.value<std::uint32_t>() != kMagic)
    throw InputError("the data of slam are of something else");
  const auto version = in.value<std::uint32_t>();
  if (version != kVersion) {
    throw InputError("the data of slam are of version " + std::to_string(version) +
                     ", this program reads version " + std::to_string(kVersion));
  }
  requireSame(readCamera(in), camera);
  const double disparity_offset_px = in.value<double>();
  std::vector<Keyframe> keyframes;
  const auto keyframe_count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < keyframe_count; ++i) keyframes.push_back(readKeyframe(in));
  std::vector<Landmark> landmarks;
  const auto landmark_count = in.value<std::uint64_t>();
  for (std::uint64_t i = 0; i < landmark_count; ++i) landmarks.push_back(readLandmark(in));
  if (!in.atEnd()) throw InputError("damaged: there are data after the end of slam's");
  SparseMap map(keyframes, landmarks);
  map.setDisparityOffset(disparity_offset_px);
  return map;
}

}  // namespace headway::slam
