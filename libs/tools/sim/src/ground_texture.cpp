// SPDX-License-Identifier: BSD-3-Clause
#include "ground_texture.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "random_draws.h"
#include "street_profile.h"

namespace headway::sim {
namespace {

using Profile = StreetProfile;

/// Pixels of the ground texture, addressed in metres along and to the left.
class GroundCanvas {
 public:
  GroundCanvas(double length, cv::Mat& picture)
      : px_per_m_u_(kGroundTexture / length), picture_(picture) {}

  [[nodiscard]] cv::Point at(double along, double left) const {
    return {static_cast<int>(std::lround(along * px_per_m_u_)),
            static_cast<int>(std::lround(groundTextureV(left) * kGroundTexture))};
  }
  void rectangle(double a0, double left0, double a1, double left1, const cv::Scalar& colour) {
    cv::rectangle(picture_, at(a0, left0), at(a1, left1), colour, cv::FILLED);
  }
  void blend(double a0, double left0, double a1, double left1, const cv::Scalar& colour,
             double ratio) {
    const cv::Rect area =
        cv::Rect(at(a0, left0), at(a1, left1)) & cv::Rect(0, 0, picture_.cols, picture_.rows);
    if (area.empty()) return;
    cv::Mat part = picture_(area);
    cv::addWeighted(part, 1.0 - ratio, cv::Mat(part.size(), part.type(), colour), ratio, 0, part);
  }
  cv::Mat& picture() { return picture_; }

