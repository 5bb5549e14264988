// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::exporting {

/// headway-export map: writes a replay's map again, cut to a box.
///
/// @return exit status
/// @throws UsageError, InputError
int runMapExport(int argc, const char** argv);

}  // namespace headway::exporting
