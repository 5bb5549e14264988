// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/stereo_frame.h>
#include <headway/stereo/disparity.h>

namespace headway::stereo {

/// Disparities of as much of the surfaces as possible, for maps: slower than denseDisparity() with
/// blocks. Of a depth camera, its disparities.
///
/// Semi-global matching also tells the disparities of weakly textured surfaces, but prefers whole
/// ones of the reduced image: where there is texture, they are refined by least squares of the
/// intensities in a window (one-dimensional Lucas-Kanade).
///
/// @param params  range, reduction and speckles; the method is semi-global
///
/// @see  Hirschmueller 2008, "Stereo processing by semiglobal matching and mutual information";
///       Shimizu & Okutomi 2005, "Sub-pixel estimation error cancellation on area-based matching"
[[nodiscard]] DisparityImage surfaceDisparity(const StereoFrame& frame, DisparityParams params);

/// Corrects all disparities by their offset: measured less true disparity [px].
void subtractOffset(double offset_px, DisparityImage& disparity);

}  // namespace headway::stereo
