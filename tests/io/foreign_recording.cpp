// SPDX-License-Identifier: BSD-3-Clause
#include "foreign_recording.h"

#include <headway/core/mrpt_pose.h>
#include <headway/io/mrpt_time.h>
#include <mrpt/io/CFileGZOutputStream.h>
#include <mrpt/io/CFileOutputStream.h>
#include <mrpt/serialization/CArchive.h>

#include <opencv2/core/mat.hpp>

#include "synthetic_recording.h"

namespace headway::io::test {
namespace {

mrpt::img::TCamera lens() {
  const StereoCamera camera = smallCamera();
  mrpt::img::TCamera result;
  result.ncols = static_cast<uint32_t>(camera.width);
  result.nrows = static_cast<uint32_t>(camera.height);
  result.setIntrinsicParamsFromValues(camera.fx, camera.fy, camera.cx, camera.cy);
  return result;
}

mrpt::img::CImage copied(const cv::Mat& image) { return {image, mrpt::img::DEEP_COPY}; }

template <typename Stream>
void writeTo(Stream& stream, const std::vector<mrpt::serialization::CSerializable::Ptr>& objects) {
  auto archive = mrpt::serialization::archiveFrom(stream);
  for (const auto& object : objects) archive << *object;
}

}  // namespace

void writeObjects(const std::string& path,
                  const std::vector<mrpt::serialization::CSerializable::Ptr>& objects,
                  bool compressed) {
  if (compressed) {
    mrpt::io::CFileGZOutputStream stream(path);
    writeTo(stream, objects);
  } else {
    mrpt::io::CFileOutputStream stream(path);
    writeTo(stream, objects);
  }
}

mrpt::obs::CObservationStereoImages::Ptr wallObservation(int number, Time time,
                                                         const std::string& label) {
  auto observation = mrpt::obs::CObservationStereoImages::Create();
  const auto [left, right] = wall(number);
  observation->timestamp = mrptTime(time);
  observation->sensorLabel = label;
  observation->imageLeft = copied(left);
  observation->imageRight = copied(right);
  observation->hasImageRight = true;
  observation->leftCamera = observation->rightCamera = lens();
  observation->cameraPose = toMrptQuat(smallCamera().T_robot_cam);
  observation->rightCameraPose.x(smallCamera().baseline_m);
  return observation;
}

mrpt::obs::CObservationImage::Ptr singleImage(int side, int number, Time time,
                                              const std::string& label) {
  auto observation = mrpt::obs::CObservationImage::Create();
  const auto [left, right] = wall(number);
  observation->timestamp = mrptTime(time);
  observation->sensorLabel = label;
  observation->image = copied(side == 0 ? left : right);
  observation->cameraParams = lens();
  Pose T_robot_cam = smallCamera().T_robot_cam;
  if (side == 1) T_robot_cam.translate(Eigen::Vector3d(smallCamera().baseline_m, 0, 0));
  observation->cameraPose = toMrpt(T_robot_cam);
  return observation;
}

}  // namespace headway::io::test
