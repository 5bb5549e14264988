// SPDX-License-Identifier: BSD-3-Clause
// A run: frames from a source, through the pipeline, to sinks.
#include <headway/core/error.h>
#include <headway/core/stage_times.h>
#include <headway/run/session.h>

#include <utility>

#include "load_shedder.h"

namespace headway::run {

Session::Session(Source& source, pipeline::Perception& perception, std::vector<Sink*> sinks,
                 SessionOptions options)
    : source_(source),
      perception_(perception),
      sinks_(std::move(sinks)),
      options_(std::move(options)) {
  if (options_.shed_load) shedder_ = std::make_unique<LoadShedder>(*options_.shed_load);
}

Session::~Session() = default;

std::optional<FrameResult> Session::next() {
  if (has_ended_) return std::nullopt;
  try {
    auto result = processNext();
    if (!result) end(std::nullopt);
    return result;
  } catch (const std::exception& error) {
    failure_ = std::current_exception();
    end(error.what());
    throw;
  } catch (...) {
    failure_ = std::current_exception();
    end("unknown error");
    throw;
  }
}

std::optional<FrameResult> Session::processNext() {
  if (options_.stop()) return std::nullopt;
  auto live = source_.next(options_.stop);
  if (!live) return std::nullopt;
  FrameResult result;
  result.frame = std::move(live->frame);
  result.arrival_s = live->arrival_s;
  result.source = source_.report();
  if (options_.prepare) options_.prepare(result.frame);
  processFrame(result);
  result.frames = ++frames_;
  shedLoad(result);
  deliver(result);
  return result;
}

void Session::processFrame(FrameResult& result) {
  const double processor_before = processorSeconds();
  result.start_s = options_.clock();
  const auto on_local = [&](const slam::SlamUpdate& camera, const map::PerceptionMap& map) {
    for (Sink* sink : sinks_) sink->onLocal(result.frame.time, camera, map);
  };
  try {
    result.update = perception_.process(result.frame, on_local);
    const auto* fatal = result.update.fatalFinding();
    if (fatal != nullptr && options_.end_at_fatal_finding) throw InputError(fatal->text);
  } catch (const InputError& error) {
    throw InputError(source_.name() + ", frame " + std::to_string(result.frame.index) + ": " +
                     error.what());
  }
  result.end_s = options_.clock();
  result.processor_s = processorSeconds() - processor_before;
}

void Session::shedLoad(FrameResult& result) {
  if (shedder_ == nullptr) return;
  const RecordedFrame& frame = result.frame;
  const auto before = std::exchange(last_, Stamped<std::size_t>{frame.time, frame.index});
  const double process_s =
      result.process_s() + 1e-3 * frame.rectify_ms + std::exchange(expendable_s_, 0.0);
  if (before && frame.index > before->value && frame.time > before->time) {
    const double interval_s =
        (frame.time - before->time) / static_cast<double>(frame.index - before->value);
    if (const auto line = shedder_->add(options_.clock(), process_s, interval_s)) {
      perception_.change(shedder_->params());
      result.load_change = *line;
    }
  }
  result.left_out = shedder_->description();
}

void Session::deliver(FrameResult& result) {
  for (Sink* sink : sinks_) {
    if (sink->isExpendable() && !result.left_out.empty()) continue;
    const double start_s = options_.clock();
    sink->onFrame(result, perception_);
    if (sink->isExpendable()) expendable_s_ += options_.clock() - start_s;  // counts with the next
  }
  result.delivered_s = options_.clock();
}

void Session::end(const std::optional<std::string>& failure) {
  has_ended_ = true;
  source_.close();
  for (Sink* sink : sinks_) sink->onEnd(failure);
}

void Session::process() {
  try {
    while (next()) {
    }
  } catch (...) {  // kept by next()
  }
  finish();
}

void Session::finish() {
  if (!std::exchange(is_finished_, true)) perception_.finish();
}

void Session::complete() {
  if (!has_ended_) end(std::nullopt);
  finish();
  for (Sink* sink : sinks_) {
    try {
      sink->onComplete(perception_);
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
  }
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

}  // namespace headway::run
