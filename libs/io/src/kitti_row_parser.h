#pragma once

#include <headway/io/track_file.h>

#include "text_rows.h"

namespace headway::io {

/// The row that was read last, as a KITTI label (17 fields) or result (18, with the score).
///
/// A label's score is 1. @throws InputError naming file and line of what cannot be read
[[nodiscard]] KittiRow kittiRow(const TextRows& rows);

}  // namespace headway::io
