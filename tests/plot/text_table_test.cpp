// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/plot/text_table.h>

#include <limits>
#include <sstream>

namespace headway::plot {
namespace {

TEST(TextTableTest, IsMarkdownWithAlignedColumns) {
  std::ostringstream out;
  writeTable(out, {{"name", "value"}, {"a", "1.25"}, {"longer", "—"}});
  EXPECT_EQ(
      "| name   | value |\n"
      "| ------ | ----: |\n"
      "| a      |  1.25 |\n"
      "| longer |     — |\n",
      out.str());
}

TEST(TextTableTest, MissingCellsAreDashes) {
  std::ostringstream out;
  writeTable(out, {{"name", "value"}, {"a"}});
  EXPECT_THAT(out.str(), testing::EndsWith("| a    |     — |\n"));
}

TEST(TextTableTest, ValuesThatAreNotFiniteAreDashes) {
  EXPECT_EQ("1.50", fixedText(1.5, 2));
  EXPECT_EQ("—", fixedText(std::numeric_limits<double>::quiet_NaN(), 2));
}

TEST(TextTableTest, PercentagesAreRatiosTimesHundred) {
  EXPECT_EQ("12.5", percentText(0.125, 1));
  EXPECT_EQ("—", percentText(std::nullopt, 1));
}

}  // namespace
}  // namespace headway::plot
