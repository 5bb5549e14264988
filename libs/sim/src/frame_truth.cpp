#include <headway/sim/simulator.h>

namespace headway::sim {

int occlusionLevel(double visible) {
  if (visible >= 0.8) return 0;
  if (visible >= 0.4) return 1;
  return visible >= 0.1 ? 2 : 3;
}

cv::Mat dynamicMask(const SimFrame& frame) {
  cv::Mat mask = cv::Mat::zeros(frame.instances.size(), CV_8U);
  for (int v = 0; v < mask.rows; ++v) {
    const auto* labels = frame.instances.ptr<std::uint16_t>(v);
    auto* marks = mask.ptr<uchar>(v);
    for (int u = 0; u < mask.cols; ++u) {
      if (labels[u] != 0 && !frame.objects[labels[u] - 1U].parked) marks[u] = 255;
    }
  }
  return mask;
}

}  // namespace headway::sim
