// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <headway/core/ids.h>

#include <optional>

namespace headway::map {

/// Combines the probabilities of contacts with several tracks, each with several predicted paths:
/// the paths of one track exclude each other, the tracks are independent.
class ContactSum {
 public:
  /// Adds one predicted path; the paths of one track must be added consecutively.
  ///
  /// @param of_future   probability of the path
  /// @param of_contact  probability of a contact, given the path
  void add(TrackId track, double of_future, double of_contact);

  /// Probability of a contact with at least one track.
  double total();

  /// The track of the most probable contact, after total().
  [[nodiscard]] std::optional<TrackId> mostProbable() const { return most_probable_; }

 private:
  void closeTrack();

  std::optional<TrackId> current_, most_probable_;
  double of_track_ = 0.0;
  double max_probability_ = 0.0;
  double none_ = 1.0;
};

}  // namespace headway::map
