// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <headway/core/record_log.h>

#include <cstdlib>
#include <vector>

namespace headway {
namespace {

struct Record {
  int number;
};

std::vector<int> numbersOf(const RecordLog<Record>& log) {
  std::vector<int> numbers;
  log.visit([&](const Record& record) { numbers.push_back(record.number); });
  return numbers;
}

std::vector<int> firstNumbers(int count) {
  std::vector<int> numbers;
  for (int i = 0; i < count; ++i) numbers.push_back(i);
  return numbers;
}

TEST(RecordLogTest, VisitsAllRecordsInOrder) {
  for (const int count : {0, 1, 255, 256, 266, 5000}) {
    RecordLog<Record> log(10);
    for (int i = 0; i < count; ++i) log.append({i});
    EXPECT_EQ(firstNumbers(count), numbersOf(log));
    EXPECT_EQ(count == 0, log.empty());
    EXPECT_EQ(0u, log.dropped());
  }
}

TEST(RecordLogTest, KeepsBoundedNumberInMemory) {
  RecordLog<Record> log(10);
  for (int i = 0; i < 5000; ++i) {
    log.append({i});
    ASSERT_LT(log.recent().size(), 10u + 256u);
    ASSERT_EQ(static_cast<std::size_t>(i + 1), log.filed() + log.recent().size());
    ASSERT_EQ(i, log.back().number);
  }
}

TEST(RecordLogTest, RecentRecordsCanBeChanged) {
  RecordLog<Record> log(10);
  for (int i = 0; i < 300; ++i) log.append({i});
  auto expected = firstNumbers(300);
  for (Record& record : log.recent()) {
    expected[static_cast<std::size_t>(record.number)] = -1;
    record.number = -1;
  }
  EXPECT_EQ(expected, numbersOf(log));
}

TEST(RecordLogTest, ASnapshotStaysAsItWas) {
  for (const int count : {0, 200, 300, 1000}) {
    RecordLog<Record> log(10);
    for (int i = 0; i < count; ++i) log.append({i});
    const auto snapshot = log.snapshot();
    for (Record& record : log.recent()) record.number = -1;
    for (int i = 0; i < 5000; ++i) log.append({-1});
    EXPECT_EQ(firstNumbers(count), numbersOf(*snapshot));
  }
}

TEST(RecordLogTest, DropsAndCountsWhatTheDiskDoesNotTake) {
  const char* before = std::getenv("TMPDIR");
  const std::string old_folder = before != nullptr ? before : "";
  setenv("TMPDIR", "/does/not/exist", 1);
  RecordLog<Record> log(10);
  for (int i = 0; i < 300; ++i) log.append({i});
  before != nullptr ? setenv("TMPDIR", old_folder.c_str(), 1) : unsetenv("TMPDIR");
  EXPECT_EQ(256u, log.dropped());
  EXPECT_EQ(44u, numbersOf(log).size());
  EXPECT_EQ(256, numbersOf(log).front());
}

TEST(StoredPoseTest, KeepsEveryBit) {
  Pose pose = Pose::Identity();
  pose.linear() = expSo3({0.3, -0.2, 0.1});
  pose.translation() << 1.0 / 3.0, -2e7, 1e-9;
  EXPECT_EQ(pose.matrix(), poseFrom(stored(pose)).matrix());
}

}  // namespace
}  // namespace headway
