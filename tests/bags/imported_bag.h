// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/process.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/serialization/CArchive.h>

#include <memory>
#include <string>
#include <vector>

#include "bag_writers.h"

namespace headway::bags::test {

/// The program on bags in a folder, and the observations that it writes.
class BagTest : public ::testing::Test {
 protected:
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

  /// Output and status of `headway-import rosbag ARGUMENTS`.
  [[nodiscard]] headway::test::ProcessResult import(const std::string& arguments) const {
    return headway::test::runProcess(std::string(HEADWAY_BIN_DIR) + "/headway-import rosbag " +
                                     arguments + " 2>&1");
  }

  /// Observations of one class in x.rawlog, in the order of the file.
  template <typename Observation>
  [[nodiscard]] std::vector<std::shared_ptr<Observation>> observations() const {
    std::vector<std::shared_ptr<Observation>> result;
    for (const auto& one : allObservations()) {
      if (auto found = std::dynamic_pointer_cast<Observation>(one)) result.push_back(found);
    }
    return result;
  }

  [[nodiscard]] std::vector<mrpt::obs::CObservation::Ptr> allObservations() const {
    std::vector<mrpt::obs::CObservation::Ptr> result;
    mrpt::io::CFileGZInputStream file(at("x.rawlog"));
    auto archive = mrpt::serialization::archiveFrom(file);
    while (!file.checkEOF()) {
      try {
        result.push_back(std::dynamic_pointer_cast<mrpt::obs::CObservation>(archive.ReadObject()));
      } catch (const std::exception&) {  // the end
        break;
      }
    }
    return result;
  }

  headway::test::TemporaryFolder folder_;
};

inline bool sameImage(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0.0;
}

}  // namespace headway::bags::test
