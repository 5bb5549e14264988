// SPDX-License-Identifier: BSD-3-Clause
#include "network_classes.h"

#include <headway/core/box_overlap.h>

#include <algorithm>
#include <sstream>

namespace headway::detect {
namespace {

constexpr double kRiderOnBicycle = 0.3;  // ratio of a bicycle's box inside its rider's
constexpr double kSameVehicle = 0.6;     // overlap of the boxes of one vehicle of two classes
constexpr std::size_t kCocoClasses = 80;

std::vector<NetworkClass> cocoClasses() {
  std::vector<NetworkClass> classes(kCocoClasses);
  classes[0].object_class = ObjectClass::kPedestrian;  // person
  classes[1].bicycle = true;                           // bicycle
  classes[2].object_class = ObjectClass::kCar;         // car
  classes[3].bicycle = true;                           // motorcycle: its rider moves alike
  classes[5].object_class = ObjectClass::kTruck;       // bus
  classes[6].object_class = ObjectClass::kTram;        // train
  classes[7].object_class = ObjectClass::kTruck;       // truck
  return classes;
}

Box2d around(const Box2d& a, const Box2d& b) {
  return {std::min(a.left, b.left), std::min(a.top, b.top), std::max(a.right, b.right),
          std::max(a.bottom, b.bottom)};
}

// Networks trained on COCO report a van as car and as truck.
bool isSameVehicle(const Detection& a, const Detection& b) {
  return isVehicle(a.object_class) && isVehicle(b.object_class) &&
         overlap2d(*a.box2d, *b.box2d) > kSameVehicle;
}

// A rider's box reaches into the upper part of the bicycle's.
bool rides(const Box2d& person, const Box2d& bicycle) {
  return ratioInside(bicycle, person) > kRiderOnBicycle &&
         person.bottom > bicycle.top + 0.2 * bicycle.height() && person.top < bicycle.top;
}

}  // namespace

std::vector<NetworkClass> networkClasses(const std::string& names) {
  if (names == "coco") return cocoClasses();
  std::vector<NetworkClass> classes;
  std::istringstream list(names);
  for (std::string name; std::getline(list, name, ',');) {
    const auto first = name.find_first_not_of(' ');
    const auto last = name.find_last_not_of(' ');
    if (first == std::string::npos) name.clear();
    if (!name.empty()) name = name.substr(first, last - first + 1);
    NetworkClass one;
    one.object_class = objectClassFrom(name);
    classes.push_back(one);
  }
  return classes;
}

std::vector<Detection> toDetections(const std::vector<NetworkBox>& boxes,
                                    const std::vector<NetworkClass>& classes) {
  std::vector<Detection> detections;
  for (const auto& box : boxes) {
    const NetworkClass& network_class = classes.at(box.network_class);
    if (!network_class.object_class) continue;
    Detection detection;
    detection.object_class = *network_class.object_class;
    detection.score = box.score;
    detection.box2d = box.box;
    const bool known = std::any_of(detections.begin(), detections.end(),
                                   [&](const auto& d) { return isSameVehicle(d, detection); });
    if (!known) detections.push_back(detection);
  }
  for (const auto& box : boxes) {
    if (!classes.at(box.network_class).bicycle) continue;
    for (auto& detection : detections) {
      if (detection.object_class != ObjectClass::kPedestrian) continue;
      if (!rides(*detection.box2d, box.box)) continue;
      detection.object_class = ObjectClass::kCyclist;
      detection.box2d = around(*detection.box2d, box.box);
      break;
    }
  }
  return detections;
}

}  // namespace headway::detect
