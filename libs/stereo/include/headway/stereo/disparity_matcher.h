#pragma once

#include <headway/stereo/disparity.h>

#include <future>

namespace headway::stereo {

/// Matches each frame densely at most once, however many ask for its disparities.
///
/// A frame announced by begin() is matched in a thread of its own while the caller does something
/// else. The result does not depend on whether it was announced. For one calling thread.
///
///     matcher.begin(frame);                   // matching starts
///     auto pose = slam.process(frame, {});    // meanwhile
///     const auto& disparity = matcher.of(frame);
class DisparityMatcher {
 public:
  /// @throws InputError if a parameter is out of range
  explicit DisparityMatcher(const DisparityParams& params) : params_(validated(params)) {}
  ~DisparityMatcher();
  DisparityMatcher(const DisparityMatcher&) = delete;
  DisparityMatcher& operator=(const DisparityMatcher&) = delete;

  /// Starts on a frame; does nothing for the frame it has already.
  void begin(const StereoFrame& frame);

  /// Disparities of a frame; the reference holds until another frame is asked for or begun.
  [[nodiscard]] const DisparityImage& of(const StereoFrame& frame);

 private:
  [[nodiscard]] bool isCurrent(const StereoFrame& frame) const;

  DisparityParams params_;
  StereoFrame frame_;  ///< current one; its images live on, so that no other frame can be theirs
  std::future<DisparityImage> pending_;
  DisparityImage disparity_;
};

}  // namespace headway::stereo
