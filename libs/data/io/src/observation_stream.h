// SPDX-License-Identifier: BSD-3-Clause
// Reading the observations of a rawlog within bounds, which is why 890 mutated rawlogs cost no
// memory and no crash.
#pragma once

#include <headway/io/rawlog_source.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose2D.h>

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "object_reader.h"

namespace headway::io {

/// Source of observations: a file or live sensors.
class ObservationReader {
 public:
  virtual ~ObservationReader() = default;
  /// The next observation; null at the end.
  [[nodiscard]] virtual mrpt::obs::CObservation::Ptr next() = 0;
  /// Reason of a premature end; nullopt otherwise.
  [[nodiscard]] virtual const std::optional<std::string>& truncation() const = 0;
  /// Ratio read so far, 0 to 1.
  [[nodiscard]] virtual double progress() const = 0;
};

/// Reads the observations of a rawlog of either kind.
///
/// Sensory frames and action collections are entered, however deeply they are nested, and their
/// objects returned one by one; movements are returned as `CObservationOdometry`, accumulated and
/// with the time of the next observation. Objects of other classes, of unknown versions, and broken
/// ones are skipped up to the next header of an observation, and counted. At most one object is in
/// memory.
class ObservationStream : public ObservationReader {
 public:
  /// @param skipped  counts skipped objects by class name without namespace, those that cannot be
  ///                 read as "unreadable_<class>", and bytes between objects as "broken_header"
  /// @throws InputError if the file cannot be opened or is not a rawlog
  ObservationStream(const std::string& path, std::map<std::string, std::size_t>& skipped);

  /// The next observation; null at the end or at a truncation (see truncation()).
  [[nodiscard]] mrpt::obs::CObservation::Ptr next() override;

  /// Reason and position of a premature end.
  [[nodiscard]] const std::optional<std::string>& truncation() const override {
    return truncation_;
  }
  [[nodiscard]] double progress() const override { return input_.progress(); }

 private:
  std::optional<std::string> readClassName();
  std::nullopt_t endOfFile();
  void readObject(const std::string& class_name);
  bool readValues(const std::string& name);
  void enterContainer(const std::string& name, ObjectReader& in);
  void addMovement(const mrpt::poses::CPose2D& increment);
  void deliver(const mrpt::obs::CObservation::Ptr& observation);
  void count(const std::string& reason);
  bool skipToNextObservation();
  void truncate(const std::string& reason);

  std::string path_;
  std::map<std::string, std::size_t>& skipped_;
  CompressedInput input_;
  std::uint64_t header_position_ = 0;  ///< of the object being read
  bool at_end_ = false;
  std::size_t open_containers_ = 0;  ///< whose end marks have not been read
  bool has_skipped_ = false;         ///< the remainder of a skipped object may follow
  std::size_t objects_since_skip_ = 2;
  std::size_t observations_ = 0;
  std::deque<mrpt::obs::CObservation::Ptr> ready_;
  mrpt::poses::CPose2D odometry_;  ///< sum of the movements of actions
  bool odometry_is_new_ = false;   ///< not yet returned with an observation
  std::optional<std::string> truncation_;
};

/// Live observations from a queue, which must outlive this object.
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

/// Class name of an object without namespace.
[[nodiscard]] std::string shortClassName(const mrpt::rtti::CObject& object);

}  // namespace headway::io
