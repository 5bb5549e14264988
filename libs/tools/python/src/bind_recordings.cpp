// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>

#include <algorithm>
#include <cmath>

#include "arrays.h"

namespace headway::python {
namespace {

std::optional<RecordedFrame> next(io::RawlogSource& source) {
  const py::gil_scoped_release release;
  return source.next();
}

std::optional<std::shared_ptr<StereoCamera>> cameraOf(const io::RawlogSource& source) {
  if (!source.camera()) return std::nullopt;
  return std::const_pointer_cast<StereoCamera>(source.camera());
}

void bindSource(py::module_& module) {
  py::class_<io::RawlogSource>(module, "RawlogSource",
                               "Reads a rawlog as rectified frames: iterate over it.")
      .def(py::init([](const std::string& path, const std::string& sensor_label,
                       std::size_t from_index, const std::optional<std::size_t>& to_index,
                       bool use_odometry, bool use_imu) {
             io::RawlogSourceOptions options;
             options.sensor_label = sensor_label;
             options.from_index = from_index;
             options.to_index = to_index;
             options.use_odometry = use_odometry;
             options.use_imu = use_imu;
             const py::gil_scoped_release release;
             return io::RawlogSource(path, options);
           }),
           py::arg("path"), py::kw_only(), py::arg("sensor_label") = "", py::arg("from_index") = 0,
           py::arg("to_index") = py::none(), py::arg("use_odometry") = true,
           py::arg("use_imu") = true,
           "sensor_label: of the stereo camera, or 'LEFT,RIGHT' of two cameras. Frames\n"
           "from_index ... to_index are returned. Raises InputError if the file is no rawlog or\n"
           "has no camera.")
      .def_property_readonly("camera", &cameraOf,
                             "StereoCamera of all frames; None if the recording has poses only")
      .def_property_readonly("skipped", &io::RawlogSource::skipped,
                             "number of skipped observations by class or reason, so far")
      .def_property_readonly("truncation", &io::RawlogSource::truncation,
                             "why the recording ended before its end; None if it did not")
      .def(
          "__iter__", [](io::RawlogSource& source) { return &source; },
          py::return_value_policy::reference)
      .def("__next__", [](io::RawlogSource& source) {
        auto frame = next(source);
        if (!frame) throw py::stop_iteration();
        return std::make_shared<RecordedFrame>(std::move(*frame));
      });
}

io::ImageStorage storageFrom(const std::string& name) {
  if (name == "embedded") return io::ImageStorage::kEmbedded;
  if (name == "embedded-raw") return io::ImageStorage::kEmbeddedRaw;
  if (name == "png") return io::ImageStorage::kExternalPng;
  if (name == "jpeg") return io::ImageStorage::kExternalJpeg;
  throw InputError("storage: '" + name + "' is none of embedded, embedded-raw, png, jpeg");
}

void writeStereo(io::RawlogSink& sink, Time time, const py::array& left, const py::array& right,
                 const StereoCamera& camera, const std::string& label) {
  const cv::Mat images[] = {imageFrom(left, "left"), imageFrom(right, "right")};
  requireSize({images[0], images[1]}, camera, "left, right");
  const py::gil_scoped_release release;
  sink.writeStereo(time, images[0], images[1], io::rawFrom(camera), label);
}

void writeDepth(io::RawlogSink& sink, Time time, const py::array& image, const py::array& depth,
                const StereoCamera& camera, const std::string& label) {
  if (!camera.isDepthCamera()) throw InputError("camera: has no depth_reach_m");
  const cv::Mat intensity = imageFrom(image, "image");
  const cv::Mat metres = depthFrom(depth, "depth");
  requireSize({intensity, metres}, camera, "image, depth");
  const py::gil_scoped_release release;
  const io::RawStereoCamera lens = io::rawFrom(camera);
  io::RawDepthCamera recorded;
  recorded.color = recorded.depth = lens.left;
  recorded.T_robot_color = lens.T_robot_left;
  recorded.max_range_m = camera.depth_reach_m;
  constexpr double kMaxUnits = 65534.0;  // 65535 is a hole, as 0
  cv::Mat units(metres.size(), CV_16U);
  std::transform(
      metres.begin<float>(), metres.end<float>(), units.begin<std::uint16_t>(), [&](float z) {
        const double rounded = std::round(static_cast<double>(z) / recorded.metres_per_unit);
        return static_cast<std::uint16_t>(rounded <= kMaxUnits ? rounded : 0.0);
      });
  sink.writeDepth(time, intensity, units, recorded, label);
}

void writePose(io::RawlogSink& sink, const std::string& label, Time time,
               const Eigen::Matrix4d& T_map_robot) {
  sink.writePose(label, time, poseFrom(T_map_robot));
}

void bindSink(py::module_& module) {
  py::class_<io::RawlogSink>(module, "RawlogSink",
                             "Writes a rawlog, in the order of the calls. It has a temporary name\n"
                             "until close() or the end of a `with` block without exception.")
      .def(py::init([](const std::string& path, const std::string& storage) {
             return std::make_unique<io::RawlogSink>(path, storageFrom(storage));
           }),
           py::arg("path"), py::kw_only(), py::arg("storage") = "embedded",
           "storage of images: 'embedded' (grey raw, colour as JPEG), 'embedded-raw', or 'png'\n"
           "and 'jpeg' in a folder beside the rawlog.")
      .def("write_stereo", &writeStereo, py::arg("time"), py::arg("left"), py::arg("right"),
           py::arg("camera"), py::arg("label") = "stereo",
           "A rectified pair of uint8: (height, width), or (height, width, 3) as BGR.")
      .def("write_depth", &writeDepth, py::arg("time"), py::arg("image"), py::arg("depth"),
           py::arg("camera"), py::arg("label") = "rgbd",
           "An image of uint8 as above, and its depth: (height, width) float32 [m] along the\n"
           "optical axis, 0 or not finite where unknown. It is stored in millimetres, to 65.5 m.")
      .def("write_detections", &io::RawlogSink::writeDetections, py::arg("label"),
           py::arg("detections"), "label: 'detections', or 'truth_objects' for evaluation.")
      .def("write_pose", &writePose, py::arg("label"), py::arg("time"), py::arg("T_map_robot"),
           "label: 'pose' (used instead of SLAM), or 'truth_pose' for evaluation.")
      .def("write_odometry", &io::RawlogSink::writeOdometry, py::arg("time"), py::arg("x"),
           py::arg("y"), py::arg("yaw"), "Planar pose by the wheels [m, m, rad].")
      .def("write_imu", &io::RawlogSink::writeImu, py::arg("time"), py::arg("angular_velocity"),
           py::arg("acceleration"), "In the robot frame [rad/s], [m/s^2] with gravity.")
      .def("close", &io::RawlogSink::close, "Completes the file. Raises InputError on failure.")
      .def(
          "__enter__", [](io::RawlogSink& sink) { return &sink; },
          py::return_value_policy::reference)
      .def(
          "__exit__",
          [](io::RawlogSink& sink, const py::object& type, const py::object&, const py::object&) {
            type.is_none() ? sink.close() : sink.discard();
          },
          py::arg("type"), py::arg("value"), py::arg("traceback"));
}

}  // namespace

void bindRecordings(py::module_& module) {
  bindSource(module);
  bindSink(module);
}

}  // namespace headway::python
