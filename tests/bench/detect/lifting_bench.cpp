// How well 2D boxes are lifted to depth by stereo.
//
//     bench_lifting simulated WORLD.rawlog...    perfect 2D boxes, made from the truth
//     bench_lifting kitti DIR                    DIR holds kitti_stereo_2015's image_02, image_03,
//                                                disp_occ_0 and obj_map
//
// Simulated: error of the box centre's distance, objects up to 30 m, at least half visible and not
// cut by the image's edge. KITTI: the surface depth under a car's box against the median of the
// true disparities under its mask (nominal calibration).

#include <headway/core/error.h>
#include <headway/detect/stereo_lifter.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;
using headway::Box2d;
using headway::ObjectClass;

/// Relative errors by kind of object; an object without an estimate is an error of 1.
using Errors = std::map<std::string, std::vector<double>>;

void print(Errors errors) {
  for (auto& [kind, values] : errors) {
    std::sort(values.begin(), values.end());
    const auto at = [&values = values](double share) {
      return 100.0 * values[static_cast<std::size_t>(share * static_cast<double>(values.size()))];
    };
    std::printf("%-12s %5zu boxes, error: median %.1f %%, 90 %% below %.1f %%\n", kind.c_str(),
                values.size(), at(0.5), at(0.9));
  }
}

bool isWhole(const Box2d& box, const headway::StereoCamera& camera) {
  return box.left > 1 && box.top > 1 && box.right < camera.width - 2 &&
         box.bottom < camera.height - 2;
}

void measureWorld(const std::string& rawlog, Errors& errors) {
  std::map<std::size_t, std::vector<headway::io::KittiRow>> truth;
  const auto labels = fs::path(rawlog).replace_extension(".truth") / "label_02.txt";
  for (const auto& row : headway::io::readKittiRows(labels)) truth[row.frame].push_back(row);
  headway::io::RawlogSource source(rawlog, {});
  while (const auto frame = source.next()) {
    if (!frame->stereo || frame->index % 5 != 0) continue;
    const headway::detect::StereoLifter lifter(*frame->stereo, {});
    for (const auto& row : truth[frame->index]) {
      const auto object = headway::io::detectionFrom(row);
      if (!object || row.visible < 0.5 || !isWhole(*object->box2d, *source.camera())) continue;
      const double range = object->box3d->centre.z();
      if (range < 4.0 || range > 30.0) continue;
      const auto lifted = lifter.lift(*object->box2d, object->object_class);
      const double error = lifted ? std::abs(lifted->box.centre.z() / range - 1.0) : 1.0;
      errors["all"].push_back(error);
      errors[row.type].push_back(error);
    }
  }
}

void measurePair(const fs::path& folder, const std::string& file, Errors& errors) {
  const auto path = [&](const char* kind) { return (folder / kind / file).string(); };
  headway::StereoFrame frame;
  frame.left = cv::imread(path("image_02"), cv::IMREAD_GRAYSCALE);
  frame.right = cv::imread(path("image_03"), cv::IMREAD_GRAYSCALE);
  const cv::Mat truth = cv::imread(path("disp_occ_0"), cv::IMREAD_UNCHANGED);
  const cv::Mat masks = cv::imread(path("obj_map"), cv::IMREAD_UNCHANGED);
  if (frame.left.empty() || frame.right.empty() || truth.empty() || masks.empty()) {
    throw headway::InputError(path("image_02") + ": it or its companions cannot be read");
  }
  auto camera = std::make_shared<headway::StereoCamera>();
  camera->width = frame.left.cols;
  camera->height = frame.left.rows;
  camera->fx = camera->fy = 721.5;
  camera->cx = 609.6;
  camera->cy = 172.9;
  camera->baseline_m = 0.54;
  frame.camera = camera;
  const headway::detect::StereoLifter lifter(frame, {});
  for (int id = 1; id < 255; ++id) {
    const cv::Mat mask = masks == id;
    std::vector<double> disparities;
    for (int row = 0; row < truth.rows; ++row) {
      for (int column = 0; column < truth.cols; ++column) {
        const double d = truth.at<std::uint16_t>(row, column) / 256.0;
        if (mask.at<unsigned char>(row, column) != 0 && d > 0.0) disparities.push_back(d);
      }
    }
    if (disparities.size() < 30) continue;
    std::sort(disparities.begin(), disparities.end());
    const cv::Rect rect = cv::boundingRect(mask);
    const auto surface = lifter.surfaceOf(
        {rect.x + 0.0, rect.y + 0.0, rect.br().x - 1.0, rect.br().y - 1.0}, ObjectClass::kCar);
    const double median = disparities[disparities.size() / 2];
    errors["Car"].push_back(surface ? std::abs(median / surface->disparity - 1.0) : 1.0);
  }
}

void measureKitti(const fs::path& folder, Errors& errors) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder / "image_02")) {
    files.push_back(entry.path().filename());
  }
  std::sort(files.begin(), files.end());
  for (const auto& file : files) measurePair(folder, file, errors);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[1] : "";
  if (kind != "simulated" && kind != "kitti") {
    std::fprintf(stderr, "usage: bench_lifting simulated WORLD.rawlog... | kitti DIR\n");
    return 2;
  }
  Errors errors;
  try {
    for (int i = 2; i < argc; ++i) {
      kind == "kitti" ? measureKitti(argv[i], errors) : measureWorld(argv[i], errors);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_lifting: %s\n", error.what());
    return 1;
  }
  print(errors);
  return 0;
}
