#pragma once

#include <headway/core/detection.h>

#include <cstdint>
#include <map>
#include <optional>
#include <vector>

#include "mover_look.h"

namespace headway::detect {

/// A moving object over the frames in which it was found.
struct ObjectIdentity {
  std::int64_t id = 0;
  int sightings = 0;                                ///< frames in which it was found
  Time time = 0.0;                                  ///< when last
  Time moved_time = 0.0;                            ///< when last by how it moved
  Eigen::Vector3d place = Eigen::Vector3d::Zero();  ///< when found last, world of the path [m]
  MeasuredVelocity velocity;                        ///< then, world of the path
  std::map<ObjectClass, int> votes;                 ///< how often each class was guessed
  std::optional<MoverLook> look;                    ///< if one was remembered

  /// Where it must have gone by then, world of the path [m].
  [[nodiscard]] Eigen::Vector3d expectedAt(Time then) const {
    return place + (then - time) * velocity.value;
  }

  /// The class most often guessed: one frame may show only a part of it.
  [[nodiscard]] ObjectClass objectClass() const;
};

/// Where something that moves was found, and who it may be.
struct FoundObject {
  std::vector<std::int64_t> hints;  ///< ids that its parts had before, the most likely first
  Eigen::Vector3d place = Eigen::Vector3d::Zero();   ///< world of the path [m]
  MeasuredVelocity velocity;                         ///< world of the path
  double gate_m = 1.0;                               ///< farther from here it is another [m]
  ObjectClass object_class = ObjectClass::kUnknown;  ///< as guessed in this frame
  bool moved = true;                                 ///< found by how it moved
};

/// Says which of the objects found before one found now is.
///
/// It is the one that its parts belonged to, or else the nearest to where that one must have gone
/// meanwhile: points on people do not live long, and are other ones each few frames. No identity
/// is given twice in a frame, and those of which nothing moved for a second are forgotten.
class ObjectIdentities {
 public:
  void beginFrame(Time now);

  /// Whether an id may still be given in this frame.
  [[nodiscard]] bool isFree(std::int64_t id) const;

  /// The object that `found` is, with this sighting counted; a new one where it is none known.
  const ObjectIdentity& identify(const FoundObject& found);

  /// How an object looks now; nullopt: it cannot be known again by that.
  void remember(std::int64_t id, std::optional<MoverLook> look) {
    known_.at(id).look = std::move(look);
  }

  /// Those that were not found in this frame.
  [[nodiscard]] std::vector<ObjectIdentity> missing() const;

  void clear() { known_.clear(); }

 private:
  [[nodiscard]] std::int64_t nearest(const FoundObject& found) const;

  std::map<std::int64_t, ObjectIdentity> known_;
  Time now_ = 0.0;
  std::int64_t next_id_ = 0;
};

}  // namespace headway::detect
