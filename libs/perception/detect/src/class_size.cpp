// SPDX-License-Identifier: BSD-3-Clause
#include <headway/detect/class_size.h>

namespace headway::detect {

std::optional<ClassSize> classSize(ObjectClass object_class) {
  switch (object_class) {
    case ObjectClass::kCar:
      return ClassSize{{4.0, 1.65, 1.52}, 0.09};
    case ObjectClass::kVan:
      return ClassSize{{5.1, 1.9, 2.2}, 0.14};
    case ObjectClass::kTruck:
      return ClassSize{{9.5, 2.55, 3.2}, 0.15};
    case ObjectClass::kPedestrian:
      return ClassSize{{0.7, 0.6, 1.74}, 0.07};
    case ObjectClass::kPersonSitting:
      return ClassSize{{0.8, 0.6, 1.27}, 0.1};
    case ObjectClass::kCyclist:
      return ClassSize{{1.75, 0.6, 1.73}, 0.07};
    case ObjectClass::kTram:
      return ClassSize{{16.0, 2.5, 3.5}, 0.15};
    case ObjectClass::kUnknown:
    case ObjectClass::kMisc:
      break;
  }
  return std::nullopt;
}

}  // namespace headway::detect
