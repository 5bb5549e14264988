// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>

#include "upright_segments.h"

namespace headway::detect {
namespace {

constexpr double kCell = 0.05;  // at the depth of what is seen [m]

/// Cells of people who walk abreast: trunks that touch, each with a head above.
struct Seen {
  std::vector<cv::Point> cells;
  std::vector<double> heights;

  void add(int left, int width, double from, double to) {
    for (int column = left; column < left + width; ++column) {
      for (double height = from; height < to; height += kCell) {
        cells.emplace_back(column, static_cast<int>((3.0 - height) / kCell));
        heights.push_back(height);
      }
    }
  }
  void addPerson(int left, double height) {
    add(left, 12, 0.3, height - 0.35);
    add(left + 4, 4, height - 0.35, height);
  }
  [[nodiscard]] std::vector<int> persons() const { return personOfCells(cells, heights, kCell); }
};

TEST(HeadsTest, OnePersonIsOne) {
  Seen seen;
  seen.addPerson(10, 1.8);
  const auto persons = seen.persons();
  EXPECT_EQ(*std::max_element(persons.begin(), persons.end()), 0);
  EXPECT_EQ(persons.size(), seen.cells.size());
}

TEST(HeadsTest, TwoAbreastAreTwoThoughOneIsSmaller) {
  Seen seen;
  seen.addPerson(10, 1.85);
  const std::size_t first = seen.cells.size();
  seen.addPerson(22, 1.65);
  const auto persons = seen.persons();
  int wrong = 0;
  for (std::size_t i = 0; i < persons.size(); ++i)
    wrong += persons[i] == (i < first ? 0 : 1) ? 0 : 1;
  EXPECT_LE(wrong, 30) << "cells of the shoulder where they touch";
}

TEST(HeadsTest, AHatOfOneCellIsNoPerson) {
  Seen seen;
  seen.addPerson(10, 1.8);
  seen.add(26, 1, 1.6, 1.65);
  seen.add(21, 6, 1.0, 1.3);  // an arm that carries it
  const auto persons = seen.persons();
  EXPECT_EQ(*std::max_element(persons.begin(), persons.end()), 0);
}

TEST(HeadsTest, NothingIsNobody) { EXPECT_TRUE(personOfCells({}, {}, kCell).empty()); }

}  // namespace
}  // namespace headway::detect
