// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/appearance.h>
#include <headway/detect/stereo_motion.h>

#include <opencv2/core.hpp>

namespace headway::detect {
namespace {

// Points of the camera frame as seen from the camera some time later.
Pose cameraMotion(const MotionDetections& motion, double ahead) {
  Pose T_later_now = Pose::Identity();
  T_later_now.linear() = expSo3(ahead * motion.camera_turn_rate);
  T_later_now.translation() = ahead * motion.camera_velocity;
  return T_later_now;
}

// How far an object's centre moves in the image [px].
cv::Point2d shiftOf(const Detection& object, const Pose& T_later_now, const StereoCamera& camera,
                    double ahead) {
  const Eigen::Vector3d& centre = object.box3d->centre;
  const auto from = project(centre, camera);
  const auto to = project(T_later_now * (centre + ahead * object.velocity->value), camera);
  if (!from || !to) return {};
  return {to->x() - from->x(), to->y() - from->y()};
}

// One cell more each way: landmarks on the outline's corners are the worst.
void draw(const ObjectMask& object, const cv::Point2d& shift, cv::Mat& mask) {
  const cv::Rect image({0, 0}, mask.size());
  const int reduce = object.reduce;
  for (int row = 0; row < object.cells.rows; ++row) {
    for (int column = 0; column < object.cells.cols; ++column) {
      if (object.cells.at<unsigned char>(row, column) == 0) continue;
      const cv::Point cell = object.corner + cv::Point(column, row);
      const cv::Rect square((cell.x - 1) * reduce + cvRound(shift.x),
                            (cell.y - 1) * reduce + cvRound(shift.y), 3 * reduce, 3 * reduce);
      mask(square & image).setTo(255);
    }
  }
}

}  // namespace

MovingRegions MotionDetections::regionsAt(Time at, const StereoCamera& camera) const {
  MovingRegions regions;
  if (!detections || detections->items.empty()) return regions;
  const double ahead = at - detections->time;
  if (ahead > max_ahead_s) return regions;
  const Pose T_later_now = cameraMotion(*this, ahead);
  regions.mask = cv::Mat(camera.height, camera.width, CV_8U, cv::Scalar(0));
  for (const auto& object : detections->items) {
    const cv::Point2d shift = shiftOf(object, T_later_now, camera, ahead);
    const Box2d& box = *object.box2d;
    regions.boxes.push_back(
        {{box.left + shift.x, box.top + shift.y, box.right + shift.x, box.bottom + shift.y}});
    if (object.mask != nullptr) draw(*object.mask, shift, regions.mask);
  }
  return regions;
}

}  // namespace headway::detect
