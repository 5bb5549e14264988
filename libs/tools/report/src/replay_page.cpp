// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/core/output_file.h>
#include <headway/io/rawlog_source.h>
#include <headway/report/replay_page.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "html.h"
#include "page_data.h"
#include "page_files.h"

namespace headway::report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxShownFrames = 2000;
constexpr std::size_t kMaxDensePoints = 600000;
constexpr std::size_t kMaxShownLandmarks = 60000;

/// The source expression of Content-Security-Policy for an inline script or style.
std::string hashSource(const std::string& text) {
  std::vector<std::uint8_t> hash(EVP_MAX_MD_SIZE);
  unsigned size = 0;
  if (EVP_Digest(text.data(), text.size(), hash.data(), &size, EVP_sha256(), nullptr) != 1) {
    throw InputError("the SHA-256 of the page's script cannot be computed");
  }
  hash.resize(size);
  return "'sha256-" + base64(hash) + "'";
}

std::string policy(const std::vector<std::string>& scripts, const std::string& style) {
  std::string text =
      "default-src 'none'; img-src data:; style-src " + hashSource(style) + "; script-src";
  for (const auto& script : scripts) text += " " + hashSource(script);
  return text + "; base-uri 'none'; form-action 'none'";
}

/// JSON that cannot end the element around it.
std::string inlineJson(const nlohmann::ordered_json& json) {
  const std::string plain = json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  std::string text;
  std::size_t start = 0;
  for (auto at = plain.find('<'); at != std::string::npos; at = plain.find('<', start)) {
    text.append(plain, start, at - start).append("\\u003c");
    start = at + 1;
  }
  return text.append(plain, start, std::string::npos);
}

/// A data block, which browsers do not execute.
std::string block(const std::string& id, const std::string& type, const std::string& text) {
  return "<script type=\"" + type + "\" id=\"" + id + "\">" + text + "</script>\n";
}

nlohmann::ordered_json boundsJson(const PackedPoints& points) {
  return {{"count", points.count},
          {"spacing", points.spacing},
          {"origin", {points.origin.x(), points.origin.y(), points.origin.z()}},
          {"step", {points.step.x(), points.step.y(), points.step.z()}}};
}

/// Adds the points of a file to the data, and returns the block with their bytes.
std::string pointsBlock(const fs::path& path, std::size_t max_points, const std::string& id,
                        nlohmann::ordered_json& data) {
  data[id] = nullptr;
  if (!fs::exists(path)) return "";
  const PackedPoints points = packed(readPoints(path, max_points));
  data[id] = boundsJson(points);
  return block(id, "text/plain", base64(points.bytes));
}

std::string imagesBlock(const JpegByFrame& images) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [frame, jpeg] : images) list.push_back({frame, base64(jpeg)});
  return block("images", "application/json", inlineJson(list));
}

/// Name of the recording, or else of the folder.
std::string nameOf(const fs::path& folder) {
  const std::string rawlog = readReplayInput(folder).rawlog;
  if (!rawlog.empty()) return fs::path(io::rawlogStem(rawlog)).filename().string();
  return fs::weakly_canonical(folder).filename().string();
}

/// Whether the run was killed, interrupted or stopped by an error.
bool endedEarly(const fs::path& folder) {
  std::ifstream file(folder / "summary.json");
  const auto summary = nlohmann::json::parse(file, nullptr, false);
  const auto reason = summary.is_object() ? summary.find("ended_early") : summary.end();
  return reason != summary.end() && reason->is_string();
}

std::string readReplayPage(const fs::path& folder, const ReplayPageOptions& options,
                           const Note& note) {
  ReplayFrameOptions reading;
  reading.max_frames = kMaxShownFrames;
  reading.past_s = 0.0;
  reading.horizon_step_s = 0.5;
  const auto frames = readReplayFrames(folder, reading, note);
  ReplayTruth truth;
  if (!options.truth.empty()) truth = readReplayTruth(options.truth, frames, note);
  auto data = pageData(folder, frames, truth, options.keyframes);
  std::string title = options.title.empty() ? nameOf(folder) : options.title;
  if (endedEarly(folder)) title += " (ended early)";
  data["title"] = title;
  const std::string points =
      pointsBlock(folder / "map_dense.ply", kMaxDensePoints, "dense", data) +
      pointsBlock(folder / "map_points.ply", kMaxShownLandmarks, "landmarks", data);
  const std::string three(kThreeScript), script = pageScript(), style(kPageStyle);
  return "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
         "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
         policy({three, script}, style) +
         "\"><meta name=\"viewport\" content=\"width=device-width,initial-scale=1\"><title>" +
         escaped(title) + " – headway replay</title><style>" + style + "</style></head><body>\n" +
         kPageBody + block("data", "application/json", inlineJson(data)) +
         imagesBlock(options.images) + points + "<!-- three.js r" + kThreeRevision +
         ", MIT licence, Copyright 2010-2019 three.js authors -->\n<script>" + three +
         "</script>\n<script>" + script + "</script>\n</body></html>\n";
}

}  // namespace

fs::path writeReplayPage(const fs::path& folder, const ReplayPageOptions& options,
                         const Note& note) {
  const fs::path path = options.output.empty() ? folder / "replay.html" : options.output;
  try {
    writeFile(path, readReplayPage(folder, options, note));
  } catch (const nlohmann::json::exception& error) {
    throw InputError((folder / "replay.json").string() +
                     ": an entry is not what a replay writes: " + error.what());
  }
  return path;
}

}  // namespace headway::report
