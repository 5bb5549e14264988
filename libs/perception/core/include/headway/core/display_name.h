// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/object_class.h>

#include <string_view>

namespace headway {

/// Name of a class for people, in pictures and pages: "Car", "Sitting person".
[[nodiscard]] std::string_view displayName(ObjectClass object_class);

}  // namespace headway
