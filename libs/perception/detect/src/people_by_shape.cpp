// SPDX-License-Identifier: BSD-3-Clause
// Finds people by their shape in the disparities of one frame, whether they move or not.
#include <headway/detect/detector.h>
#include <headway/detect/people_by_shape.h>
#include <headway/stereo/rig_capability.h>

#include <algorithm>
#include <cmath>
#include <opencv2/dnn.hpp>
#include <vector>

#include "people_net.h"
#include "shape_patch.h"

namespace headway::detect {
namespace {

/// What is assumed of people.
struct UsualPerson {
  double width_m = 0.6;
  double height_m = 1.7;  ///< where the image does not show the head
  double lowest_m = 1.1;  ///< also seated; backs of chairs end below
  double highest_m = 2.0;
  double body_m = 1.1;    ///< height to which the image has to show those who are not
  double near_m = 1.7;    ///< as near as this
  double apart_m = 0.45;  ///< of two, middle to middle
  double sigma_m = 0.08;  ///< of the network's place across, and away beside the noise of a depth
};
constexpr UsualPerson kPerson{};

/// A person that the network sees.
struct Found {
  double score = 0.0;
  Eigen::Vector3d foot = Eigen::Vector3d::Zero();  ///< on the ground, camera frame [m]
  double height_m = 0.0;
};

/// Height of what is seen in the middle of a patch; the usual one where the image cuts it.
double heightIn(const cv::Mat& patch) {
  const ShapePatchLayout& size = kShapePatch;
  const auto at = [&](int channel, int row, int column) {
    return patch.at<unsigned char>(channel * size.rows + row, column);
  };
  for (int row = 0; row < size.rows; ++row) {
    int seen = 0, outside = 0;
    for (int column = size.columns / 4; column < 3 * size.columns / 4; ++column) {
      seen += at(1, row, column) > 100 ? 1 : 0;
      outside += at(4, row, column) > 0 ? 1 : 0;
    }
    if (seen < 2) continue;
    const bool cut = row == 0 || at(4, row - 1, size.columns / 2) > 0 || outside > 0;
    const double height = (size.rows - row) * size.cell_m;
    return cut ? std::max(kPerson.height_m, height) : std::min(height, kPerson.highest_m);
  }
  return kPerson.height_m;
}

/// Score that a patch needs to show a person. Legs alone look like those of tables: they count only
/// where somebody so near fills the image, and with a tenth of the doubt.
double neededScore(const cv::Mat& patch, double depth_m, double min_score) {
  const ShapePatchLayout& size = kShapePatch;
  const int row = size.rows - static_cast<int>(kPerson.body_m / size.cell_m);
  const bool shows_body = patch.at<unsigned char>(4 * size.rows + row, size.columns / 2) == 0;
  if (shows_body) return min_score;
  return depth_m < kPerson.near_m ? 1.0 - 0.1 * (1.0 - min_score) : 1.0;
}

/// The best of those that may be one person.
std::vector<Found> distinct(std::vector<Found> found) {
  std::stable_sort(found.begin(), found.end(),
                   [](const Found& a, const Found& b) { return a.score > b.score; });
  std::vector<Found> kept;
  for (const Found& person : found) {
    const auto isSame = [&](const Found& other) {
      return (other.foot - person.foot).norm() < kPerson.apart_m;
    };
    if (std::none_of(kept.begin(), kept.end(), isSame)) kept.push_back(person);
  }
  return kept;
}

}  // namespace

void ShapeParams::describe(Params::Section section) {
  section.add("min_score", min_score, 0.0, 1.0, "",
              "Minimum score of a person; smaller finds more people and more false ones");
  section.add("max_range_m", max_range_m, 0.0, 50.0, "m",
              "Maximum distance; 0: as the rig's depths allow, by stereo 12 m at most");
}

class PeopleByShape::Implementation {
 public:
  explicit Implementation(const ShapeParams& params)
      : params_(params),
        net_(cv::dnn::readNetFromONNX(reinterpret_cast<const char*>(kPeopleNet),
                                      sizeof(kPeopleNet))) {}

