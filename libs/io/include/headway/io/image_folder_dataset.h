#pragma once

#include <headway/io/dataset.h>

namespace headway::io {

/// Two folders of images and a calibration file: anyone's own recording.
///
/// Images (.png .jpg .jpeg .bmp .tif .tiff .pgm .ppm) are paired in the order of their names, of
/// which there must be as many on both sides. Times come from the calibration file: `times`, a file
/// beside it with one time a line [s], or `frame_rate_hz` (10 where neither is there).
///
/// @param calibration  see readRawCalibration()
/// @throws InputError naming what is missing or does not fit
[[nodiscard]] std::unique_ptr<Dataset> openImageFolders(const std::string& left_folder,
                                                        const std::string& right_folder,
                                                        const std::string& calibration);

}  // namespace headway::io
