#pragma once

namespace headway {

/// Processor time that this process has used, all its threads together [s].
[[nodiscard]] double processorSeconds();

}  // namespace headway
