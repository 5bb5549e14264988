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

bool isShown(const Track& track) {
  return track.status == TrackStatus::kConfirmed || track.status == TrackStatus::kCoasting;
}

}  // namespace headway
