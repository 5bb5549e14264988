// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway {

/// Asks the long-running functions of this process to return early with what they have: reading
/// and skipping of recordings, waiting, adjustment of maps. Callable from signal handlers and from
/// any thread.
///
/// @param reason  not 0, such as the number of a signal; 0 withdraws the request
void requestStop(int reason) noexcept;

/// The reason given to requestStop(); 0 without a request.
[[nodiscard]] int stopRequest() noexcept;

/// Whether there is a request.
[[nodiscard]] inline bool stopRequested() noexcept { return stopRequest() != 0; }

}  // namespace headway
