#pragma once

#include <headway/core/class_colour.h>

#include <string>

namespace headway::report {

/// Text with the characters that mean something in HTML replaced.
[[nodiscard]] std::string escaped(const std::string& text);

/// A number with so many decimals, "–" if it is not finite.
[[nodiscard]] std::string fixed(double value, int decimals);

/// A whole number with thin spaces between thousands.
[[nodiscard]] std::string grouped(std::size_t value);

/// "#rrggbb".
[[nodiscard]] std::string hex(Colour colour);

/// A section of the page: heading, what stands under it as a lead (may be empty), contents.
[[nodiscard]] std::string section(const std::string& id, const std::string& title,
                                  const std::string& lead, const std::string& contents);

}  // namespace headway::report
