// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace headway::import {

/// `headway-import rosbag`: lists the topics of a bag, or writes it as a rawlog.
///
/// @throws program::UsageError, InputError
int runRosbag(int argc, const char** argv);

}  // namespace headway::import
