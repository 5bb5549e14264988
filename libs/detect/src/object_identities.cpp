#include "object_identities.h"

#include <algorithm>

namespace headway::detect {
namespace {

constexpr double kForgotten = 1.0;  // nothing of it moved for longer [s]
constexpr std::int64_t kNobody = -1;

}  // namespace

ObjectClass ObjectIdentity::objectClass() const {
  const auto most = std::max_element(votes.begin(), votes.end(),
                                     [](auto& a, auto& b) { return a.second < b.second; });
  return most != votes.end() ? most->first : ObjectClass::kUnknown;
}

void ObjectIdentities::beginFrame(Time now) {
  now_ = now;
  for (auto item = known_.begin(); item != known_.end();) {
    item = now_ - item->second.moved_time > kForgotten ? known_.erase(item) : std::next(item);
  }
}

bool ObjectIdentities::isFree(std::int64_t id) const {
  const auto item = known_.find(id);
  return item != known_.end() && item->second.time < now_;
}

const ObjectIdentity& ObjectIdentities::identify(const FoundObject& found) {
  const auto hint = std::find_if(found.hints.begin(), found.hints.end(),
                                 [&](std::int64_t id) { return isFree(id); });
  std::int64_t id = hint != found.hints.end() ? *hint : nearest(found);
  if (id == kNobody) id = next_id_++;
  ObjectIdentity& identity = known_[id];
  identity.id = id;
  ++identity.sightings;
  identity.time = now_;
  if (found.moved) identity.moved_time = now_;
  identity.place = found.place;
  identity.velocity = found.velocity;
  ++identity.votes[found.object_class];
  return identity;
}

std::vector<ObjectIdentity> ObjectIdentities::missing() const {
  std::vector<ObjectIdentity> missing;
  for (const auto& [id, identity] : known_) {
    if (isFree(id)) missing.push_back(identity);
  }
  return missing;
}

std::int64_t ObjectIdentities::nearest(const FoundObject& found) const {
  std::int64_t best = kNobody;
  double least = found.gate_m;
  for (const auto& [id, identity] : known_) {
    if (!isFree(id)) continue;
    const double off = (found.place - identity.expectedAt(now_)).norm();
    if (off >= least) continue;
    least = off;
    best = id;
  }
  return best;
}

}  // namespace headway::detect
