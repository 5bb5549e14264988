// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/detect/network_detector.h>

#include <string>

namespace headway::replay {

/// Runs a network on a bundled frame of a simulated street and prints its file, SHA-256, classes,
/// detections and time per frame.
///
/// @param file    of the model; empty: does nothing
/// @param params  of section [dnn]
/// @return        whether a model was checked
/// @throws InputError if the model cannot be used, or does not detect both a car and a pedestrian
///         in the frame, which shows several of each
bool checkModel(const std::string& file, detect::NetworkParams params);

}  // namespace headway::replay
