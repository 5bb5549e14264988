// SPDX-License-Identifier: BSD-3-Clause
#include <headway/core/track.h>

namespace headway {

std::string_view toString(TrackStatus status) {
  switch (status) {
    case TrackStatus::kTentative:
      return "tentative";
    case TrackStatus::kConfirmed:
      return "confirmed";
    case TrackStatus::kCoasting:
      return "coasting";
    case TrackStatus::kEnded:
      return "ended";
  }
  return "unknown";
}

std::string_view toString(MotionState state) {
  switch (state) {
    case MotionState::kUnknown:
      return "unknown";
    case MotionState::kMoving:
      return "moving";
    case MotionState::kStatic:
      return "static";
  }
  return "unknown";
}

bool isShown(const Track& track) {
  return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting;
}

bool isMoving(const Track& track) { return track.motion_state == MotionState::kMoving; }

}  // namespace headway
