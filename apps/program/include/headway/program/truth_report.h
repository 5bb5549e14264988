// SPDX-License-Identifier: BSD-3-Clause
// The report of a finished replay with its errors against the truth.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

namespace headway::program {

/// Greatest difference of the times of a true and an estimated pose that are compared: less than
/// half of the interval of frames at 20 Hz [s].
inline constexpr double kSameTime_s = 0.02;

/// Writes `report.html` of a finished replay with true paths and the errors of the final trajectory
/// after rigid alignment.
///
/// @param replay  folder of the replay
/// @param truth   folder with trajectory.tum and optionally objects.csv; empty: none
/// @param output  the page; empty: report.html in the replay's folder
/// @param title   of the page; empty: the name of the replay's folder
/// @param note    called with the reason if there are no errors
/// @throws InputError if the truth is missing or the page cannot be written
void writeTruthReport(const std::filesystem::path& replay, const std::filesystem::path& truth,
                      const std::filesystem::path& output, const std::string& title,
                      const std::function<void(const std::string&)>& note);

}  // namespace headway::program
