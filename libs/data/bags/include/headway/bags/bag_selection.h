// SPDX-License-Identifier: BSD-3-Clause
// Which topics of a bag are imported: wishes, completed by types and names.
#pragma once

#include <headway/bags/bag_reader.h>

#include <string>
#include <vector>

namespace headway::bags {

/// Topics of a bag that are imported; an empty list or name: none.
struct BagSelection {
  std::string left;   ///< stereo camera
  std::string right;  ///< stereo camera
  std::string color;  ///< depth camera
  std::string depth;  ///< depth camera
  std::vector<std::string> imu;
  std::vector<std::string> scans;
  std::string odometry;
  std::string gnss;
  std::vector<std::string> tf;
};

/// What a user says about the topics: names, "none" for no topic, or nothing, to have them guessed.
struct BagWishes {
  std::string left, right, color, depth, imu, odometry, scan, gnss, tf;  ///< lists with commas
};

/// Completes the wishes by the topics' types and names. A stereo camera is preferred to a depth
/// camera, raw images to rectified and compressed ones; all laser scanners are used.
///
/// @throws InputError if a topic does not exist or has another type, or no camera is found; it
///         lists the topics that come into question
[[nodiscard]] BagSelection selectTopics(const std::vector<BagTopic>& topics,
                                        const BagWishes& wishes);

/// What a topic is selected as ("left image", "laser scan", ...); empty if it is not selected.
[[nodiscard]] std::string useOf(const BagTopic& topic, const BagSelection& selection);

/// Topic of the camera_info of an image topic: "/camera/left/camera_info".
[[nodiscard]] std::string cameraInfoTopicOf(const std::string& image_topic);

}  // namespace headway::bags
