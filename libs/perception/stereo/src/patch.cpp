// SPDX-License-Identifier: BSD-3-Clause
// Patches around points, aligned between images.
#include <headway/stereo/patch.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>

namespace headway::stereo {
namespace {

constexpr float kHalf = 0.5F * (kPatchSize - 1);  ///< from the centre to the first sample [px]
constexpr int kBordered = kPatchSize + 2;         ///< with a rim for central differences
using Row = Eigen::Array<float, kPatchSize, 1>;

/// Bilinear samples, one pixel apart, of Cols x rows pixels from (u, v) on.
template <int Cols>
void sample(const cv::Mat& image, float u, float v, int rows, float* out) {
  const int u0 = static_cast<int>(u);
  const int v0 = static_cast<int>(v);
  const float fu = u - static_cast<float>(u0);
  const float fv = v - static_cast<float>(v0);
  const float w00 = (1.0F - fu) * (1.0F - fv);
  const float w01 = fu * (1.0F - fv);
  const float w10 = (1.0F - fu) * fv;
  const float w11 = fu * fv;
  const std::size_t stride = image.step[0];
  const std::uint8_t* upper = image.ptr<std::uint8_t>(v0) + u0;
  for (int r = 0; r < rows; ++r, upper += stride, out += Cols) {
    const std::uint8_t* lower = upper + stride;
    for (int c = 0; c < Cols; ++c) {
      out[c] = w00 * static_cast<float>(upper[c]) + w01 * static_cast<float>(upper[c + 1]) +
               w10 * static_cast<float>(lower[c]) + w11 * static_cast<float>(lower[c + 1]);
    }
  }
}

/// Whether samples from (u, v) on, `size` in each direction, have all their neighbours.
bool inside(const cv::Mat& image, float u, float v, int size) {
  return u >= 0.0F && v >= 0.0F && u + static_cast<float>(size) < static_cast<float>(image.cols) &&
         v + static_cast<float>(size) < static_cast<float>(image.rows);
}

/// Values, gradients and normal equations from samples with a rim of one.
Patch patchFrom(const std::array<float, kBordered * kBordered>& samples) {
  Patch patch;
  float sum = 0.0F;
  for (int r = 0; r < kPatchSize; ++r) {
    const float* centre = &samples[(r + 1) * kBordered + 1];
    for (int c = 0; c < kPatchSize; ++c) {
      const int i = r * kPatchSize + c;
      patch.value[i] = centre[c];
      patch.du[i] = 0.5F * (centre[c + 1] - centre[c - 1]);
      patch.dv[i] = 0.5F * (centre[c + kBordered] - centre[c - kBordered]);
      sum += centre[c];
    }
  }
  patch.mean = sum / static_cast<float>(Patch::kArea);
  Eigen::Map<Eigen::Array<float, Patch::kArea, 1>> value(patch.value.data());
  const Eigen::Map<const Eigen::Array<float, Patch::kArea, 1>> du(patch.du.data());
  const Eigen::Map<const Eigen::Array<float, Patch::kArea, 1>> dv(patch.dv.data());
  value -= patch.mean;
  patch.energy = value.square().sum();
  patch.normal << du.square().sum(), (du * dv).sum(), (du * value).sum(), du.sum(),  //
      0, dv.square().sum(), (dv * value).sum(), dv.sum(),                            //
      0, 0, patch.energy, 0,                                                         //
      0, 0, 0, static_cast<float>(Patch::kArea);
  patch.normal.triangularView<Eigen::StrictlyLower>() =
      patch.normal.transpose().triangularView<Eigen::StrictlyLower>();
  return patch;
}

/// Normal matrix inverted, with steps across the row (v) left out where not wanted.
std::optional<Eigen::Matrix4f> solverOf(const Patch& patch, AlignmentAxes axes) {
  constexpr float kMinGradient = 4.0F;  ///< mean squared grey values a pixel
  Eigen::Matrix4f normal = patch.normal;
  if (axes == AlignmentAxes::kRow) {
    normal.row(1).setZero();
    normal.col(1).setZero();
    normal(1, 1) = normal(0, 0);
  }
  const float trace = normal(0, 0) + normal(1, 1);
  const float determinant = normal(0, 0) * normal(1, 1) - normal(0, 1) * normal(0, 1);
  const float smaller =
      0.5F * trace - std::sqrt(std::max(0.0F, 0.25F * trace * trace - determinant));
  if (!(smaller > kMinGradient * static_cast<float>(Patch::kArea))) return std::nullopt;
  Eigen::Matrix4f inverse = normal.inverse();
  if (axes == AlignmentAxes::kRow) inverse(1, 1) = 0.0F;
  return inverse.allFinite() ? std::optional(inverse) : std::nullopt;
}

/// J^T r of the residuals between the samples and the patch under gain and offset.
Eigen::Vector4f gradientOf(const Patch& patch, const float* samples, float gain, float offset) {
  Row sum_du = Row::Zero(), sum_dv = Row::Zero(), sum_value = Row::Zero(), sum = Row::Zero();
  for (int r = 0; r < kPatchSize; ++r) {
    const int i = r * kPatchSize;
    const Eigen::Map<const Row, Eigen::Aligned16> value(&patch.value[i]);
    const Row residual =
        Eigen::Map<const Row, Eigen::Aligned16>(samples + i) - (gain * value + offset);
    sum_du += residual * Eigen::Map<const Row, Eigen::Aligned16>(&patch.du[i]);
    sum_dv += residual * Eigen::Map<const Row, Eigen::Aligned16>(&patch.dv[i]);
    sum_value += residual * value;
    sum += residual;
  }
  return {sum_du.sum(), sum_dv.sum(), sum_value.sum(), sum.sum()};
}

/// Zero-mean normalised cross-correlation of the patch with samples of an image.
double correlation(const Patch& patch, const float* samples) {
  const Eigen::Map<const Eigen::Array<float, Patch::kArea, 1>, Eigen::Aligned16> seen(samples);
  const Eigen::Map<const Eigen::Array<float, Patch::kArea, 1>, Eigen::Aligned16> value(
      patch.value.data());
  const float mean = seen.mean();
  const float energy = (seen - mean).square().sum();
  if (!(energy > 1.0F) || !(patch.energy > 1.0F)) return -1.0;
  return (seen * value).sum() / std::sqrt(energy * patch.energy);
}

}  // namespace

ReferencePatch cutReference(const cv::Mat& image, const Eigen::Vector2d& uv) {
  ReferencePatch patch;
  const int left = static_cast<int>(std::floor(uv.x())) - ReferencePatch::kSize / 2 + 1;
  const int top = static_cast<int>(std::floor(uv.y())) - ReferencePatch::kSize / 2 + 1;
  patch.centre = (uv - Eigen::Vector2d(left, top)).cast<float>();
  for (int r = 0; r < ReferencePatch::kSize; ++r) {
    const auto* row = image.ptr<std::uint8_t>(std::clamp(top + r, 0, image.rows - 1));
    for (int c = 0; c < ReferencePatch::kSize; ++c) {
      patch.pixels[r * ReferencePatch::kSize + c] = row[std::clamp(left + c, 0, image.cols - 1)];
    }
  }
  return patch;
}

std::optional<Patch> cutPatch(const cv::Mat& image, const Eigen::Vector2d& uv) {
  const float u = static_cast<float>(uv.x()) - kHalf - 1.0F;
  const float v = static_cast<float>(uv.y()) - kHalf - 1.0F;
  if (!inside(image, u, v, kBordered)) return std::nullopt;
  std::array<float, kBordered * kBordered> samples;
  sample<kBordered>(image, u, v, kBordered, samples.data());
  return patchFrom(samples);
}

std::optional<Patch> warpPatch(const ReferencePatch& reference,
                               const Eigen::Matrix2d& reference_from_view) {
  const Eigen::Matrix2f warp = reference_from_view.cast<float>();
  const float reach = kHalf + 1.0F;
  const Eigen::Vector2f extent = reach * warp.cwiseAbs().rowwise().sum();
  const Eigen::Vector2f low = reference.centre - extent;
  const Eigen::Vector2f high = reference.centre + extent;
  if (!(low.minCoeff() >= 0.0F &&
        high.maxCoeff() < static_cast<float>(ReferencePatch::kSize - 1))) {
    return std::nullopt;
  }
  std::array<float, kBordered * kBordered> samples;
  float* out = samples.data();
  for (int r = 0; r < kBordered; ++r) {
    Eigen::Vector2f at =
        reference.centre + warp * Eigen::Vector2f(-reach, static_cast<float>(r) - reach);
    for (int c = 0; c < kBordered; ++c, at += warp.col(0)) {
      const int u = static_cast<int>(at.x());
      const int v = static_cast<int>(at.y());
      const float fu = at.x() - static_cast<float>(u);
      const float fv = at.y() - static_cast<float>(v);
      const std::uint8_t* p = &reference.pixels[v * ReferencePatch::kSize + u];
      const float upper = static_cast<float>(p[0]) + fu * static_cast<float>(p[1] - p[0]);
      const float lower =
          static_cast<float>(p[ReferencePatch::kSize]) +
          fu * static_cast<float>(p[ReferencePatch::kSize + 1] - p[ReferencePatch::kSize]);
      *out++ = upper + fv * (lower - upper);
    }
  }
  return patchFrom(samples);
}

std::optional<Alignment> align(const Patch& patch, const cv::Mat& image,
                               const Eigen::Vector2d& start, AlignmentAxes axes,
                               int max_iterations) {
  constexpr float kSmallStep = 0.02F;             ///< [px]
  constexpr float kMaxShift = kPatchSize * 1.5F;  ///< [px]
  const auto solver = solverOf(patch, axes);
  if (!solver) return std::nullopt;
  alignas(16) std::array<float, Patch::kArea> samples;
  const Eigen::Vector2f first = start.cast<float>().array() - kHalf;
  Eigen::Vector2f at = first;
  float gain = 1.0F;
  float offset = patch.mean;
  Alignment result;
  for (int iteration = 0;; ++iteration) {
    if (!at.allFinite() || !inside(image, at.x(), at.y(), kPatchSize)) return std::nullopt;
    if ((at - first).squaredNorm() > kMaxShift * kMaxShift) return std::nullopt;
    sample<kPatchSize>(image, at.x(), at.y(), kPatchSize, samples.data());
    if (result.converged || iteration == max_iterations) break;
    const Eigen::Vector4f step = *solver * gradientOf(patch, samples.data(), gain, offset);
    gain = std::clamp(gain + step(2), 0.3F, 3.0F);
    offset += step(3);
    const Eigen::Vector2f move = step.head<2>() / gain;
    at -= move;
    result.converged = move.squaredNorm() < kSmallStep * kSmallStep;
  }
  result.uv = (at.array() + kHalf).cast<double>();
  result.zncc = correlation(patch, samples.data());
  return result;
}

}  // namespace headway::stereo
