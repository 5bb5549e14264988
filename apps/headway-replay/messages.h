// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/io/rawlog_source.h>

#include <exception>
#include <optional>
#include <string>

namespace headway::replay {

/// Prints the calibration's consistency with the images to standard output.
void printCalibration(const io::CalibrationReport& report);

/// Why no frame of a recording was tracked, as far as the first pair shows it.
[[nodiscard]] std::string causeOfNoTracking(
    const std::optional<io::CalibrationReport>& calibration);

/// The message of an exception that is in flight.
[[nodiscard]] std::string textOf(const std::exception_ptr& failure);

}  // namespace headway::replay
