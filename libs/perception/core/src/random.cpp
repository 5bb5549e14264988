// SPDX-License-Identifier: BSD-3-Clause
// Random numbers that are the same on every machine.
#include <headway/core/random.h>

#include <cmath>

namespace headway {
namespace {

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;

std::uint64_t mixed(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

}  // namespace

std::uint64_t seedOf(std::initializer_list<std::uint64_t> numbers) {
  std::uint64_t seed = kGolden;
  for (const std::uint64_t number : numbers) seed = mixed(seed ^ mixed(number + kGolden)) + kGolden;
  return seed;
}

std::uint64_t Random::bits() { return mixed(state_ += kGolden); }

double Random::uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

double Random::uniform(double low, double high) { return low + (high - low) * uniform(); }

int Random::below(int n) { return static_cast<int>(uniform() * n); }

bool Random::chance(double probability) { return uniform() < probability; }

double Random::normal() {
  // Box and Muller 1958.
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform()));
  return radius * std::cos(2.0 * M_PI * uniform());
}

}  // namespace headway
