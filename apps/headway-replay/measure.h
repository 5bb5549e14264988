#pragma once

namespace headway::replay {

/// Seconds since this process was started (not since main).
[[nodiscard]] double secondsSinceProcessStart();

/// CPU time of all threads of this process so far [ms].
[[nodiscard]] double processCpuMs();

/// Greatest resident memory of this process so far [MB].
[[nodiscard]] double peakMemoryMb();

}  // namespace headway::replay
