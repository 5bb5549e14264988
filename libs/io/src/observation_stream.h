#pragma once

#include <headway/io/observation_queue.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose2D.h>

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "gz_stream.h"

namespace mrpt::obs {
class CActionCollection;
}

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
/// Sensory frames are split into their observations; movements of action collections are returned
/// as `CObservationOdometry`, accumulated and with the time of the next observation. Objects of
/// unknown classes and versions are skipped up to the next observation header, and counted. At most
/// one object is in memory.
class ObservationStream : public ObservationReader {
 public:
  /// @param skipped  counts skipped objects, by class name without namespace
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
  struct Header {
    std::string bytes;       ///< as in the file, without the version
    std::string class_name;  ///< with namespace
  };

  /// Numbers of objects of one class and version that could and could not be read.
  struct Readability {
    std::size_t read = 0;
    std::size_t failed = 0;
  };

  std::optional<Header> readHeader();
  bool enterSensoryFrame();
  bool isUnreadable(const Header& header);
  void readObject(const Header& header);
  void addMovement(const mrpt::obs::CActionCollection& actions);
  void deliver(const mrpt::obs::CObservation::Ptr& observation);
  void skipToNextObservation();
  void truncate(const std::string& reason);

  std::string path_;
  std::map<std::string, std::size_t>& skipped_;
  GzInput input_;
  bool at_end_ = false;
  bool in_sensory_frame_ = false;
  bool has_skipped_ = false;  ///< the remainder of an unknown object may follow
  std::size_t observations_ = 0;
  std::map<std::string, Readability> readability_;  ///< by class name and version byte
  Readability* reading_ = nullptr;                  ///< of the object being read
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

/// Class name without namespace: "mrpt::obs::CObservationImage" gives "CObservationImage".
[[nodiscard]] std::string shortClassName(const std::string& name);
[[nodiscard]] std::string shortClassName(const mrpt::rtti::CObject& object);

}  // namespace headway::io
