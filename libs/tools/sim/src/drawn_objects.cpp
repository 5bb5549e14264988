// SPDX-License-Identifier: BSD-3-Clause
// OpenGL objects of a scene: textured meshes, actors and their shadows.
#define GL_GLEXT_PROTOTYPES

#include "drawn_objects.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <algorithm>
#include <cmath>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "actor_atlas.h"

namespace headway::sim {

TexturedObject::TexturedObject(const cv::Mat& picture) {
  if (picture.channels() == 4) {
    std::vector<cv::Mat> planes;
    cv::split(picture, planes);
    cv::Mat colour;
    cv::merge(std::vector<cv::Mat>{planes[0], planes[1], planes[2]}, colour);
    assignImage(mrpt::img::CImage(colour, mrpt::img::DEEP_COPY),
                mrpt::img::CImage(planes[3], mrpt::img::DEEP_COPY));
  } else {
    assignImage(mrpt::img::CImage(picture, mrpt::img::DEEP_COPY));
  }
  enableLight(false);
  enableTextureLinearInterpolation(true);
}

void TexturedObject::setMeshes(const std::vector<const Mesh*>& meshes) {
  std::unique_lock<std::shared_mutex> lock(m_trianglesMtx.data);
  std::size_t count = 0;
  for (const Mesh* mesh : meshes) count += mesh->triangles.size();
  m_triangles.resize(count);
  auto triangle = m_triangles.begin();
  for (const Mesh* mesh : meshes) {
    for (const auto& source : mesh->triangles) {
      for (std::size_t i = 0; i < 3; ++i) {
        auto& vertex = triangle->vertices[i];
        vertex.xyzrgba.pt = {source[i].position.x(), source[i].position.y(),
                             source[i].position.z()};
        vertex.setColor(mrpt::img::TColor(255, 255, 255, 255));
        vertex.normal = {0.0F, 0.0F, 1.0F};
        vertex.uv = {source[i].uv.x(), source[i].uv.y()};
      }
      ++triangle;
    }
  }
  CRenderizable::notifyChange();
}

void TexturedObject::placeAt(const Eigen::Vector3d& at, const Eigen::Vector3d& forward,
                             double order) {
  setLocation(at.x(), at.y(), at.z());
  const Eigen::Vector3f point = (forward * order - at).cast<float>();
  setLocalRepresentativePoint({point.x(), point.y(), point.z()});
}

void TexturedObject::render(const RenderContext& context) const {
  if (hides_backs_) {
    glFrontFace(GL_CW);
    glEnable(GL_CULL_FACE);
  }
  CSetOfTexturedTriangles::render(context);
  glDisable(GL_CULL_FACE);
}

void TexturedObject::initializeTextures() const {
  mrpt::opengl::CSetOfTexturedTriangles::initializeTextures();
  if (has_mipmaps_) return;
  // The base class leaves its texture bound.
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  has_mipmaps_ = true;
}

cv::Mat drawShadow() {
  constexpr int kSize = 64;  // [px]
  cv::Mat picture(kSize, kSize, CV_8UC4);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      const double dx = std::abs((x + 0.5) / kSize - 0.5) * 2.0;
      const double dy = std::abs((y + 0.5) / kSize - 0.5) * 2.0;
      const double away = std::pow(std::pow(dx, 4) + std::pow(dy, 4), 0.25);
      const double dark = std::clamp((1.0 - away) / 0.3, 0.0, 1.0);
      picture.at<cv::Vec4b>(y, x) = {12, 12, 12,
                                     static_cast<uchar>(190.0 * dark * dark * (3.0 - 2.0 * dark))};
    }
  }
  return picture;
}

Mesh shadowMesh(const Actor& actor, const Eigen::Vector3d& origin) {
  const bool walks = isPerson(actor.kind);
  const double grow_l = walks ? 1.0 : 1.2, grow_w = walks ? 1.3 : 1.5;
  const Eigen::Vector3f foot =
      (actor.position - origin + Eigen::Vector3d(0, 0, 0.025)).cast<float>();
  const auto c = static_cast<float>(std::cos(actor.yaw)),
             s = static_cast<float>(std::sin(actor.yaw));
  const Eigen::Vector3f ex =
      static_cast<float>(0.5 * grow_l * actor.size.x()) * Eigen::Vector3f(c, s, 0);
  const Eigen::Vector3f ey =
      static_cast<float>(0.5 * grow_w * actor.size.y()) * Eigen::Vector3f(-s, c, 0);
  Mesh mesh;
  mesh.addQuad(foot + ex + ey, foot - ex + ey, foot - ex - ey, foot + ex - ey, UvRect{});
  return mesh;
}

ActorLayer::ActorLayer(mrpt::opengl::COpenGLScene& scene, const Grain& grain, Random& random) {
  const cv::Mat atlas = drawActorAtlas(grain, random);
  vehicles_ = std::make_shared<TexturedObject>(atlas);
  vehicles_->hideBacks();
  people_ = std::make_shared<TexturedObject>(atlas);
  shadows_ = std::make_shared<TexturedObject>(drawShadow());
  for (const auto& object : {vehicles_, people_, shadows_}) scene.insert(object);
}

void ActorLayer::show(const std::vector<Actor>& actors, const std::vector<Mesh>& meshes,
                      const Eigen::Vector3d& origin,
                      const std::function<bool(const Mesh&)>& shows) {
  std::vector<std::pair<double, std::size_t>> near_first;
  for (std::size_t k = 0; k < actors.size(); ++k) {
    near_first.emplace_back((actors[k].position - origin).norm(), k);
  }
  std::sort(near_first.begin(), near_first.end());
  std::vector<const Mesh*> vehicles, people;
  for (const auto& [distance, k] : near_first) {
    if (!shows(meshes[k])) continue;
    (isClosed(actors[k].kind) ? vehicles : people).push_back(&meshes[k]);
  }
  Mesh shadows;
  Eigen::Vector3d below = origin;
  for (const Actor& actor : actors) {
    shadows.append(shadowMesh(actor, below));
    below.z() -= shadow_step_m_;
  }
  vehicles_->setMeshes(vehicles);
  people_->setMeshes(people);
  shadows_->setMesh(shadows);
}

void ActorLayer::place(const Eigen::Vector3d& forward) {
  vehicles_->placeAt(Eigen::Vector3d::Zero(), forward, 6000.0);
  people_->placeAt(Eigen::Vector3d::Zero(), forward, 5900.0);
  shadows_->placeAt(Eigen::Vector3d::Zero(), forward, 0.0);
}

}  // namespace headway::sim
