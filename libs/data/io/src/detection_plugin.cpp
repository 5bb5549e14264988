// SPDX-License-Identifier: BSD-3-Clause
// Plug-in for the MRPT tools: `rawlog-edit -p libheadway-plugin.so --info -i X.rawlog`,
// `RawLogViewer -l libheadway-plugin.so`.
#include <headway/io/detection_observation.h>
#include <mrpt/core/initializer.h>

MRPT_INITIALIZER(registerHeadwayClasses) { headway::io::registerClasses(); }
