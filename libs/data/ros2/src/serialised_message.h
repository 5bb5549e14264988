// SPDX-License-Identifier: BSD-3-Clause
// Messages of any type as Cyclone DDS keeps them: their bytes.
#pragma once

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <dds/ddsi/ddsi_sertype.h>

#include <string>

namespace headway::ros2 {

/// A message as CDR with its encapsulation.
struct SerialisedMessage : ddsi_serdata {
  SerialisedMessage(const ddsi_sertype* of_type, ddsi_serdata_kind of_kind, std::string content);

  std::string bytes;     ///< with padding
  std::size_t size = 0;  ///< of them without padding
};

/// A type without key, of which Cyclone DDS knows nothing but the name, so that it neither decodes
/// nor refuses messages: what they contain is checked by who reads them. It is what ROS 2 does.
///
/// @return  to be passed to dds_create_topic_sertype(), which takes it
[[nodiscard]] ddsi_sertype* makeSerialisedType(const std::string& name);

}  // namespace headway::ros2
