#pragma once

#include <mrpt/obs/CObservation.h>

#include <optional>
#include <string>

namespace headway::io {

/// Where observations come from, one by one: a file, or sensors.
class ObservationReader {
 public:
  virtual ~ObservationReader() = default;
  /// The next observation; null at the end.
  [[nodiscard]] virtual mrpt::obs::CObservation::Ptr next() = 0;
  /// Why the end came too early, if it did.
  [[nodiscard]] virtual const std::optional<std::string>& truncation() const = 0;
  /// Share read so far, 0 to 1.
  [[nodiscard]] virtual double progress() const = 0;
};

}  // namespace headway::io
