#pragma once

#include <mrpt/obs/CObservation.h>
#include <mrpt/poses/CPose2D.h>

#include <deque>
#include <map>
#include <optional>
#include <string>

#include "gz_stream.h"
#include "observation_reader.h"

namespace mrpt::obs {
class CActionCollection;
}

namespace headway::io {

/// The observations of a rawlog one by one, whichever of MRPT's two kinds it is.
///
/// Sensory frames come out as the observations in them; movements of action collections come out
/// as `CObservationOdometry`, summed up and dated with the observation that follows. Objects of
/// classes that this program does not know, or of a version that it does not, are leapt over, up to
/// the next header of an observation, and counted. At most one object is in memory.
class ObservationStream : public ObservationReader {
 public:
  /// @param skipped  counts objects left out, by class name without namespace
  /// @throws InputError if the file cannot be opened or does not begin like a rawlog
  ObservationStream(const std::string& path, std::map<std::string, std::size_t>& skipped);

  /// The next observation; null at the end, also where the file breaks off (see truncation()).
  [[nodiscard]] mrpt::obs::CObservation::Ptr next() override;

  /// What is broken and where, once the end came too early.
  [[nodiscard]] const std::optional<std::string>& truncation() const override {
    return truncation_;
  }
  [[nodiscard]] double progress() const override { return input_.progress(); }

 private:
  struct Header {
    std::string bytes;       ///< as in the file, without the version
    std::string class_name;  ///< with namespace
  };

  /// How objects of one class and version fared.
  struct Readability {
    std::size_t read = 0;
    std::size_t failed = 0;
  };

  std::optional<Header> readHeader();
  bool enterSensoryFrame();
  bool isHopeless(const Header& header);
  void readObject(const Header& header);
  void addMovement(const mrpt::obs::CActionCollection& actions);
  void deliver(const mrpt::obs::CObservation::Ptr& observation);
  void leapToNextObservation();
  void breakOff(const std::string& reason);

  std::string path_;
  std::map<std::string, std::size_t>& skipped_;
  GzInput input_;
  bool at_end_ = false;
  bool in_sensory_frame_ = false;
  bool has_leapt_ = false;  ///< since then the rest of an unknown object may lie in the way
  std::size_t observations_ = 0;
  std::map<std::string, Readability> readability_;  ///< by class name and version byte
  Readability* reading_ = nullptr;                  ///< of the object being read
  std::deque<mrpt::obs::CObservation::Ptr> ready_;
  mrpt::poses::CPose2D odometry_;  ///< sum of the movements of actions
  bool odometry_is_new_ = false;   ///< no observation dated it yet
  std::optional<std::string> truncation_;
};

/// Class name without namespace: "mrpt::obs::CObservationImage" gives "CObservationImage".
[[nodiscard]] std::string shortClassName(const std::string& name);
[[nodiscard]] std::string shortClassName(const mrpt::rtti::CObject& object);

}  // namespace headway::io
