// SPDX-License-Identifier: BSD-3-Clause
// Files of networks: their download, and their check on a bundled frame.
#include "model_files.h"

#include <headway/core/error.h>
#include <headway/core/text.h>
#include <headway/program/command_line.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "check_frame.h"

namespace headway::replay {
namespace {

namespace fs = std::filesystem;

constexpr int kTimedRuns = 5;

StereoFrame bundledFrame() {
  const std::vector<unsigned char> bytes(std::begin(kCheckFrame), std::end(kCheckFrame));
  auto camera = std::make_shared<StereoCamera>();
  StereoFrame frame;
  frame.left_colour = cv::imdecode(bytes, cv::IMREAD_COLOR);
  cv::cvtColor(frame.left_colour, frame.left, cv::COLOR_BGR2GRAY);
  camera->width = frame.left.cols;
  camera->height = frame.left.rows;
  frame.camera = camera;
  return frame;
}

double bestTime(detect::Detector& detector, const StereoFrame& frame) {
  double best_ms = 1e9;
  for (int run = 0; run < kTimedRuns; ++run) {
    const auto start = std::chrono::steady_clock::now();
    (void)detector.detect(frame);
    const std::chrono::duration<double, std::milli> elapsed =
        std::chrono::steady_clock::now() - start;
    best_ms = std::min(best_ms, elapsed.count());
  }
  return best_ms;
}

/// A network that its authors publish.
struct PublishedModel {
  const char* name;
  const char* file;
  const char* release;  ///< where its file is
  const char* licence;
  long bytes;
  const char* sha256;  ///< as doc/detectors.md states it
};

const PublishedModel kModels[] = {
    {"yolox_nano", "yolox_nano.onnx",
     "https://github.com/Megvii-BaseDetection/YOLOX/releases/download/0.1.1rc0", "Apache-2.0",
     3660092, "695e750a5d5754bb5a8d5325643b59282191a7e7a564e435a415fd3c578eab14"}};

const PublishedModel& modelNamed(const std::string& name) {
  for (const auto& model : kModels) {
    if (name == model.name) return model;
  }
  throw program::UsageError("--get-model: '" + printable(name) + "' is not yolox_nano");
}

/// Why curl failed, by its exit status.
std::string reasonOf(int curl_status) {
  switch (curl_status) {
    case 6:
      return "the host is not known";
    case 7:
      return "no connection";
    case 22:
      return "the server does not have it";
    case 28:
      return "the server does not answer";
    case 63:
      return "it is larger than the model";
    default:
      return "curl ended with status " + std::to_string(curl_status);
  }
}

/// Runs curl. @return its exit status
int runCurl(const std::vector<std::string>& options) {
  std::vector<char*> words;
  std::string name = "curl";
  words.push_back(name.data());
  for (const auto& option : options) words.push_back(const_cast<char*>(option.c_str()));
  words.push_back(nullptr);
  pid_t child = 0;
  if (posix_spawnp(&child, "curl", nullptr, nullptr, words.data(), environ) != 0) {
    throw InputError("curl: cannot be run; install the package curl");
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Removes a file that is not complete, whatever happens.
class PartialFile {
 public:
  explicit PartialFile(fs::path path) : path_(std::move(path)) {}
  ~PartialFile() {
    std::error_code ignored;
    fs::remove(path_, ignored);
  }
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void getModel(const std::string& name, bool quiet) {
  const PublishedModel& model = modelNamed(name);
  const fs::path folder = detect::userModels();
  if (folder.empty()) throw InputError("--get-model: neither XDG_DATA_HOME nor HOME is set");
  const fs::path file = folder / model.file;
  const char* mirror = std::getenv("HEADWAY_MODELS_MIRROR");
  const bool has_mirror = mirror != nullptr && *mirror != '\0';
  const std::string url = std::string(has_mirror ? mirror : model.release) + "/" + model.file;
  if (!quiet) {
    std::printf("%s: licence %s, %.1f MB, from %s\n", model.name, model.licence,
                1e-6 * static_cast<double>(model.bytes), printable(url).c_str());
    std::fflush(stdout);
  }
  if (fs::exists(file)) {
    if (detect::sha256OfFile(file.string()) != model.sha256) {
      throw InputError(file.string() + ": is there already and is another file; remove it first");
    }
    if (!quiet) std::printf("%s: is there already\n", printable(file.string()).c_str());
    return;
  }
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (failed) throw InputError(folder.string() + ": cannot be made: " + failed.message());
  const PartialFile part(folder / (std::string(model.file) + "." + std::to_string(getpid())));
  const int status = runCurl({"--disable", "--fail", "--location", "--silent", "--proto",
                              has_mirror ? "=http,https" : "=https", "--max-filesize",
                              std::to_string(model.bytes), "--connect-timeout", "20", "--max-time",
                              "600", "--output", part.path().string(), "--url", url});
  if (status != 0) {
    throw InputError(url + ": cannot be downloaded: " + reasonOf(status) +
                     "; offline, copy the file to " + folder.string());
  }
  const std::string hash = detect::sha256OfFile(part.path().string());
  if (hash != model.sha256) {
    throw InputError(url + ": its SHA-256 is " + hash + " instead of " + model.sha256 +
                     "; nothing was installed");
  }
  fs::rename(part.path(), file, failed);
  if (failed) throw InputError(file.string() + ": cannot be written: " + failed.message());
  if (!quiet) std::printf("installed: %s\n", printable(file.string()).c_str());
}

void checkModel(const std::string& file, detect::NetworkParams params) {
  params.model = file;
  detect::NetworkDetector detector(params);
  const auto frame = bundledFrame();
  const auto found = detector.detect(frame);
  const auto shown = printable(detector.model());
  std::printf("model: %s\nSHA-256: %s\nclasses: %s\n", shown.c_str(),
              detect::sha256OfFile(detector.model()).c_str(), printable(params.classes).c_str());
  std::printf("frame: %d x %d px, in %.0f ms (best of %d)\n", frame.left.cols, frame.left.rows,
              bestTime(detector, frame), kTimedRuns);
  std::map<ObjectClass, int> counts;
  for (const auto& item : found.items) {
    ++counts[item.object_class];
    std::printf("%-12s score %.2f  %4.0f,%4.0f to %4.0f,%4.0f px\n",
                std::string(toString(item.object_class)).c_str(), item.score, item.box2d->left,
                item.box2d->top, item.box2d->right, item.box2d->bottom);
  }
  if (counts[ObjectClass::kCar] == 0 || counts[ObjectClass::kPedestrian] == 0) {
    throw InputError(shown + ": detects " + std::to_string(counts[ObjectClass::kCar]) +
                     " cars and " + std::to_string(counts[ObjectClass::kPedestrian]) +
                     " pedestrians in a frame that shows several of each; check [dnn] scale, "
                     "swap_red_blue, letterbox and classes");
  }
}

}  // namespace headway::replay
