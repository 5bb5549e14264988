// SPDX-License-Identifier: BSD-3-Clause
#include <headway/map/contact_sum.h>

#include <algorithm>

namespace headway::map {

void ContactSum::add(TrackId track, double of_future, double of_contact) {
  if (!current_ || *current_ != track) closeTrack();
  current_ = track;
  of_track_ += of_future * of_contact;
}

double ContactSum::total() {
  closeTrack();
  return 1.0 - none_;
}

void ContactSum::closeTrack() {
  if (of_track_ > max_probability_) {
    max_probability_ = of_track_;
    most_probable_ = current_;
  }
  none_ *= 1.0 - std::min(1.0, of_track_);
  of_track_ = 0.0;
}

}  // namespace headway::map
