// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/byte_archive.h>
#include <headway/core/scan.h>

namespace headway::map {

void write(ByteWriter& out, const DepthScan& scan);

/// @throws InputError if the bytes end early, or contain an invalid camera or other numbers of
///         depths and colours than known cells
[[nodiscard]] DepthScan readDepthScan(ByteReader& in);

}  // namespace headway::map
