// SPDX-License-Identifier: BSD-3-Clause
#include "check_command.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/io/rawlog_source.h>
#include <headway/program/progress.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iomanip>
#include <iostream>

#include "image_check.h"
#include "time_check.h"

namespace headway::import {
namespace {

constexpr int kBadRecording = 1;
constexpr std::size_t kMatchedPairs = 100;

const char* wordOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kOk:
      return "ok";
    case Verdict::kWarning:
      return "warning";
    case Verdict::kBad:
      break;
  }
  return "bad";
}

void print(const CheckItem& item) {
  std::cout << std::left << std::setw(9) << wordOf(item.verdict) << printable(item.name) << ": "
            << printable(item.value) << '\n';
  if (!item.advice.empty()) std::cout << std::string(9, ' ') << printable(item.advice) << '\n';
}

CheckItem rigOf(const io::RawlogSource& source) {
  if (source.camera() == nullptr) {
    return {"rig", "no camera, poses only", Verdict::kWarning, "images are not checked"};
  }
  const auto& camera = *source.camera();
  const auto& position = camera.T_robot_cam.translation();
  const std::string kind = camera.isDepthCamera()
                               ? formatted("depth camera to %.1f m", camera.depth_reach_m)
                               : formatted("baseline %.4f m", camera.baseline_m);
  return {
      "rig",
      formatted("%dx%d px, %s, focal length %.1f px, camera at (%.2f, %.2f, %.2f) m", camera.width,
                camera.height, kind.c_str(), camera.fx, position.x(), position.y(), position.z()),
      Verdict::kOk, ""};
}

/// Counts of what cannot be used.
std::vector<CheckItem> skippedItems(const std::map<std::string, std::size_t>& skipped) {
  std::vector<CheckItem> items;
  for (const auto& [reason, count] : skipped) {
    if (reason == "truth") continue;
    items.push_back({"unused", reason + " " + std::to_string(count), Verdict::kWarning,
                     "doc/formats.md has every reason"});
  }
  return items;
}

void append(std::vector<CheckItem>& items, std::vector<CheckItem> more) {
  for (auto& item : more) items.push_back(std::move(item));
}

/// Items of the images; one that is bad if they cannot be read.
std::vector<CheckItem> imageItems(const std::string& path, const std::string& sensor_label,
                                  const TimeCheck& times) {
  std::vector<CheckItem> items;
  try {
    io::RawlogSourceOptions options;
    options.sensor_label = sensor_label;
    options.use_laser = true;
    io::RawlogSource source(path, options);
    items.push_back(rigOf(source));
    ImageCheck images(std::max<std::size_t>(1, times.images() / kMatchedPairs));
    std::size_t frames = 0;
    while (!program::interrupted()) {
      const auto frame = source.next();
      if (!frame) break;
      if (frame->stereo) images.add(*frame->stereo);
      frames += frame->stereo ? 1 : 0;
    }
    if (frames > 0) {
      append(items, images.items());
      append(items, images.clockItems(times.turns()));
    }
    append(items, skippedItems(source.skipped()));
  } catch (const InputError& error) {
    items.push_back({"images", "cannot be used", Verdict::kBad, error.what()});
  }
  return items;
}

}  // namespace

ImportOutput::ImportOutput(std::string path, bool check) : path_(std::move(path)) {
  if (!path_.empty()) return;
  if (!check) throw program::UsageError("give -o OUT.rawlog, or --check");
  std::string folder = (std::filesystem::temp_directory_path() / "headway-import-XXXXXX").string();
  if (mkdtemp(folder.data()) == nullptr) {
    throw InputError(folder + ": no temporary folder can be made; set TMPDIR");
  }
  folder_ = folder;
  path_ = folder_ + "/checked.rawlog";
}

ImportOutput::~ImportOutput() {
  std::error_code ignored;
  if (!folder_.empty()) std::filesystem::remove_all(folder_, ignored);
}

void addCheck(program::CommandLine& line, bool& check) {
  line.flag(check, 0, "check",
            "Check the recording: rates, gaps, time offsets, exposure, blur, vertical offset, "
            "clocks; exit status 1 if something is bad; without -o nothing is kept");
}

int checkRawlog(const std::string& path, const std::string& sensor_label) {
  TimeCheck times(sensor_label);
  std::map<std::string, std::size_t> skipped;
  const auto truncation = io::visitObservations(
      path, skipped,
      [&times](const mrpt::obs::CObservation& observation) { times.add(observation); });
  std::vector<CheckItem> items = times.items();
  if (truncation) {
    items.push_back({"file", "truncated", Verdict::kBad, *truncation + "; record it again"});
  }
  if (!program::interrupted()) append(items, imageItems(path, sensor_label, times));
  if (program::interrupted()) {
    std::cout << "interrupted: not checked" << std::endl;
    return kBadRecording;
  }
  for (const auto& item : items) print(item);
  const auto count = [&](Verdict verdict) {
    return std::count_if(items.begin(), items.end(),
                         [verdict](const CheckItem& item) { return item.verdict == verdict; });
  };
  std::cout << "verdict: " << count(Verdict::kBad) << " bad, " << count(Verdict::kWarning)
            << " warnings, " << count(Verdict::kOk) << " ok" << std::endl;
  return count(Verdict::kBad) > 0 ? kBadRecording : program::kDone;
}

int runRawlog(int argc, const char** argv) {
  (void)takeSubcommand(argc, argv);
  std::string path, sensor_label;
  bool check = false;
  program::CommandLine line("headway-import rawlog", "Checks a rawlog.");
  line.positional(path, "FILE", "Rawlog");
  line.option(sensor_label, 0, "sensor-label", "LABEL",
              "Stereo camera to use if the rawlog contains several");
  addCheck(line, check);
  if (!line.parse(argc, argv)) return program::kDone;
  if (!check) throw program::UsageError("a rawlog needs no import; --check checks it");
  program::catchInterrupts();
  return checkRawlog(path, sensor_label);
}

}  // namespace headway::import
