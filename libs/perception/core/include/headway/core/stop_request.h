// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

namespace headway {

/// Whether a long-running function should return early with what it has; called by any thread.
using StopCondition = std::function<bool()>;

[[nodiscard]] inline bool neverStop() noexcept { return false; }

/// Asks the long-running functions of this process to return early with what they have: reading
/// and skipping of recordings, waiting, and what gets stopRequested() as its StopCondition.
/// Callable from signal handlers and from any thread.
///
/// @param reason  not 0, such as the number of a signal; 0 withdraws the request
void requestStop(int reason) noexcept;

/// The reason given to requestStop(); 0 without a request.
[[nodiscard]] int stopRequest() noexcept;

/// Whether there is a request.
[[nodiscard]] inline bool stopRequested() noexcept { return stopRequest() != 0; }

}  // namespace headway
