// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway {

/// Processor time of this process, sum of all threads [s].
[[nodiscard]] double processorSeconds();

}  // namespace headway
