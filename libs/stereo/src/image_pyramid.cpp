#include <headway/stereo/image_pyramid.h>

#include <opencv2/imgproc.hpp>

namespace headway::stereo {

ImagePyramid buildPyramid(const cv::Mat& image, int count) {
  constexpr int kMinSize = 32;
  ImagePyramid pyramid;
  pyramid.levels.push_back(image);
  for (int level = 1; level < count; ++level) {
    const cv::Mat& finer = pyramid.levels.back();
    if (finer.cols < 2 * kMinSize || finer.rows < 2 * kMinSize) break;
    cv::Mat coarser;
    cv::pyrDown(finer, coarser);
    pyramid.levels.push_back(coarser);
  }
  return pyramid;
}

}  // namespace headway::stereo
