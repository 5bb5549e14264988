// SPDX-License-Identifier: BSD-3-Clause
// Bindings of frames and recordings.
#include <headway/core/error.h>
#include <headway/core/recorded_frame.h>
#include <headway/io/image_file.h>
#include <headway/io/raw_camera.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "arrays.h"

namespace headway::python {
namespace {

std::string describeCamera(const StereoCamera& camera) {
  std::ostringstream text;
  text << "<headway.StereoCamera " << camera.width << " x " << camera.height << ", f " << camera.fx
       << " px, baseline " << camera.baseline_m << " m>";
  return text.str();
}

std::shared_ptr<StereoCamera> cameraFrom(int width, int height, double fx, double fy, double cx,
                                         double cy, std::optional<double> baseline_m,
                                         const std::optional<Eigen::Matrix4d>& T_robot_cam,
                                         double depth_reach_m) {
  if (!(depth_reach_m >= 0.0)) throw InputError("depth_reach_m: must not be negative");
  if (!baseline_m && depth_reach_m == 0.0) {
    throw InputError("baseline_m: is required of a stereo camera");
  }
  auto camera = std::make_shared<StereoCamera>();
  *camera = {width, height, fx, fy, cx, cy, baseline_m ? *baseline_m : io::equivalentBaseline(fx)};
  if (T_robot_cam) camera->T_robot_cam = poseFrom(*T_robot_cam);
  camera->depth_reach_m = depth_reach_m;
  validate(*camera);
  return camera;
}

void bindCamera(py::module_& module) {
  py::class_<StereoCamera, std::shared_ptr<StereoCamera>>(
      module, "StereoCamera",
      "A rectified stereo pair; the camera frame is the left camera's. Or a depth camera, whose\n"
      "depth image is registered to its intensity image.")
      .def(py::init(&cameraFrom), py::kw_only(), py::arg("width"), py::arg("height"), py::arg("fx"),
           py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("baseline_m") = py::none(),
           py::arg("T_robot_cam") = py::none(), py::arg("depth_reach_m") = 0.0,
           "T_robot_cam: 4x4, pose of the left optical frame (x right, y down, z forward) on the\n"
           "robot (x forward, y left, z up); None: the robot's origin, looking forward.\n"
           "depth_reach_m: maximum depth that a depth camera measures [m]; 0: a stereo pair.\n"
           "baseline_m: of a depth camera, None for that at which disparities have its noise.")
      .def_readonly("width", &StereoCamera::width, "[px]")
      .def_readonly("height", &StereoCamera::height, "[px]")
      .def_readonly("fx", &StereoCamera::fx, "[px]")
      .def_readonly("fy", &StereoCamera::fy, "[px]")
      .def_readonly("cx", &StereoCamera::cx, "[px]")
      .def_readonly("cy", &StereoCamera::cy, "[px]")
      .def_readonly("baseline_m", &StereoCamera::baseline_m, "[m]")
      .def_property_readonly(
          "T_robot_cam",
          [](const StereoCamera& camera) { return Eigen::Matrix4d(camera.T_robot_cam.matrix()); },
          "4x4, pose of the left optical frame on the robot")
      .def_readonly("depth_reach_m", &StereoCamera::depth_reach_m,
                    "maximum depth of a depth camera [m]; 0: a stereo pair")
      .def("__repr__", &describeCamera);
}

std::shared_ptr<RecordedFrame> frameOf(std::size_t index, Time time, const cv::Mat& image,
                                       const std::shared_ptr<StereoCamera>& camera) {
  if (!camera) throw InputError("camera: must not be None");
  if (!std::isfinite(time)) throw InputError("time: must be finite");
  StereoFrame stereo;
  stereo.index = index;
  stereo.time = time;
  stereo.left = io::greyOf(image);
  if (image.channels() == 3) stereo.left_colour = image;
  stereo.camera = camera;
  auto frame = std::make_shared<RecordedFrame>();
  frame->index = index;
  frame->time = time;
  frame->stereo = std::move(stereo);
  return frame;
}

std::shared_ptr<RecordedFrame> stereoFrame(std::size_t index, Time time, const py::array& left,
                                           const py::array& right,
                                           const std::shared_ptr<StereoCamera>& camera) {
  auto frame = frameOf(index, time, imageFrom(left, "left"), camera);
  if (camera->isDepthCamera()) throw InputError("camera: is a depth camera; use from_depth()");
  frame->stereo->right = io::greyOf(imageFrom(right, "right"));
  requireSize({frame->stereo->left, frame->stereo->right}, *camera, "left, right");
  return frame;
}

std::shared_ptr<RecordedFrame> depthFrame(std::size_t index, Time time, const py::array& image,
                                          const py::array& depth,
                                          const std::shared_ptr<StereoCamera>& camera) {
  auto frame = frameOf(index, time, imageFrom(image, "image"), camera);
  if (!camera->isDepthCamera()) throw InputError("camera: has no depth_reach_m");
  cv::Mat disparity = depthFrom(depth, "depth");
  requireSize({frame->stereo->left, disparity}, *camera, "image, depth");
  const auto focal_baseline = static_cast<float>(camera->fx * camera->baseline_m);
  std::transform(disparity.begin<float>(), disparity.end<float>(), disparity.begin<float>(),
                 [&](float z) { return z > 0.0F ? focal_baseline / z : 0.0F; });
  frame->stereo->disparity = disparity;
  return frame;
}

/// An image of the frame; None if the recording has poses and boxes only.
template <typename Number, cv::Mat StereoFrame::*Image>
std::optional<py::array_t<Number>> imageOf(const RecordedFrame& frame) {
  if (!frame.stereo || (*frame.stereo.*Image).empty()) return std::nullopt;
  return py::array_t<Number>(arrayOf(*frame.stereo.*Image));
}

std::optional<py::array_t<float>> depthOf(const RecordedFrame& frame) {
  if (!frame.stereo || frame.stereo->disparity.empty()) return std::nullopt;
  const cv::Mat& disparity = frame.stereo->disparity;
  const auto& camera = *frame.stereo->camera;
  const auto focal_baseline = static_cast<float>(camera.fx * camera.baseline_m);
  py::array_t<float> depth({disparity.rows, disparity.cols});
  std::transform(disparity.begin<float>(), disparity.end<float>(), depth.mutable_data(),
                 [&](float d) { return d > 0.0F ? focal_baseline / d : 0.0F; });
  return depth;
}

std::optional<Eigen::Matrix4d> poseOf(const RecordedFrame& frame) {
  if (!frame.T_map_robot) return std::nullopt;
  return Eigen::Matrix4d(frame.T_map_robot->matrix());
}

using FrameClass = py::class_<RecordedFrame, std::shared_ptr<RecordedFrame>>;

FrameClass bindConstructors(py::module_& module) {
  return FrameClass(module, "Frame",
                    "One stereo pair, or image with depth, with its time and what was recorded "
                    "with it.")
      .def(py::init(&stereoFrame), py::arg("index"), py::arg("time"), py::arg("left"),
           py::arg("right"), py::arg("camera"),
           "From rectified images of uint8: (height, width), or (height, width, 3) as BGR. They\n"
           "are copied. All frames of one Perception must be given the same camera.")
      .def_static("from_depth", &depthFrame, py::arg("index"), py::arg("time"), py::arg("image"),
                  py::arg("depth"), py::arg("camera"),
                  "From an image of uint8 as above and its depth: (height, width) float32 [m]\n"
                  "along the optical axis, 0 or not finite where unknown. Both are copied.");
}

void bindFrame(py::module_& module) {
  bindConstructors(module)
      .def_readonly("index", &RecordedFrame::index, "of the stereo pair in its recording, from 0")
      .def_readonly("time", &RecordedFrame::time, "[s] since the Unix epoch")
      .def_property_readonly("left", &imageOf<std::uint8_t, &StereoFrame::left>,
                             "(height, width) uint8, rectified; read-only, not copied")
      .def_property_readonly("right", &imageOf<std::uint8_t, &StereoFrame::right>,
                             "as left; None of a depth camera")
      .def_property_readonly("left_colour", &imageOf<std::uint8_t, &StereoFrame::left_colour>,
                             "(height, width, 3) uint8 BGR; None if the recording is grey")
      .def_property_readonly("disparity", &imageOf<float, &StereoFrame::disparity>,
                             "(height, width) float32 [px], 0 where unknown, of a depth camera;\n"
                             "None of a stereo pair, whose disparities are not given")
      .def_property_readonly(
          "depth", &depthOf,
          "(height, width) float32 [m] along the optical axis, 0 where unknown,\n"
          "of a depth camera: a new array, from the disparities; else None")
      .def_property_readonly(
          "T_map_robot", &poseOf,
          "4x4, the recorded pose that is used instead of SLAM; None if there is none")
      .def_readwrite("detections", &RecordedFrame::detections,
                     "Detections that are used, beside those of the detectors; None: no detector\n"
                     "ran on this frame");
}

}  // namespace

void bindFrames(py::module_& module) {
  bindCamera(module);
  bindFrame(module);
}

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
