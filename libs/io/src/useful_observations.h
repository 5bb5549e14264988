#pragma once

#include <headway/io/rawlog_source.h>

#include <deque>
#include <map>
#include <memory>
#include <string>

#include "camera_choice.h"
#include "observation_reader.h"

namespace headway::io {

/// The observations that frames are made of; all else is counted by reason and left out.
class UsefulObservations {
 public:
  /// @param skipped  counts "truth", "no_time", and by class name what nobody asked for
  UsefulObservations(std::unique_ptr<ObservationReader> reader, const RawlogSourceOptions& options,
                     std::map<std::string, std::size_t>& skipped)
      : reader_(std::move(reader)), options_(options), skipped_(skipped) {}

  /// Reads on until it is clear which camera is meant. What it read comes out of next(); where it
  /// takes long, of images and of motions only the last ones, and the others are counted.
  ///
  /// @throws InputError as CameraProbe::choose(), with the reason if the recording is broken off
  [[nodiscard]] CameraChoice findCamera();

  /// The next observation; null at the end.
  [[nodiscard]] mrpt::obs::CObservation::Ptr next();

  [[nodiscard]] const std::optional<std::string>& truncation() const {
    return reader_->truncation();
  }
  [[nodiscard]] double progress() const { return reader_->progress(); }

 private:
  [[nodiscard]] mrpt::obs::CObservation::Ptr read();
  [[nodiscard]] bool isOfUse(const mrpt::obs::CObservation& observation) const;
  void keep(const mrpt::obs::CObservation::Ptr& observation);
  void keepLast(std::size_t most, bool (*of_kind)(const mrpt::obs::CObservation&));

  std::unique_ptr<ObservationReader> reader_;
  RawlogSourceOptions options_;
  std::map<std::string, std::size_t>& skipped_;
  std::deque<mrpt::obs::CObservation::Ptr> kept_;  ///< read by findCamera(), to come out
};

}  // namespace headway::io
