// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/error.h>
#include <headway/detect/model_hash.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <memory>
#include <vector>

namespace headway::detect {

std::string sha256OfFile(const std::string& path) {
  constexpr std::size_t kBlock = 1 << 16;  // bytes
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be read");
  const std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context(EVP_MD_CTX_new(),
                                                                   EVP_MD_CTX_free);
  bool is_valid = EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  std::vector<char> block(kBlock);
  while (is_valid && file) {
    file.read(block.data(), static_cast<std::streamsize>(block.size()));
    is_valid = EVP_DigestUpdate(context.get(), block.data(),
                                static_cast<std::size_t>(file.gcount())) == 1;
  }
  std::array<unsigned char, EVP_MAX_MD_SIZE> hash{};
  unsigned size = 0;
  is_valid = is_valid && file.eof() && EVP_DigestFinal_ex(context.get(), hash.data(), &size) == 1;
  if (!is_valid) throw InputError(path + ": its SHA-256 cannot be computed");
  std::string text;
  for (unsigned i = 0; i < size; ++i) {
    constexpr const char* kDigits = "0123456789abcdef";
    text += kDigits[hash[i] >> 4U];
    text += kDigits[hash[i] & 0xFU];
  }
  return text;
}

}  // namespace headway::detect
