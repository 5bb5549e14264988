#pragma once

#include <headway/report/report.h>

#include <string>

#include "replay_folder.h"

namespace headway::report {

// The parts of the page that are text and tables; empty where there is nothing to say.

/// Title, what was replayed, and a warning where the replay ended early or lost frames.
[[nodiscard]] std::string titleBlock(const ReplayFolder& folder);
/// The figures that matter, as tiles.
[[nodiscard]] std::string summaryTiles(const ReplayFolder& folder);
[[nodiscard]] std::string errorsSection(const std::vector<Figure>& errors);
[[nodiscard]] std::string snapshotsSection(const ReplayFolder& folder, std::size_t most);
[[nodiscard]] std::string calibrationSection(const ReplayFolder& folder);
[[nodiscard]] std::string droppedSection(const ReplayFolder& folder);
[[nodiscard]] std::string configurationSection(const ReplayFolder& folder);
/// Colours of the classes that occur.
[[nodiscard]] std::string classLegend(const ReplayFolder& folder, bool with_truth);

}  // namespace headway::report
