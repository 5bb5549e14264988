#pragma once

#include <headway/core/detection.h>

#include <cstdint>
#include <map>
#include <vector>

namespace headway::detect {

/// A moving object over the frames in which it was found.
struct ObjectIdentity {
  std::int64_t id = 0;
  int sightings = 0;                                   ///< frames in which it was found
  Time time = 0.0;                                     ///< when last
  Eigen::Vector3d place = Eigen::Vector3d::Zero();     ///< then, world of the path [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< then [m/s]
  std::map<ObjectClass, int> votes;                    ///< how often each class was guessed

  /// The class most often guessed: one frame may show only a part of it.
  [[nodiscard]] ObjectClass objectClass() const;
};

/// Where something that moves was found, and who it may be.
struct FoundObject {
  std::vector<std::int64_t> hints;  ///< ids that its parts had before, the most likely first
  Eigen::Vector3d place = Eigen::Vector3d::Zero();     ///< world of the path [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  double gate_m = 1.0;                                 ///< farther from here it is another [m]
  ObjectClass object_class = ObjectClass::kUnknown;    ///< as guessed in this frame
};

/// Says which of the objects found before one found now is.
///
/// It is the one that its parts belonged to, or else the nearest to where that one must have gone
/// meanwhile: points on people do not live long, and are other ones each few frames. No identity
/// is given twice in a frame, and those unseen for a second are forgotten.
class ObjectIdentities {
 public:
  void beginFrame(Time now);

  /// Whether an id may still be given in this frame.
  [[nodiscard]] bool isFree(std::int64_t id) const;

  /// The object that `found` is, with this sighting counted; a new one where it is none known.
  const ObjectIdentity& identify(const FoundObject& found);

  void clear() { known_.clear(); }

 private:
  [[nodiscard]] std::int64_t nearest(const FoundObject& found) const;

  std::map<std::int64_t, ObjectIdentity> known_;
  Time now_ = 0.0;
  std::int64_t next_id_ = 0;
};

}  // namespace headway::detect
