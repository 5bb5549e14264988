// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/eval/labelled_frames.h>

#include <map>
#include <string>
#include <vector>

namespace headway::eval_files {

/// Truth and estimate of the same recording.
struct FilePair {
  std::string name;  ///< of the recording: the file name without extension
  std::string truth;
  std::string estimate;
};

/// Recordings with truth and estimate, and those without an estimate.
struct PairedFiles {
  std::vector<FilePair> pairs;           ///< ascending names
  std::vector<std::string> truth_alone;  ///< recordings without an estimate
};

/// Pairs two files, or the files of two folders by their names without extensions.
///
/// @throws InputError if one is a file and the other a folder, an estimate has no truth of its
/// name,
///         or there are no files
[[nodiscard]] PairedFiles pairedFiles(const std::string& truth, const std::string& estimate);

/// The file of that name in a folder, with any extension; `path` itself if it is a file.
///
/// @throws InputError if there is no such file
[[nodiscard]] std::string fileNamed(const std::string& name, const std::string& path);

/// Requires that both files are in the map (objects.csv, tracks.csv) or both in the camera (KITTI).
///
/// @throws InputError naming both files
void requireSameFrame(const std::string& truth, const std::string& estimate);

/// Reads KITTI tracking labels by frame, whose DontCare rows become regions, or an objects.csv.
///
/// @throws InputError naming the file if it is empty or contains numbers that are not finite
[[nodiscard]] std::vector<eval::LabelledFrame> readLabels(const std::string& path);

/// Reads tracking results, a tracks.csv (which has no scores), or detections (each box without an
/// id becomes a separate track), and adds them to their frames.
///
/// @param dropped  number of rows ignored, by reason
/// @throws InputError naming file and frame if an id occurs twice in a frame, or a number is not
///         finite
void addEstimates(const std::string& path, std::vector<eval::LabelledFrame>& frames,
                  std::map<std::string, std::size_t>& dropped);

/// Reads detections from files as above, from a rawlog's `detections`, or from a folder with such
/// files, directly or in one subfolder per class. Every box becomes a separate track.
///
/// @throws InputError naming the file that cannot be read
[[nodiscard]] std::vector<eval::LabelledFrame> readRaw(const std::string& name,
                                                       const std::string& path);

}  // namespace headway::eval_files
