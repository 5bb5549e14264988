#pragma once

#include <string>

namespace headway::eval {

/// Step of 1, 2 or 5 times a power of ten that cuts `range` into about `parts`, no more.
[[nodiscard]] double tickStep(double range, double parts);

/// A tick's value with the digits after the point that its step needs.
[[nodiscard]] std::string tickText(double value, double step);

}  // namespace headway::eval
