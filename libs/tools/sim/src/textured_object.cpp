// SPDX-License-Identifier: BSD-3-Clause
#define GL_GLEXT_PROTOTYPES
#include "textured_object.h"

#include <GL/gl.h>
#include <GL/glext.h>

#include <mutex>
#include <opencv2/imgproc.hpp>

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

}  // namespace headway::sim
