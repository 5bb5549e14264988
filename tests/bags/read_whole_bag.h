// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/bags/bag_import.h>
#include <headway/core/error.h>

#include <string>

#include "bag_rig.h"
#include "message_import.h"

namespace headway::bags::test {

/// Reads and converts all of a bag, without writing a rawlog.
///
/// @return the number of events, or of none if the bag is refused with an InputError
inline std::size_t readWholeBag(const std::string& path) {
  std::size_t events = 0;
  try {
    BagImportOptions options;
    const auto bag = openBag(path);
    options.topics = selectTopics(bag->topics(), {});
    const BagRig rig = rigOf(surveyBag(path, options.topics), options);
    BagImportSummary summary;
    MessageImport import(options, rig, summary);
    while (const auto message = bag->next()) {
      import.add(bag->topics()[message->topic], *message);
      while (import.next(false)) ++events;
    }
    while (import.next(true)) ++events;
  } catch (const InputError&) {  // expected of most damaged bags
  }
  return events;
}

}  // namespace headway::bags::test
