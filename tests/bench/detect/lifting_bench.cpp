// SPDX-License-Identifier: BSD-3-Clause
// How well 2D boxes are lifted to depth by stereo.
//
//     bench_lifting simulated WORLD.rawlog...    perfect 2D boxes, made from the truth
//     bench_lifting kitti DIR                    DIR holds kitti_stereo_2015's image_02, image_03,
//                                                disp_occ_0 and obj_map
//     bench_lifting edges DIR MODEL.onnx         how well a YOLOX network frames the cars of DIR
//
// Simulated: error of the box centre's distance, objects up to 30 m, at least half visible and not
// cut by the image's edge. KITTI: the surface depth under a car's box against the median of the
// true disparities under its mask (nominal calibration).

#include <headway/core/box_overlap.h>
#include <headway/core/error.h>
#include <headway/detect/network_detector.h>
#include <headway/detect/stereo_lifter.h>
#include <headway/io/rawlog_source.h>
#include <headway/io/track_file.h>
#include <headway_test/kitti_stereo.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
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

std::vector<std::string> imagesOf(const fs::path& folder) {
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder / "image_02")) {
    files.push_back(entry.path().filename());
  }
  std::sort(files.begin(), files.end());
  return files;
}

void measurePair(const fs::path& folder, const std::string& file, Errors& errors) {
  const auto pair = headway::test::readKittiStereo(folder, file);
  if (!pair.complete) {
    throw headway::InputError((folder / "image_02" / file).string() +
                              ": it or its companions cannot be read");
  }
  const headway::detect::StereoLifter lifter(pair.frame, {});
  for (const auto& car : pair.cars) {
    const auto surface = lifter.surfaceOf(car.box, ObjectClass::kCar);
    errors["Car"].push_back(surface ? std::abs(car.median_disparity / surface->disparity - 1.0)
                                    : 1.0);
  }
}

// How far a network's boxes are off the boxes around the masks of the cars they overlap, as shares
// of the width.
void measureEdges(const fs::path& folder, const std::string& model) {
  headway::detect::NetworkParams params;
  params.model = model;
  headway::detect::NetworkDetector network(params);
  Errors errors;
  for (const auto& file : imagesOf(folder)) {
    const auto pair = headway::test::readKittiStereo(folder, file);
    const auto found = network.detect(pair.frame);
    for (const auto& item : found.items) {
      for (const auto& [box, disparity] : pair.cars) {
        if (headway::overlap2d(box, *item.box2d) < 0.4) continue;
        const double left = (item.box2d->left - box.left) / box.width();
        const double right = (item.box2d->right - box.right) / box.width();
        errors["edge"].push_back(std::abs(left));
        errors["edge"].push_back(std::abs(right));
        errors["middle"].push_back(std::abs(0.5 * (left + right)));
      }
    }
  }
  print(errors);
}

void measureKitti(const fs::path& folder, Errors& errors) {
  for (const auto& file : imagesOf(folder)) measurePair(folder, file, errors);
}

}  // namespace

int main(int argc, char** argv) {
  const std::string kind = argc > 2 ? argv[1] : "";
  if ((kind != "simulated" && kind != "kitti" && kind != "edges") ||
      (kind == "edges" && argc != 4)) {
    std::fprintf(stderr,
                 "usage: bench_lifting simulated WORLD.rawlog... | kitti DIR | "
                 "edges DIR MODEL.onnx\n");
    return 2;
  }
  Errors errors;
  try {
    if (kind == "edges") {
      measureEdges(argv[2], argv[3]);
      return 0;
    }
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
