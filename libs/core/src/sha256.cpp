#include <headway/core/error.h>
#include <headway/core/sha256.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <vector>

namespace headway {
namespace {

constexpr std::size_t kBlock = 64;          // bytes
constexpr std::size_t kLengthField = 8;     // bytes at the end of the last block
constexpr double kFraction = 4294967296.0;  // 2^32

using Words = std::array<std::uint32_t, 8>;

std::uint32_t rotated(std::uint32_t word, int bits) {
  return (word >> bits) | (word << (32 - bits));
}

/// The first 32 bits of the fractional parts of roots of the first primes (Sec. 4.2.2, 5.3.3).
template <std::size_t N, class Root>
std::array<std::uint32_t, N> fractionsOfRoots(Root root) {
  std::array<std::uint32_t, N> words{};
  std::size_t count = 0;
  for (int number = 2; count < N; ++number) {
    bool prime = true;
    for (int divisor = 2; divisor * divisor <= number; ++divisor) prime &= number % divisor != 0;
    if (!prime) continue;
    const long double value = root(static_cast<long double>(number));
    words[count++] = static_cast<std::uint32_t>((value - std::floor(value)) * kFraction);
  }
  return words;
}

/// One block of the message (Sec. 6.2.2).
void addBlock(const unsigned char* block, Words& hash) {
  static const auto kRounds = fractionsOfRoots<64>([](long double x) { return std::cbrt(x); });
  std::array<std::uint32_t, 64> w{};
  for (std::size_t t = 0; t < 16; ++t) {
    for (std::size_t byte = 0; byte < 4; ++byte) w[t] = (w[t] << 8) | block[4 * t + byte];
  }
  for (std::size_t t = 16; t < 64; ++t) {
    const auto a = w[t - 15], b = w[t - 2];
    w[t] = w[t - 16] + w[t - 7] + (rotated(a, 7) ^ rotated(a, 18) ^ (a >> 3)) +
           (rotated(b, 17) ^ rotated(b, 19) ^ (b >> 10));
  }
  Words s = hash;
  for (std::size_t t = 0; t < 64; ++t) {
    const auto sum1 = rotated(s[4], 6) ^ rotated(s[4], 11) ^ rotated(s[4], 25);
    const auto choice = (s[4] & s[5]) ^ (~s[4] & s[6]);
    const auto t1 = s[7] + sum1 + choice + kRounds[t] + w[t];
    const auto sum0 = rotated(s[0], 2) ^ rotated(s[0], 13) ^ rotated(s[0], 22);
    const auto majority = (s[0] & s[1]) ^ (s[0] & s[2]) ^ (s[1] & s[2]);
    s = {t1 + sum0 + majority, s[0], s[1], s[2], s[3] + t1, s[4], s[5], s[6]};
  }
  for (std::size_t i = 0; i < hash.size(); ++i) hash[i] += s[i];
}

}  // namespace

std::string sha256OfFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read");
  std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(file), {}};
  if (file.bad()) throw InputError(path + ": cannot be read");
  const std::uint64_t bits = 8 * static_cast<std::uint64_t>(bytes.size());
  bytes.push_back(0x80);
  while (bytes.size() % kBlock != kBlock - kLengthField) bytes.push_back(0);
  for (int shift = 56; shift >= 0; shift -= 8) {
    bytes.push_back(static_cast<unsigned char>(bits >> shift));
  }
  Words hash = fractionsOfRoots<8>([](long double x) { return std::sqrt(x); });
  for (std::size_t at = 0; at < bytes.size(); at += kBlock) addBlock(bytes.data() + at, hash);
  static const char* const kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint32_t word : hash) {
    for (int shift = 28; shift >= 0; shift -= 4) text += kDigits[(word >> shift) & 15U];
  }
  return text;
}

}  // namespace headway
