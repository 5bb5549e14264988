// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/img/CImage.h>

#include "object_reader.h"

namespace headway::io {

/// Where and how a rawlog stores an image.
///
/// It is decoded only after its object has been read to the end mark, so that bytes are not decoded
/// more than once in broken files.
struct RecordedImage {
  enum class Storage { kNone, kExternal, kGrey, kZippedGrey, kBgr, kRgb, kEncoded, kUnsupported };
  Storage storage = Storage::kNone;
  std::string file;            ///< kExternal: its name
  int width = 0;               ///< [px]; 0 with kExternal and kEncoded
  int height = 0;              ///< [px]
  std::uint64_t position = 0;  ///< of the pixels or the encoded image in the stream
  std::size_t bytes = 0;       ///< their number
};

/// Reads an object of MRPT's class CImage, versions 0 to 10 and 100.
///
/// @throws BrokenObject if it is not such an object, or larger than kMaxImagePixels
[[nodiscard]] RecordedImage readImage(ObjectReader& in);

/// The image with its pixels copied or decoded; empty if it is broken.
[[nodiscard]] mrpt::img::CImage mrptImage(const RecordedImage& image, const ObjectReader& in);

}  // namespace headway::io
