// SPDX-License-Identifier: BSD-3-Clause
#include "trajectory_records.h"

#include <gtest/gtest.h>
#include <headway/core/error.h>
#include <headway_test/folders.h>

#include <fstream>
#include <sstream>

namespace headway::replay {
namespace {

using Kind = slam::TrajectoryRecord::Kind;

slam::TrajectoryRecord recordOf(Kind kind, int number) {
  slam::TrajectoryRecord record;
  record.kind = kind;
  for (std::size_t i = 0; i < 12; ++i) {
    record.pose.values[i] = 1.0 / (3.0 + number + static_cast<double>(i)) * (i % 2 == 0 ? -1 : 1e9);
  }
  if (kind == Kind::kMove) {
    record.keyframe.value = number;
    record.reference.value = number + 1;
  } else {
    record.frame = static_cast<std::size_t>(number);
    record.time = 1.7e9 + number / 3.0;
    record.tracked = number % 2 == 0;
    if (kind == Kind::kFrame) record.reference.value = number - 1;
  }
  return record;
}

class TrajectoryRecordsTest : public testing::Test {
 protected:
  void write(const std::string& text) const { std::ofstream(path_) << text; }

  const test::TemporaryFolder folder_;
  const std::string path_ = folder_ / "records.txt";
};

TEST_F(TrajectoryRecordsTest, RowsGiveTheRecordsBackBitForBit) {
  std::ostringstream rows;
  int number = 0;
  for (const Kind kind : {Kind::kFrame, Kind::kMove, Kind::kGiven, Kind::kFrame}) {
    writeTrajectoryRecord(rows, recordOf(kind, number++));
  }
  write(rows.str() + "torn ro");
  const auto next = readTrajectoryRecords(path_, 4);
  number = 0;
  for (const Kind kind : {Kind::kFrame, Kind::kMove, Kind::kGiven, Kind::kFrame}) {
    const auto expected = recordOf(kind, number++);
    const auto record = next();
    ASSERT_TRUE(record);
    EXPECT_EQ(record->kind, expected.kind);
    EXPECT_EQ(record->frame, expected.frame);
    EXPECT_EQ(record->time, expected.time);
    EXPECT_EQ(record->tracked, expected.tracked);
    EXPECT_EQ(record->keyframe, expected.keyframe);
    EXPECT_EQ(record->reference, expected.reference);
    EXPECT_EQ(record->pose.values, expected.pose.values);
  }
  EXPECT_FALSE(next());
}

TEST_F(TrajectoryRecordsTest, MissingAndDamagedRowsAreErrors) {
  EXPECT_THROW((void)readTrajectoryRecords(folder_ / "nowhere", 1), InputError);
  std::ostringstream row;
  writeTrajectoryRecord(row, recordOf(Kind::kFrame, 5));
  write(row.str());
  const auto next = readTrajectoryRecords(path_, 2);
  EXPECT_TRUE(next());
  EXPECT_THROW((void)next(), InputError);
  const std::string whole = row.str().substr(0, row.str().size() - 1);
  for (const std::string& wrong :
       {whole + " 1", whole + "x", "x" + whole, whole.substr(0, whole.rfind(' ')), std::string()}) {
    write(wrong + "\n");
    EXPECT_THROW((void)readTrajectoryRecords(path_, 1)(), InputError) << wrong;
  }
}

}  // namespace
}  // namespace headway::replay
