#pragma once

#include <headway/core/ids.h>

#include <optional>

namespace headway::map {

/// How the probabilities of contacts with several tracks, each with several futures, add up: the
/// futures of one track exclude each other, the tracks are independent.
class ContactSum {
 public:
  /// Adds one future; those of one track come together.
  ///
  /// @param of_future   probability of the future
  /// @param of_contact  that it is touched if that future comes
  void add(TrackId track, double of_future, double of_contact);

  /// That at least one track is touched.
  double total();

  /// The track most likely touched, of those that total() or a later track closed.
  [[nodiscard]] std::optional<TrackId> mostProbable() const { return most_; }

 private:
  void closeTrack();

  std::optional<TrackId> current_, most_;
  double of_track_ = 0.0;
  double greatest_ = 0.0;
  double none_ = 1.0;
};

}  // namespace headway::map
