// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/recorded_frame.h>
#include <headway/io/image_file.h>
#include <headway/io/raw_camera.h>

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

}  // namespace headway::python
