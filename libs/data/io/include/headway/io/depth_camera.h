// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::io {

/// Baseline of the stereo camera whose disparities have the noise of a depth camera [m].
///
/// Errors of structured light and of stereo cameras grow with the square of the depth, which is a
/// constant error of a disparity: sigma_z = k z^2 = z^2 s / (f b). With k = 0.0025 / m, measured
/// for such cameras, and s = 0.4 px, what headway assumes of disparities, all thresholds hold that
/// were made for stereo cameras.
///
/// @param focal_px  of the images that disparities belong to
/// @see  Khoshelham & Elberink 2012, "Accuracy and resolution of Kinect depth data" (k = 0.0014);
///       Ahn et al. 2019, "Analysis and noise modeling of the Intel RealSense D435" (k = 0.002)
[[nodiscard]] double equivalentBaseline(double focal_px);

}  // namespace headway::io
