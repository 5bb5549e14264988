#pragma once

#include <headway/eval/labelled_frames.h>

#include <map>
#include <string>
#include <vector>

namespace headway::app {

/// Two files that are about the same recording.
struct FilePair {
  std::string name;  ///< of the recording: the file's name without its ending
  std::string truth;
  std::string estimate;
};

struct PairedFiles {
  std::vector<FilePair> pairs;           ///< ascending names
  std::vector<std::string> truth_alone;  ///< names without an estimate
};

/// Pairs two files, or the files of two folders by their names without endings.
///
/// @throws InputError if one is a file and the other a folder, a file of the estimates' folder has
///         no partner, or nothing pairs
[[nodiscard]] PairedFiles pairedFiles(const std::string& truth, const std::string& estimate);

/// The file of a folder with that name, whatever its ending; a path that is a file is that file.
///
/// @throws InputError if there is none
[[nodiscard]] std::string fileNamed(const std::string& name, const std::string& path);

/// Reads KITTI tracking labels by frame; DontCare rows become regions.
///
/// @throws InputError naming the file if it is empty or holds numbers that are not finite
[[nodiscard]] std::vector<eval::LabelledFrame> readLabels(const std::string& path);

/// Reads tracking results (or detections: each box without an id is a track of its own) and adds
/// them to their frames.
///
/// @param dropped  counts rows left out, by reason
/// @throws InputError naming file and frame if an id stands twice in a frame, or a number is not
///         finite
void addEstimates(const std::string& path, std::vector<eval::LabelledFrame>& frames,
                  std::map<std::string, std::size_t>& dropped);

/// Reads what a detector said, from files as above, a rawlog's `detections`, or a folder that
/// holds them: by name, or by name in one folder for each class. Every box is a track of its own.
///
/// @throws InputError naming what cannot be read
[[nodiscard]] std::vector<eval::LabelledFrame> readRaw(const std::string& name,
                                                       const std::string& path);

}  // namespace headway::app
