// SPDX-License-Identifier: BSD-3-Clause
// Meshes of people, cyclists, vehicles and machines.
#include "actor_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "actor_atlas.h"

namespace headway::sim {
namespace {

using Eigen::Vector3f;

constexpr auto kPi = static_cast<float>(M_PI);

/// A limb: an elliptic tube from one joint to the next, half axes (across, along the walk) [m].
void addLimb(Mesh& mesh, const Vector3f& from, const Vector3f& to, const Eigen::Vector2f& from_axes,
             const Eigen::Vector2f& to_axes, const UvRect& uv, int corners = 6) {
  const Vector3f across = Vector3f::UnitY();
  const Vector3f along = across.cross((to - from).normalized()).normalized();
  Vector3f from_here, to_here;
  for (int i = 0; i <= corners; ++i) {
    // Starts behind, so that the middle of the picture faces forward.
    const float angle = kPi + 2.0F * kPi * static_cast<float>(i) / static_cast<float>(corners);
    const float sine = std::sin(angle), cosine = std::cos(angle);
    const auto corner = [&](const Vector3f& joint, const Eigen::Vector2f& axes) {
      return Vector3f(joint + axes.x() * sine * across - axes.y() * cosine * along);
    };
    const Vector3f from_next = corner(from, from_axes), to_next = corner(to, to_axes);
    if (i > 0) {
      const float u0 = static_cast<float>(i - 1) / static_cast<float>(corners);
      const float u1 = static_cast<float>(i) / static_cast<float>(corners);
      mesh.addQuad(from_here, from_next, to_next, to_here, uv.part(u0, 0, u1, 1));
    }
    from_here = from_next;
    to_here = to_next;
  }
}

/// End of a bone of given length that hangs down, swung forward by an angle.
Vector3f hang(const Vector3f& joint, float length, float angle) {
  return joint + length * Vector3f(std::sin(angle), 0.0F, -std::cos(angle));
}

/// Angles of one side's joints [rad], forward positive.
struct Swing {
  float hip = 0, knee = 0, shoulder = 0, elbow = 0;
};

void addLeg(Mesh& mesh, const Vector3f& hip, float height, const Swing& swing,
            const PersonSkin& skin) {
  const Vector3f knee = hang(hip, 0.245F * height, swing.hip);
  const Vector3f ankle = hang(knee, 0.235F * height, swing.hip - swing.knee);
  addLimb(mesh, hip, knee, {0.052F * height, 0.055F * height}, {0.034F * height, 0.036F * height},
          skin.trousers.part(0, 0, 1, 0.5F));
  addLimb(mesh, knee, ankle, {0.034F * height, 0.037F * height}, {0.024F * height, 0.027F * height},
          skin.trousers.part(0, 0.5F, 1, 1));
  const float pitch = swing.hip - swing.knee;
  const Vector3f toe = ankle + 0.12F * height * Vector3f(std::cos(pitch), 0, std::sin(pitch)) +
                       Vector3f(0, 0, -0.022F * height);
  const Vector3f heel = ankle + Vector3f(-0.035F * height, 0, -0.018F * height);
  addLimb(mesh, heel, toe, {0.026F * height, 0.024F * height}, {0.022F * height, 0.014F * height},
          skin.shoes, 4);
}

void addArm(Mesh& mesh, const Vector3f& shoulder, float height, const Swing& swing,
            const PersonSkin& skin) {
  const Vector3f elbow = hang(shoulder, 0.17F * height, swing.shoulder);
  const Vector3f wrist = hang(elbow, 0.15F * height, swing.shoulder + swing.elbow);
  const Vector3f hand = hang(wrist, 0.07F * height, swing.shoulder + swing.elbow);
  addLimb(mesh, shoulder, elbow, {0.033F * height, 0.033F * height},
          {0.026F * height, 0.026F * height}, skin.torso.part(0, 0.05F, 0.25F, 0.5F), 5);
  addLimb(mesh, elbow, wrist, {0.026F * height, 0.026F * height},
          {0.019F * height, 0.019F * height}, skin.torso.part(0, 0.4F, 0.25F, 0.85F), 5);
  addLimb(mesh, wrist, hand, {0.02F * height, 0.024F * height}, {0.012F * height, 0.018F * height},
          skin.skin, 4);
}

/// Torso from hips to neck and head, leaning forward by an angle.
void addTrunk(Mesh& mesh, const Vector3f& hips, float height, float lean, const PersonSkin& skin,
              bool bag) {
  const auto up = [&](float ratio) {
    return Vector3f(hips + ratio * height * Vector3f(std::sin(lean), 0, std::cos(lean)));
  };
  const auto axes = [&](float across, float along) {
    return Eigen::Vector2f(across * height, along * height);
  };
  addLimb(mesh, up(0.3F), up(0.24F), axes(0.05F, 0.04F), axes(0.118F, 0.06F),
          skin.torso.part(0, 0, 1, 0.15F), 8);
  addLimb(mesh, up(0.24F), up(0.1F), axes(0.118F, 0.065F), axes(0.092F, 0.06F),
          skin.torso.part(0, 0.15F, 1, 0.7F), 8);
  addLimb(mesh, up(0.1F), up(-0.04F), axes(0.092F, 0.06F), axes(0.098F, 0.066F),
          skin.torso.part(0, 0.7F, 1, 1), 8);
  addLimb(mesh, up(0.345F), up(0.28F), axes(0.03F, 0.033F), axes(0.036F, 0.036F), skin.skin, 6);
  addLimb(mesh, up(0.47F), up(0.445F), axes(0.02F, 0.025F), axes(0.043F, 0.052F),
          skin.head.part(0, 0, 1, 0.2F), 8);
  addLimb(mesh, up(0.445F), up(0.385F), axes(0.043F, 0.052F), axes(0.044F, 0.054F),
          skin.head.part(0, 0.2F, 1, 0.6F), 8);
  addLimb(mesh, up(0.385F), up(0.335F), axes(0.044F, 0.054F), axes(0.028F, 0.034F),
          skin.head.part(0, 0.6F, 1, 1), 8);
  if (bag) {
    const Vector3f back(-0.085F * height, 0, 0);
    addLimb(mesh, up(0.26F) + back, up(0.06F) + back, axes(0.075F, 0.045F), axes(0.08F, 0.055F),
            skin.bag, 6);
  }
}

void addWheel(Mesh& mesh, float x, float radius, const UvRect& uv) {
  constexpr int kSpans = 14;
  for (int i = 0; i < kSpans; ++i) {
    const float a = 2.0F * kPi * static_cast<float>(i) / kSpans;
    const float b = 2.0F * kPi * static_cast<float>(i + 1) / kSpans;
    const auto at = [&](float angle, float r) {
      return Vector3f(x + r * std::cos(angle), 0, radius + r * std::sin(angle));
    };
    const float inner = radius - 0.05F;
    mesh.addQuad(at(a, radius), at(b, radius), at(b, inner), at(a, inner), uv);
  }
}

void addFrame(Mesh& mesh, const UvRect& uv) {
  const Vector3f rear(-0.55F, 0, 0.34F), front(0.55F, 0, 0.34F), pedals(-0.05F, 0, 0.3F),
      seat(-0.25F, 0, 0.9F), bars(0.42F, 0, 0.95F);
  const Eigen::Vector2f thin(0.02F, 0.02F);
  for (const auto& [a, b] : {std::pair{rear, pedals},
                             {pedals, seat},
                             {rear, seat},
                             {pedals, bars},
                             {seat, bars},
                             {front, bars}}) {
    addLimb(mesh, a, b, thin, thin, uv, 4);
  }
  mesh.addQuad({0.4F, 0.28F, 0.97F}, {0.4F, -0.28F, 0.97F}, {0.45F, -0.28F, 0.93F},
               {0.45F, 0.28F, 0.93F}, uv);
}

/// A box, x forward, its lower middle at `foot`.
void addBox(Mesh& mesh, const Vector3f& foot, const Vector3f& size, const UvRect& uv) {
  const auto corner = [&](float x, float y, float z) {
    return Vector3f(foot + Vector3f(x, y, z).cwiseProduct(size));
  };
  for (const float side : {-0.5F, 0.5F}) {
    mesh.addQuad(corner(side, -0.5F, 1), corner(side, 0.5F, 1), corner(side, 0.5F, 0),
                 corner(side, -0.5F, 0), uv);
    mesh.addQuad(corner(-0.5F, side, 1), corner(0.5F, side, 1), corner(0.5F, side, 0),
                 corner(-0.5F, side, 0), uv);
    mesh.addQuad(corner(-0.5F, -0.5F, side + 0.5F), corner(0.5F, -0.5F, side + 0.5F),
                 corner(0.5F, 0.5F, side + 0.5F), corner(-0.5F, 0.5F, side + 0.5F), uv);
  }
}

/// A box before the chest, or a trolley before the hips.
void addLoad(Mesh& mesh, const PersonBody& body, float height, const PersonSkin& skin) {
  if (body.load == PersonBody::Load::kCarried) {
    addBox(mesh, {0.32F, 0, 0.5F * height}, {0.35F, 0.45F, 0.3F}, skin.bag);
  } else if (body.load == PersonBody::Load::kPushed) {
    addBox(mesh, {0.75F, 0, 0.15F}, {0.8F, 0.5F, 0.35F + 0.2F * height}, skin.bag);
    addBox(mesh, {0.35F, 0, 0.95F}, {0.04F, 0.5F, 0.04F}, skin.shoes);
  }
}

/// Makes a body broader or slimmer.
void widen(Mesh& mesh, double girth) {
  for (auto& triangle : mesh.triangles) {
    for (auto& vertex : triangle) vertex.position.y() *= static_cast<float>(girth);
  }
}

}  // namespace

Mesh personMesh(const Actor& actor) {
  const PersonSkin skin = personSkin(actor.look);
  const auto height = static_cast<float>(actor.size.z());
  const auto phase = static_cast<float>(actor.gait);
  const float amount = std::min(1.3F, static_cast<float>(actor.speed) / 1.35F);
  const auto swing = [&](float at) {
    Swing s;
    s.hip = 0.06F * amount + 0.44F * amount * std::sin(at);
    s.knee = amount * (0.12F + 0.85F * std::max(0.0F, std::sin(at + 1.9F)) *
                                   std::max(0.0F, std::sin(at + 1.9F)));
    s.shoulder = -0.42F * amount * std::sin(at);
    s.elbow = 0.15F + 0.3F * amount;
    return s;
  };
  const Swing left = swing(phase), right = swing(phase + kPi);
  // The hips sink as the legs spread.
  const float spread = 0.44F * amount * std::abs(std::sin(phase));
  const Vector3f hips(0, 0, height * (0.515F - 0.48F * (1.0F - std::cos(spread))));
  Mesh mesh;
  addLeg(mesh, hips + Vector3f(0, 0.05F * height, 0), height, left, skin);
  addLeg(mesh, hips - Vector3f(0, 0.05F * height, 0), height, right, skin);
  const float lean = 0.05F * amount + static_cast<float>(actor.body.bend_rad);
  const Vector3f shoulders = hips + 0.265F * height * Vector3f(std::sin(lean), 0, std::cos(lean));
  const auto arm = [&](Swing s) {
    if (actor.body.load == PersonBody::Load::kNone) return s;
    s.shoulder = 0.5F;
    s.elbow = 0.9F;
    return s;
  };
  addArm(mesh, shoulders + Vector3f(0, 0.135F * height, 0), height, arm(left), skin);
  addArm(mesh, shoulders - Vector3f(0, 0.135F * height, 0), height, arm(right), skin);
  addTrunk(mesh, hips, height, lean, skin, actor.look % 3 == 0);
  widen(mesh, actor.body.girth);
  addLoad(mesh, actor.body, height, skin);
  return mesh;
}

Mesh bicycleMesh(int look) {
  const PersonSkin skin = personSkin(look);
  Mesh mesh;
  addWheel(mesh, -0.55F, 0.34F, skin.shoes);
  addWheel(mesh, 0.55F, 0.34F, skin.shoes);
  addFrame(mesh, skin.bag);
  return mesh;
}

Mesh seatedMesh(const Actor& actor) {
  const PersonSkin skin = personSkin(actor.look);
  constexpr float kSeat = 0.5F;  // hips above the ground [m]
  // From hips to the top of the head it is 0.47 of the stature.
  const float height = (static_cast<float>(actor.size.z()) - kSeat) / 0.47F;
  const Vector3f hips(-0.2F, 0, kSeat);
  Mesh mesh;
  for (const float side : {1.0F, -1.0F}) {
    Swing s;
    s.hip = 1.45F;
    s.knee = 1.45F;
    addLeg(mesh, hips + Vector3f(0, side * 0.055F * height, 0), height, s, skin);
    s.shoulder = 0.35F;
    s.elbow = 0.9F;
    const Vector3f shoulder = hips + Vector3f(0, side * 0.135F * height, 0.265F * height);
    addArm(mesh, shoulder, height, s, skin);
  }
  addTrunk(mesh, hips, height, -0.05F, skin, false);
  widen(mesh, actor.body.girth);
  if (!actor.body.wheelchair) return mesh;
  addBox(mesh, {-0.2F, 0, 0.4F}, {0.45F, 0.45F, 0.06F}, skin.bag);
  addBox(mesh, {-0.42F, 0, 0.46F}, {0.04F, 0.45F, 0.45F}, skin.bag);
  for (const float side : {0.28F, -0.28F}) {
    Mesh wheel;
    addWheel(wheel, -0.25F, 0.3F, skin.shoes);
    mesh.append(moved(wheel, Eigen::Matrix3f::Identity(), {0, side, 0}));
  }
  return mesh;
}

Mesh cyclistMesh(const Actor& actor) {
  const PersonSkin skin = personSkin(actor.look);
  constexpr float kRider = 1.62F;  // a leaning rider is lower than a standing one
  Mesh mesh = bicycleMesh(actor.look);
  const Vector3f hips(-0.22F, 0, 0.98F);
  const auto phase = static_cast<float>(actor.gait);
  for (const float side : {1.0F, -1.0F}) {
    const float at = phase + (side > 0 ? 0.0F : kPi);
    Swing s;
    s.hip = 0.85F + 0.35F * std::sin(at);
    s.knee = 1.15F + 0.45F * std::sin(at + 0.5F);
    addLeg(mesh, hips + Vector3f(0, side * 0.08F, 0), kRider, s, skin);
    s.shoulder = 0.95F;
    s.elbow = 0.25F;
    const Vector3f shoulder = hips + 0.26F * kRider * Vector3f(std::sin(0.45F), 0, std::cos(0.45F));
    addArm(mesh, shoulder + Vector3f(0, side * 0.2F, 0), kRider, s, skin);
  }
  addTrunk(mesh, hips, kRider, 0.4F, skin, actor.look % 3 == 0);
  const float scale = static_cast<float>(actor.size.z()) / 1.7F;
  for (auto& triangle : mesh.triangles) {
    for (auto& vertex : triangle) vertex.position.z() *= scale;
  }
  return mesh;
}

namespace {

/// In the actor's own frame.
Mesh ownMesh(const Actor& actor) {
  switch (actor.kind) {
    case ActorKind::kPedestrian:
      return personMesh(actor);
    case ActorKind::kSeatedPerson:
      return seatedMesh(actor);
    case ActorKind::kCyclist:
      return cyclistMesh(actor);
    case ActorKind::kBicycle:
      return bicycleMesh(actor.look);
    case ActorKind::kForklift:
      return forkliftMesh(actor);
    case ActorKind::kDeliveryRobot:
      return deliveryRobotMesh(actor);
    case ActorKind::kCar:
    case ActorKind::kVan:
    case ActorKind::kTruck:
    case ActorKind::kBus:
      break;
  }
  return vehicleMesh(actor);
}

}  // namespace

Mesh actorMesh(const Actor& actor, const Eigen::Vector3d& origin) {
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(actor.yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return moved(ownMesh(actor), turn.cast<float>(), (actor.position - origin).cast<float>());
}

std::vector<Mesh> actorMeshes(const std::vector<Actor>& actors, const Eigen::Vector3d& origin) {
  std::vector<Mesh> meshes;
  meshes.reserve(actors.size());
  for (const Actor& actor : actors) meshes.push_back(actorMesh(actor, origin));
  return meshes;
}

}  // namespace headway::sim
