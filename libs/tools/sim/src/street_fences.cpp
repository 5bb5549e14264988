// SPDX-License-Identifier: BSD-3-Clause
#include "furniture.h"
#include "street_profile.h"
#include "street_site.h"

namespace headway::sim {

void StreetBuilder::placeFences(const Site& site, StreetStretch& stretch) const {
  if (params_.fence_ratio <= 0.0) return;  // worlds without fences draw no random numbers for them
  constexpr double kLot = 6.0;             // length of one fence [m]
  const int lots = std::max(1, static_cast<int>(std::lround(site.length / kLot)));
  for (const double side : {1.0, -1.0}) {
    Random random(stretchSeed(params_, site.key, kFenceSeed, side > 0));
    const double left = side * (StreetProfile::kEdge - 0.1);
    for (int i = 0; i < lots; ++i) {
      Random own(random.bits());
      const double s0 = site.begin + site.length * i / lots;
      const double s1 = site.begin + site.length * (i + 0.95) / lots;
      const bool is_free = site.drawn(s0) && site.drawn(s1) && isFree(site, s0, left, 0.3) &&
                           isFree(site, s1, left, 0.3);
      if (!own.chance(params_.fence_ratio) || !is_free) continue;
      constexpr double kUp = StreetProfile::kKerbHeight;
      addFence(stretch.furniture.emplace_back(), site.local(s0, left, kUp),
               site.local(s1, left, kUp), own);
    }
  }
}

}  // namespace headway::sim
