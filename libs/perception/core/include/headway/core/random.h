// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace headway {

/// Seed of one part of a simulation, derived from the global seed and the part's own numbers.
///
/// Different numbers give unrelated seeds, so that one part does not depend on the parts generated
/// before it.
[[nodiscard]] std::uint64_t seedOf(std::initializer_list<std::uint64_t> numbers);

/// Pseudo-random numbers that are the same on every machine (the standard's distributions differ
/// between libraries).
///
/// @see Steele, Lea & Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64)
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  [[nodiscard]] std::uint64_t bits();
  [[nodiscard]] double uniform();                         ///< in [0, 1)
  [[nodiscard]] double uniform(double low, double high);  ///< in [low, high)
  [[nodiscard]] int below(int n);                         ///< 0 ... n-1; n > 0
  [[nodiscard]] bool chance(double probability);
  [[nodiscard]] double normal();  ///< mean 0, standard deviation 1

 private:
  std::uint64_t state_;
};

}  // namespace headway
