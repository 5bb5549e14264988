// SPDX-License-Identifier: BSD-3-Clause
#include <headway/bags/bag_import.h>
#include <headway/core/error.h>

#include "bag_rig.h"
#include "bag_survey.h"
#include "message_import.h"

namespace headway::bags {
namespace {

/// Writes the selected frames and what was measured between them.
class EventWriter {
 public:
  EventWriter(const BagImportOptions& options, io::RawlogSink& sink, BagImportSummary& summary)
      : options_(options), sink_(sink), summary_(summary) {}

  /// False after the last frame.
  [[nodiscard]] bool write(const TimeOrder::Event& event) {
    const bool is_frame = event.kind == nullptr;
    if (is_frame && options_.last_frame && frame_ > *options_.last_frame) return false;
    const bool is_selected = frame_ >= options_.first_frame;
    if (is_selected) {
      event.write(sink_);
      ++(is_frame ? summary_.frames : summary_.written[event.kind]);
    }
    if (is_frame) ++frame_;
    return true;
  }

  [[nodiscard]] std::size_t framesRead() const { return frame_; }

 private:
  const BagImportOptions& options_;
  io::RawlogSink& sink_;
  BagImportSummary& summary_;
  std::size_t frame_ = 0;
};

}  // namespace

BagImportSummary importBag(const std::string& path, const BagImportOptions& options,
                           io::RawlogSink& sink,
                           const std::function<bool(std::size_t, double)>& go_on) {
  BagImportSummary summary;
  const BagRig rig = rigOf(surveyBag(path, options.topics), options);
  summary.notes = rig.notes;
  MessageImport import(options, rig, summary);
  EventWriter writer(options, sink, summary);
  const auto bag = openBag(path);
  bool is_selected = true;
  const auto write_due = [&](bool at_end) {
    while (is_selected) {
      const auto event = import.next(at_end);
      if (!event) break;
      is_selected = writer.write(*event);
      if (event->kind == nullptr && !go_on(summary.frames, bag->progress()))
        summary.was_stopped = true;
      if (summary.was_stopped) is_selected = false;
    }
  };
  while (is_selected) {
    const auto message = bag->next();
    if (!message) break;
    import.add(bag->topics()[message->topic], *message);
    write_due(false);
  }
  write_due(true);
  if (!summary.was_stopped) import.finish();
  if (summary.frames == 0 && !summary.was_stopped) {
    throw InputError("--from-index " + std::to_string(options.first_frame) + ": the bag has only " +
                     std::to_string(writer.framesRead()) + " frames");
  }
  summary.truncation = bag->truncation();
  for (const auto& [reason, count] : bag->skipped()) summary.dropped[reason] += count;
  return summary;
}

}  // namespace headway::bags
