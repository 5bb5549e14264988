// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/output_file.h>
#include <headway/map/object_file.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include "zlib_stream.h"

namespace headway::map {

void writeObject(const std::string& path, const mrpt::serialization::CSerializable& object) {
  OutputFile file(path);
  mrpt::io::CMemoryStream bytes;
  mrpt::serialization::archiveFrom(bytes) << object;
  ZlibWriter content(file.stream(), ZlibWriter::Format::kGz);
  content.write({static_cast<const char*>(bytes.getRawBufferData()), bytes.getTotalBytesCount()});
  content.finish();
  file.commit();
}

}  // namespace headway::map
