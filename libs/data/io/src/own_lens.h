// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_sink.h>

#include <string>

#include "yaml_file.h"

namespace headway::io {

/// A lens in headway's own calibrations: fx, fy, cx, cy and coefficients of distortion.
///
/// @throws InputError naming file and key if it is missing or impossible
[[nodiscard]] RawCamera ownLens(const YamlFile& file, const std::string& key, cv::Size image_size,
                                bool is_fisheye);

/// The key `lens_model`. @throws InputError for models that are not known
[[nodiscard]] bool isFisheye(const YamlFile& file);

}  // namespace headway::io
