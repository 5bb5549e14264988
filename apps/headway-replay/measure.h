#pragma once

namespace headway::replay {

/// Seconds since this process was started (not since main).
[[nodiscard]] double secondsSinceProcessStart();

/// Greatest resident memory of this process so far [MB].
[[nodiscard]] double peakMemoryMb();

}  // namespace headway::replay