  std::vector<Found> find(const stereo::DisparityImage& disparity, const StereoCamera& camera,
                          const stereo::GroundPlane& ground) {
    double range_m = params_.max_range_m > 0.0 ? params_.max_range_m
                                               : stereo::rigCapability(camera).standing_to_m;
    if (camera.isDepthCamera()) range_m = std::min(range_m, camera.depth_reach_m);
    const auto places = standingPlaces(disparity, camera, ground, range_m);
    if (places.empty()) return {};
    std::vector<cv::Mat> patches;
    for (const auto& place : places) {
      patches.push_back(shapePatch(place, disparity, camera, ground));
    }
    const cv::Mat said = run(patches);
    std::vector<Found> found;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const auto* values = said.ptr<float>(static_cast<int>(i));
      const double score = 1.0 / (1.0 + std::exp(-values[0]));
      if (score < neededScore(patches[i], places[i].z(), params_.min_score)) continue;
      const double height = heightIn(patches[i]);
      if (height < kPerson.lowest_m) continue;
      const auto [across, away] = axesAt(places[i], ground);
      found.push_back({score, places[i] + values[1] * across + values[2] * away, height});
    }
    return distinct(std::move(found));
  }

 private:
  // A row for each patch: log-odds of a person, and the offset of its middle to the right and away
  // from the camera [m].
  cv::Mat run(const std::vector<cv::Mat>& patches) {
    const ShapePatchLayout& size = kShapePatch;
    const int count = static_cast<int>(patches.size());
    cv::Mat input({count, size.channels, size.rows, size.columns}, CV_32F);
    for (int i = 0; i < count; ++i) {
      cv::Mat one(size.channels * size.rows, size.columns, CV_32F, input.ptr<float>(i));
      patches[static_cast<std::size_t>(i)].convertTo(one, CV_32F, 1.0 / 255.0);
    }
    net_.setInput(input);
    return net_.forward().clone();
  }

  ShapeParams params_;
  cv::dnn::Net net_;
};

PeopleByShape::PeopleByShape(const ShapeParams& params)
    : implementation_(std::make_unique<Implementation>(validated(params))) {}

PeopleByShape::~PeopleByShape() = default;
PeopleByShape::PeopleByShape(PeopleByShape&&) noexcept = default;

Detections PeopleByShape::detect(const stereo::FrameContext& context) {
  Detections detections = emptyDetections(context.frame());
  const auto& ground = context.ground();
  if (!ground) return detections;
  const StereoCamera& camera = context.camera();
  const auto rig = stereo::rigCapability(camera);
  for (const Found& person : implementation_->find(context.disparity(), camera, *ground)) {
    const auto [across, away] = axesAt(person.foot, *ground);
    Detection detection;
    detection.object_class = ObjectClass::kPedestrian;
    detection.score = person.score;
    detection.evidence.classifier = true;
    Box3d box;
    box.centre = person.foot + 0.5 * person.height_m * ground->up;
    box.length = box.width = kPerson.width_m;
    box.height = person.height_m;
    box.yaw = opticalYaw(away);
    detection.box3d = box;
    const double depth_sigma = std::hypot(kPerson.sigma_m, rig.depthSigma(box.centre.z()));
    detection.centre_covariance =
        kPerson.sigma_m * kPerson.sigma_m * Eigen::Matrix3d::Identity() +
        (depth_sigma * depth_sigma - kPerson.sigma_m * kPerson.sigma_m) * away * away.transpose();
    const Eigen::Vector3d half = 0.5 * kPerson.width_m * across;
    const auto top = project(person.foot + person.height_m * ground->up - half, camera);
    const auto bottom = project(person.foot + half, camera);
    if (!top || !bottom) continue;
    const double right = camera.width - 1.0, low = camera.height - 1.0;
    detection.box2d = Box2d{std::clamp(top->x(), 0.0, right), std::clamp(top->y(), 0.0, low),
                            std::clamp(bottom->x(), 0.0, right), std::clamp(bottom->y(), 0.0, low)};
    detections.items.push_back(std::move(detection));
  }
  return detections;
}

}  // namespace headway::detect
