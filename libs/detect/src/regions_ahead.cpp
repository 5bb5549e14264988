#include "regions_ahead.h"

#include <opencv2/core.hpp>

namespace headway::detect {
namespace {

// How far an object's middle moves in the image [px].
cv::Point2d shiftOf(const MovingObject& object, const CameraPath& path, const StereoCamera& camera,
                    double ahead) {
  const Eigen::Vector3d centre = object.detection.box3d->centre;
  const Eigen::Vector3d& velocity = object.detection.velocity->value;
  const auto from = project(centre, camera);
  const auto to = project(path.expectedMotion(ahead) * (centre + ahead * velocity), camera);
  if (!from || !to) return {};
  return {to->x() - from->x(), to->y() - from->y()};
}

}  // namespace

MovingRegions regionsAhead(const std::vector<MovingObject>& objects,
                           const std::vector<std::vector<cv::Point>>& cells, int reduce,
                           const CameraPath& path, const StereoCamera& camera, double ahead) {
  MovingRegions regions;
  regions.mask = cv::Mat(camera.height, camera.width, CV_8U, cv::Scalar(0));
  const cv::Rect image({0, 0}, regions.mask.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const cv::Point2d shift = shiftOf(objects[i], path, camera, ahead);
    const Box2d& box = *objects[i].detection.box2d;
    regions.boxes.push_back(
        {box.left + shift.x, box.top + shift.y, box.right + shift.x, box.bottom + shift.y});
    for (const auto& cell : cells[i]) {
      // One cell more each way: the outline's corners are the worst landmarks.
      const cv::Rect square((cell.x - 1) * reduce + cvRound(shift.x),
                            (cell.y - 1) * reduce + cvRound(shift.y), 3 * reduce, 3 * reduce);
      regions.mask(square & image).setTo(255);
    }
  }
  return regions;
}

}  // namespace headway::detect
