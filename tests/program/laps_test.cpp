// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway_test/folders.h>
#include <headway_test/repeats.h>

#include "../bench/live/lap_replay.h"

namespace headway {
namespace {

TEST(LapsTest, MemoryStaysFlatAfterTheThirdLap) {
  constexpr double kGrowthMb = 5.5;  // 0.2 a lap
  constexpr std::size_t kFrames = test::repeats(3000, 300);
  const test::TemporaryFolder folder;
  std::vector<bench::LapFigures> laps;
  bench::replayLaps(kFrames, 1, folder / "run",
                    [&](const bench::LapFigures& lap) { laps.push_back(lap); });
  ASSERT_EQ(kFrames / bench::LapInput::kLap, laps.size());
  for (std::size_t i = 3; i < laps.size() && !test::kSanitized; ++i) {  // ASan keeps what is freed
    EXPECT_LT(laps[i].resident_mb, laps[2].resident_mb + kGrowthMb) << "lap " << i + 1;
  }
  EXPECT_GE(laps.back().tracks, laps.size()) << "each lap has a track of its own";

  std::ifstream trajectory(folder / "run/trajectory.tum");
  std::size_t rows = 0;
  for (std::string row; std::getline(trajectory, row);) ++rows;
  EXPECT_EQ(kFrames, rows) << "those in the file too";
}

}  // namespace
}  // namespace headway
