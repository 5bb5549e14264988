// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#if defined(__has_feature)
#define HEADWAY_HAS_FEATURE(name) __has_feature(name)
#else
#define HEADWAY_HAS_FEATURE(name) 0
#endif

namespace headway::test {

/// Whether this is a build with AddressSanitizer or ThreadSanitizer (GCC's macros, Clang's
/// features).
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || \
    HEADWAY_HAS_FEATURE(address_sanitizer) || HEADWAY_HAS_FEATURE(thread_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

/// How often a test repeats something, with other seeds or frames. Faults of behaviour are looked
/// for in all; those of memory and threads, which a sanitizer finds, show in a few.
template <typename Count>
constexpr Count repeats(Count all, Count few) {
  return kSanitized ? few : all;
}

}  // namespace headway::test

#undef HEADWAY_HAS_FEATURE
