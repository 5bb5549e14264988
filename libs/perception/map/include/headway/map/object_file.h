// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/serialization/CSerializable.h>

#include <string>

namespace headway::map {

/// Writes an MRPT object as its own saveToFile() does, gz-compressed, and reports every write
/// error, which MRPT's gz streams do not.
///
/// @throws InputError if the file cannot be written; an older one then remains
void writeObject(const std::string& path, const mrpt::serialization::CSerializable& object);

}  // namespace headway::map
