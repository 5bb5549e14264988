#include "text_table.h"

#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::report {
namespace {

class TextTableTest : public ::testing::Test {
 protected:
  std::string fileWith(const std::string& text) {
    const auto path = folder_ / "file.txt";
    std::ofstream(path) << text;
    return path;
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(TextTableTest, FindsColumnsByName) {
  const TextTable table(fileWith("a,b\n1,x\n\n2.5,y\n"));
  ASSERT_EQ(table.size(), 2u);
  EXPECT_EQ(table.number(1, "a"), 2.5);
  EXPECT_EQ(table.text(0, "b"), "x");
}

TEST_F(TextTableTest, SaysWhatIsWrong) {
  EXPECT_THROW(TextTable("/nonexistent.csv"), InputError);
  EXPECT_THROW(TextTable(fileWith("a,b\n1\n")), InputError);
  const TextTable table(fileWith("a,b\n1,x\n"));
  EXPECT_THROW((void)table.number(0, "b"), InputError);
  EXPECT_THROW((void)table.text(0, "c"), InputError);
}

TEST_F(TextTableTest, ReadsPathsAndLeavesCommentsOut) {
  const auto path = readPath(fileWith("# t x y z\n1.5 2 -3 4 0 0 0 1\n"));
  ASSERT_EQ(path.size(), 1u);
  EXPECT_EQ(path[0].time, 1.5);
  EXPECT_EQ(path[0].y, -3.0);
  EXPECT_THROW((void)readPath(fileWith("1.5 rubbish\n")), InputError);
  EXPECT_THROW((void)readPath("/nonexistent.tum"), InputError);
}

}  // namespace
}  // namespace headway::report
