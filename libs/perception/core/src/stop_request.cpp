// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/stop_request.h>

#include <atomic>

namespace headway {
namespace {

std::atomic<int> g_reason{0};
static_assert(std::atomic<int>::is_always_lock_free, "signal handlers require it");

}  // namespace

void requestStop(int reason) noexcept { g_reason = reason; }

int stopRequest() noexcept { return g_reason; }

}  // namespace headway