 private:
  double px_per_m_u_;
  cv::Mat& picture_;
};

cv::Scalar grey(double level, Random& random) {
  return {level + random.uniform(-4, 4), level + random.uniform(-3, 3),
          level + random.uniform(-4, 4)};
}

void drawPavement(GroundCanvas& canvas, double length, double side, Random& random) {
  const double base = random.uniform(125, 165);
  const double slab = random.chance(0.5) ? 0.4 : 0.6;
  for (double a = 0.0; a < length - 1e-6; a += slab) {
    for (double d = Profile::kCarriageway + 0.15; d < Profile::kEdge; d += slab) {
      canvas.rectangle(a, side * d, a + slab, side * (d + slab),
                       grey(base + 7.0 * random.normal(), random));
    }
  }
  const cv::Scalar joint = cv::Scalar::all(base - 45);
  for (double a = 0.0; a <= length; a += slab) {
    cv::line(canvas.picture(), canvas.at(a, side * Profile::kCarriageway),
             canvas.at(a, side * Profile::kEdge), joint, 1);
  }
  for (double d = Profile::kCarriageway + 0.15; d < Profile::kEdge; d += slab) {
    cv::line(canvas.picture(), canvas.at(0, side * d), canvas.at(length, side * d), joint, 1);
  }
  for (double a = 0.0; a < length; a += 1.0) {  // kerb stones
    canvas.rectangle(a + 0.02, side * Profile::kCarriageway, a + 0.98,
                     side * (Profile::kCarriageway + 0.15),
                     grey(175 + 8 * random.normal(), random));
  }
  for (int i = 0; i < 90; ++i) {  // leaves, gum, litter
    const double d = side * random.uniform(Profile::kCarriageway + 0.2, Profile::kEdge);
    const cv::Point at = canvas.at(random.uniform(0, length), d);
    cv::Scalar colour(30);
    if (random.chance(0.5)) {
      colour[2] = random.uniform(80, 190);
      colour[1] = random.uniform(60, 130);
    } else {
      colour = cv::Scalar::all(random.uniform(40, 90));
    }
    const double angle = random.uniform(0, 180);
    cv::ellipse(canvas.picture(), at, {1 + random.below(4), 1 + random.below(2)}, angle, 0, 360,
                colour, cv::FILLED, cv::LINE_AA);
  }
}

void drawCracks(GroundCanvas& canvas, double length, int count, Random& random) {
  for (int i = 0; i < count; ++i) {
    double a = random.uniform(0, length);
    double d = random.uniform(-Profile::kCarriageway, Profile::kCarriageway);
    double heading = random.uniform(0, 2 * M_PI);
    const double level = random.uniform(20, 50);
    const int steps = 4 + random.below(14);
    for (int k = 0; k < steps; ++k) {
      heading += 0.5 * random.normal();
      const double a2 = a + 0.35 * std::cos(heading);
      const double d2 =
          std::clamp(d + 0.35 * std::sin(heading), -Profile::kCarriageway, Profile::kCarriageway);
      cv::line(canvas.picture(), canvas.at(a, d), canvas.at(a2, d2), cv::Scalar::all(level),
               1 + random.below(2), cv::LINE_AA);
      a = a2;
      d = d2;
    }
  }
}

void drawPatches(GroundCanvas& canvas, double length, Random& random) {
  for (int i = 0; i < 7; ++i) {  // repairs
    const double a = random.uniform(0, length), d = random.uniform(-6.4, 5.0);
    const double weight = random.uniform(0.3, 0.7), level = random.uniform(45, 120);
    const double a2 = a + random.uniform(0.5, 4.0), d2 = d + random.uniform(0.4, 1.6);
    canvas.blend(a, d2, a2, d, cv::Scalar::all(level), weight);
  }
  for (int i = 0; i < 5; ++i) {  // covers and drains
    const double d = random.uniform(-5.5, 5.5);
    const cv::Point at = canvas.at(random.uniform(0, length), d);
    const int r = 9 + random.below(7);
    cv::circle(canvas.picture(), at, r + 2, cv::Scalar::all(110), cv::FILLED, cv::LINE_AA);
    cv::circle(canvas.picture(), at, r, cv::Scalar::all(55), cv::FILLED, cv::LINE_AA);
    for (int k = -r + 3; k < r - 2; k += 5) {
      cv::line(canvas.picture(), at + cv::Point(k, -r / 2), at + cv::Point(k, r / 2),
               cv::Scalar::all(95), 1, cv::LINE_AA);
    }
  }
  for (int i = 0; i < 10; ++i) {  // stains
    const double d = random.uniform(-6.2, 6.2);
    const cv::Point at = canvas.at(random.uniform(0, length), d);
    const cv::Size size = cv::Size(8, 6) + cv::Size(drawPoint(28, 18, random));
    cv::Rect area(at.x - 40, at.y - 40, 80, 80);
    area &= cv::Rect(0, 0, kGroundTexture, kGroundTexture);
    if (area.empty()) continue;
    cv::Mat part = canvas.picture()(area);
    cv::Mat darker = part.clone();
    const double level = random.uniform(30, 60);
    cv::ellipse(darker, at - area.tl(), size, random.uniform(0, 180), 0, 360,
                cv::Scalar::all(level), cv::FILLED, cv::LINE_AA);
    cv::addWeighted(part, 0.6, darker, 0.4, 0, part);
  }
}

void drawMarks(GroundCanvas& canvas, const GroundMarks& marks, Random& random) {
  const cv::Scalar white = cv::Scalar::all(random.uniform(195, 225));
  const double zebra = marks.crossing_at * marks.length_m;
  if (marks.centre_line) {
    for (double a = 1.0; a < marks.length_m - 2.0; a += 6.0) {
      if (marks.crossing && std::abs(a + 1.5 - zebra) < 4.5) continue;
      canvas.rectangle(a, 0.07, a + 3.0, -0.07, white);
    }
    for (const double side : {-1.0, 1.0}) {
      for (double a = 0.0; a < marks.length_m; a += 5.5) {  // parking bays
        canvas.blend(a, side * 4.35, a + 0.1, side * 6.35, white, 0.7);
      }
      canvas.blend(0, side * 4.4, marks.length_m, side * 4.3, white, 0.6);
    }
  }
  if (marks.crossing) {
    for (double d = -6.0; d < 6.0; d += 1.0) {
      canvas.rectangle(zebra - 1.8, d + 0.5, zebra + 1.8, d, white);
    }
  }
}

}  // namespace

float groundTextureV(double left) {
  return static_cast<float>(0.5 - 0.5 * left / (Profile::kEdge + 0.1));
}

cv::Mat drawGround(const GroundMarks& marks, const Grain& grain, Random& random) {
  cv::Mat picture(kGroundTexture, kGroundTexture, CV_8UC3,
                  cv::Scalar::all(random.uniform(92, 118)));
  GroundCanvas canvas(marks.length_m, picture);
  drawMarks(canvas, marks, random);
  drawPatches(canvas, marks.length_m, random);
  drawCracks(canvas, marks.length_m, 26, random);
  for (const double side : {-1.0, 1.0}) {
    drawPavement(canvas, marks.length_m, side, random);
    canvas.blend(0, side * 6.4, marks.length_m, side * 6.05, cv::Scalar::all(50), 0.5);  // gutter
  }
  grain.roughen(picture, 13.0, 7.0, random);
  return picture;
}

cv::Mat drawMeadow(const Grain& grain, Random& random) {
  cv::Mat picture(kGroundTexture, kGroundTexture, CV_8UC3, cv::Scalar(58, 104, 88));
  for (int i = 0; i < 6000; ++i) {
    const cv::Point at = drawPoint(kGroundTexture, kGroundTexture, random);
    const double level = random.uniform(0.6, 1.3), angle = random.uniform(0, 180);
    cv::ellipse(picture, at, {1 + random.below(6), 1 + random.below(3)}, angle, 0, 360,
                cv::Scalar(45, 105, 85) * level, cv::FILLED);
  }
  grain.roughen(picture, 12.0, 12.0, random);
  return picture;
}

}  // namespace headway::sim
