// SPDX-License-Identifier: BSD-3-Clause
// Finds upright people by OpenCV's histograms of oriented gradients.
#include <headway/detect/person_detector.h>

#include <opencv2/imgproc.hpp>
#include <opencv2/objdetect.hpp>

#include "network_boxes.h"

namespace headway::detect {
namespace {

// The detector's window is 64 x 128 px around a person of about 32 x 96 px.
constexpr double kSideMargin = 0.2;
constexpr double kEndMargin = 0.1;

Box2d personIn(const cv::Rect& window, double upscale) {
  return {(window.x + kSideMargin * window.width) / upscale,
          (window.y + kEndMargin * window.height) / upscale,
          (window.br().x - kSideMargin * window.width) / upscale,
          (window.br().y - kEndMargin * window.height) / upscale};
}

}  // namespace

void PersonParams::describe(Params::Section section) {
  section.user().add("min_score", min_score, 0.0, 10.0, "",
                     "Minimum distance from the decision plane; smaller finds more people and "
                     "more false ones");
  section.add("upscale", upscale, 0.5, 4.0, "",
              "Enlargement of the image; the smallest person found is 96 px / upscale high");
  section.add("scale_step", scale_step, 1.02, 2.0, "", "Ratio of successive scales searched");
  section.add("nms_iou", nms_iou, 0.0, 1.0, "IoU",
              "Non-maximum suppression: overlap from which the lower score is dropped");
}

class PersonDetector::Implementation {
 public:
  explicit Implementation(const PersonParams& params) : params_(params) {
    hog_.setSVMDetector(cv::HOGDescriptor::getDefaultPeopleDetector());
  }

  [[nodiscard]] std::vector<Detection> detect(const cv::Mat& grey) const {
    cv::Mat image;
    cv::resize(grey, image, {}, params_.upscale, params_.upscale, cv::INTER_LINEAR);
    if (image.rows < hog_.winSize.height || image.cols < hog_.winSize.width) return {};
    std::vector<cv::Rect> windows;
    std::vector<double> scores;
    // Without OpenCV's grouping: it averages boxes in the order in which threads found them.
    hog_.detectMultiScale(image, windows, scores, params_.min_score, {8, 8}, {}, params_.scale_step,
                          0.0);
    std::vector<NetworkBox> boxes(windows.size());
    for (std::size_t i = 0; i < windows.size(); ++i) {
      boxes[i].box = personIn(windows[i], params_.upscale);
      boxes[i].score = scores[i];
    }
    return toDetections(withoutOverlaps(std::move(boxes), params_.nms_iou),
                        networkClasses("Pedestrian"));
  }

 private:
  PersonParams params_;
  cv::HOGDescriptor hog_;
};

PersonDetector::PersonDetector(const PersonParams& params)
    : implementation_(std::make_unique<Implementation>(validated(params))) {}

PersonDetector::~PersonDetector() = default;

Detections PersonDetector::detect(const StereoFrame& frame) {
  Detections detections = emptyDetections(frame);
  detections.items = implementation_->detect(frame.left);
  for (auto& detection : detections.items) detection.evidence.classifier = true;
  return detections;
}

}  // namespace headway::detect
