// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/io/image_file.h>
#include <headway/io/rawlog_sink.h>
#include <headway/io/rawlog_source.h>
#include <pybind11/operators.h>

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

void bindCamera(py::module_& module) {
  py::class_<StereoCamera, std::shared_ptr<StereoCamera>>(
      module, "StereoCamera", "A rectified stereo pair; the camera frame is the left camera's.")
      .def(py::init([](int width, int height, double fx, double fy, double cx, double cy,
                       double baseline_m, const std::optional<Eigen::Matrix4d>& T_robot_cam) {
             auto camera = std::make_shared<StereoCamera>();
             *camera = {width, height, fx, fy, cx, cy, baseline_m};
             if (T_robot_cam) camera->T_robot_cam = poseFrom(*T_robot_cam);
             validate(*camera);
             return camera;
           }),
           py::kw_only(), py::arg("width"), py::arg("height"), py::arg("fx"), py::arg("fy"),
           py::arg("cx"), py::arg("cy"), py::arg("baseline_m"), py::arg("T_robot_cam") = py::none(),
           "T_robot_cam: 4x4, pose of the left optical frame (x right, y down, z forward) on the\n"
           "robot (x forward, y left, z up); None: the robot's origin, looking forward.")
      .def_readonly("width", &StereoCamera::width, "[px]")
      .def_readonly("height", &StereoCamera::height, "[px]")
      .def_readonly("fx", &StereoCamera::fx, "[px]")
      .def_readonly("fy", &StereoCamera::fy, "[px]")
      .def_readonly("cx", &StereoCamera::cx, "[px]")
      .def_readonly("cy", &StereoCamera::cy, "[px]")
      .def_readonly("baseline_m", &StereoCamera::baseline_m, "[m]")
      .def_property_readonly(
          "T_robot_cam", [](const StereoCamera& camera) { return camera.T_robot_cam.matrix(); },
          "4x4, pose of the left optical frame on the robot")
      .def("__repr__", &describeCamera);
}

std::shared_ptr<RecordedFrame> frameFrom(std::size_t index, Time time, const py::array& left,
                                         const py::array& right,
                                         const std::shared_ptr<StereoCamera>& camera) {
  if (!camera) throw InputError("camera: must not be None");
  StereoFrame stereo;
  stereo.index = index;
  stereo.time = time;
  const cv::Mat image = imageFrom(left, "left");
  stereo.left = io::greyOf(image);
  stereo.right = io::greyOf(imageFrom(right, "right"));
  if (image.channels() == 3) stereo.left_colour = image;
  stereo.camera = camera;
  const cv::Size size(camera->width, camera->height);
  if (stereo.left.size() != size || stereo.right.size() != size) {
    throw InputError("left, right: must have the camera's size");
  }
  if (!std::isfinite(time)) throw InputError("time: must be finite");
  auto frame = std::make_shared<RecordedFrame>();
  frame->index = index;
  frame->time = time;
  frame->stereo = std::move(stereo);
  return frame;
}

/// An image of the frame; None if the recording has poses and boxes only.
template <cv::Mat StereoFrame::*Image>
py::object imageOf(const RecordedFrame& frame) {
  return frame.stereo ? arrayOf(*frame.stereo.*Image) : py::none();
}

void bindFrame(py::module_& module) {
  py::class_<RecordedFrame, std::shared_ptr<RecordedFrame>>(
      module, "Frame", "One stereo pair with its time, and what was recorded with it.")
      .def(py::init(&frameFrom), py::arg("index"), py::arg("time"), py::arg("left"),
           py::arg("right"), py::arg("camera"),
           "From rectified images of uint8: (height, width), or (height, width, 3) as BGR. They\n"
           "are copied. All frames of one Perception must be given the same camera.")
      .def_readonly("index", &RecordedFrame::index, "of the stereo pair in its recording, from 0")
      .def_readonly("time", &RecordedFrame::time, "[s] since the Unix epoch")
      .def_property_readonly("left", &imageOf<&StereoFrame::left>,
                             "(height, width) uint8, rectified; read-only, not copied")
      .def_property_readonly("right", &imageOf<&StereoFrame::right>,
                             "as left; None of a depth camera")
      .def_property_readonly("left_colour", &imageOf<&StereoFrame::left_colour>,
                             "(height, width, 3) uint8 BGR; None if the recording is grey")
      .def_property_readonly("disparity", &imageOf<&StereoFrame::disparity>,
                             "(height, width) float32 [px], 0 where unknown, of a depth camera;\n"
                             "None of a stereo pair, whose disparities are not given")
      .def_property_readonly(
          "T_map_robot",
          [](const RecordedFrame& frame) {
            return frame.T_map_robot ? py::cast(Eigen::Matrix4d(frame.T_map_robot->matrix()))
                                     : py::none();
          },
          "4x4, the recorded pose that is used instead of SLAM; None if there is none")
      .def_readwrite("detections", &RecordedFrame::detections,
                     "Detections that are used, beside those of the detectors; None: no detector\n"
                     "ran on this frame");
}

std::optional<RecordedFrame> next(io::RawlogSource& source) {
  const py::gil_scoped_release release;
  return source.next();
}

void bindSource(py::module_& module) {
  py::class_<io::RawlogSource>(module, "RawlogSource",
                               "Reads a rawlog as rectified stereo frames: iterate over it.")
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
      .def_property_readonly(
          "camera",
          [](const io::RawlogSource& source) {
            return std::const_pointer_cast<StereoCamera>(source.camera());
          },
          "StereoCamera of all frames; None if the recording has poses only")
      .def_property_readonly("skipped", &io::RawlogSource::skipped,
                             "number of skipped observations by class or reason, so far")
      .def_property_readonly("truncation", &io::RawlogSource::truncation,
                             "why the recording ended before its end; None if it did not")
      .def("__iter__", [](py::object self) { return self; })
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
  for (const auto& image : images) {
    if (image.cols != camera.width || image.rows != camera.height) {
      throw InputError("left, right: must have the camera's size");
    }
  }
  const py::gil_scoped_release release;
  sink.writeStereo(time, images[0], images[1], io::rawFrom(camera), label);
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
      .def("write_detections", &io::RawlogSink::writeDetections, py::arg("label"),
           py::arg("detections"), "label: 'detections', or 'truth_objects' for evaluation.")
      .def(
          "write_pose",
          [](io::RawlogSink& sink, const std::string& label, Time time,
             const Eigen::Matrix4d& T_map_robot) {
            sink.writePose(label, time, poseFrom(T_map_robot));
          },
          py::arg("label"), py::arg("time"), py::arg("T_map_robot"),
          "label: 'pose' (used instead of SLAM), or 'truth_pose' for evaluation.")
      .def("write_odometry", &io::RawlogSink::writeOdometry, py::arg("time"), py::arg("x"),
           py::arg("y"), py::arg("yaw"), "Planar pose by the wheels [m, m, rad].")
      .def("write_imu", &io::RawlogSink::writeImu, py::arg("time"), py::arg("angular_velocity"),
           py::arg("acceleration"), "In the robot frame [rad/s], [m/s^2] with gravity.")
      .def("close", &io::RawlogSink::close, "Completes the file. Raises InputError on failure.")
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](io::RawlogSink& sink, const py::object& type, const py::object&,
                          const py::object&) { type.is_none() ? sink.close() : sink.discard(); });
}

}  // namespace

void bindRecordings(py::module_& module) {
  bindCamera(module);
  bindFrame(module);
  bindSource(module);
  bindSink(module);
}

}  // namespace headway::python
