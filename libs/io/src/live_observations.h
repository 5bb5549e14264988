#pragma once

#include <headway/io/observation_queue.h>

#include "observation_reader.h"

namespace headway::io {

/// Observations that sensors push. The queue must outlive this.
class LiveObservations : public ObservationReader {
 public:
  explicit LiveObservations(ObservationQueue& queue) : queue_(queue) {}
  [[nodiscard]] mrpt::obs::CObservation::Ptr next() override { return queue_.pop(); }
  [[nodiscard]] const std::optional<std::string>& truncation() const override { return none_; }
  [[nodiscard]] double progress() const override { return 0.0; }

 private:
  ObservationQueue& queue_;
  std::optional<std::string> none_;
};

}  // namespace headway::io
