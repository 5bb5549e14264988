#include <headway/stereo/disparity_matcher.h>

namespace headway::stereo {

DisparityMatcher::~DisparityMatcher() {
  if (pending_.valid()) pending_.wait();
}

bool DisparityMatcher::isCurrent(const StereoFrame& frame) const {
  return frame_.camera != nullptr && frame.left.data == frame_.left.data &&
         frame.right.data == frame_.right.data && frame.time == frame_.time;
}

void DisparityMatcher::begin(const StereoFrame& frame) {
  if (isCurrent(frame)) return;
  if (pending_.valid()) pending_.wait();
  frame_ = frame;
  pending_ = std::async(std::launch::async,
                        [frame, params = params_] { return denseDisparity(frame, params); });
}

const DisparityImage& DisparityMatcher::of(const StereoFrame& frame) {
  if (!isCurrent(frame)) {
    if (pending_.valid()) pending_.wait();
    pending_ = {};
    frame_ = frame;
    disparity_ = denseDisparity(frame, params_);
  } else if (pending_.valid()) {
    disparity_ = pending_.get();
  }
  return disparity_;
}

}  // namespace headway::stereo
