// SPDX-License-Identifier: BSD-3-Clause
// Files of networks: their download, and their check on a bundled frame.
#pragma once

#include <headway/detect/network_detector.h>

#include <string>

namespace headway::replay {

/// Downloads a network from its authors' release by curl, or from $HEADWAY_MODELS_MIRROR, and
/// installs it in detect::userModels(); prints licence, size and place. A file that is there
/// already is kept.
///
/// @param name  "yolox_nano"
/// @throws UsageError for another name
/// @throws InputError if it cannot be downloaded, its SHA-256 is another, or a different file of
///         its name is there; nothing is installed then
void getModel(const std::string& name, bool quiet);

/// Runs a network on a bundled frame of a simulated street and prints its file, SHA-256, classes,
/// detections and time per frame.
///
/// @param params  of section [dnn]
/// @throws InputError if the model cannot be used, or does not detect both a car and a pedestrian
///         in the frame, which shows several of each
void checkModel(const std::string& file, detect::NetworkParams params);

}  // namespace headway::replay
