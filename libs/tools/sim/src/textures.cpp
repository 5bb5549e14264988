// SPDX-License-Identifier: BSD-3-Clause
// Painted pictures of materials, the ground and the sky.
#include "textures.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "grain.h"
#include "route.h"

namespace headway::sim {
namespace {

constexpr int kSide = 1024;  // [px]

/// What is painted over the base colour, before the grain.
using Pattern = std::function<void(cv::Mat&, Random&)>;

struct Recipe {
  double size_m;        // that the picture covers
  cv::Scalar colour;    // BGR
  double fine, coarse;  // grain [grey levels]
  Pattern pattern;      // may be empty
};

cv::Point anywhere(Random& random) {
  const int x = random.below(kSide);
  return {x, random.below(kSide)};
}

/// Specks of other colours, such as chips in linoleum, grit in asphalt or fibres in carpet.
Pattern specks(int count, int radius, double contrast) {
  return [=](cv::Mat& picture, Random& random) {
    const cv::Scalar base = cv::mean(picture);
    for (int i = 0; i < count; ++i) {
      const cv::Point at = anywhere(random);
      const double level = 1.0 + contrast * random.normal();
      const double angle = random.uniform(0, 180);
      cv::ellipse(picture, at, {1 + random.below(radius), 1 + random.below(radius)}, angle, 0, 360,
                  base * level, cv::FILLED);
    }
  };
}

/// Scuffs, stains and scratches of use.
void addWear(cv::Mat& picture, int count, double contrast, Random& random) {
  const cv::Scalar base = cv::mean(picture);
  for (int i = 0; i < count; ++i) {
    const cv::Point at = anywhere(random);
    const double angle = random.uniform(0, 2 * M_PI), length = random.uniform(8, 90);
    const cv::Point to = at + cv::Point(static_cast<int>(length * std::cos(angle)),
                                        static_cast<int>(length * std::sin(angle)));
    const int thickness = 1 + random.below(2);
    cv::line(picture, at, to, base * (1.0 - contrast * random.uniform()), thickness, cv::LINE_AA);
  }
}

Pattern wear(int count, double contrast) {
  return [=](cv::Mat& picture, Random& random) { addWear(picture, count, contrast, random); };
}

Pattern both(const Pattern& first, const Pattern& second) {
  return [=](cv::Mat& picture, Random& random) {
    first(picture, random);
    second(picture, random);
  };
}

/// Rows of rectangular pieces with joints: slabs, bricks, ceiling tiles, boxes.
Pattern pieces(int width, int height, int joint, double variation, double joint_level,
               bool staggered) {
  return [=](cv::Mat& picture, Random& random) {
    const cv::Scalar base = cv::mean(picture);
    picture.setTo(base * joint_level);
    int row = 0;
    for (int y = 0; y < kSide; y += height, ++row) {
      const int shift = staggered && row % 2 == 1 ? width / 2 : 0;
      for (int x = -shift; x < kSide; x += width) {
        const cv::Scalar tone = base * (1.0 + variation * random.normal());
        cv::rectangle(picture, {x, y}, {x + width - joint - 1, y + height - joint - 1}, tone,
                      cv::FILLED);
        if (x < 0) {  // the other half of a piece that the edge cuts
          cv::rectangle(picture, {x + kSide, y}, {x + kSide + width - joint, y + height - joint},
                        tone, cv::FILLED);
        }
      }
    }
  };
}

/// Boards with grain along them.
Pattern boards(int height, double variation) {
  return [=](cv::Mat& picture, Random& random) {
    const cv::Scalar base = cv::mean(picture);
    for (int y = 0; y < kSide; y += height) {
      const cv::Scalar tone = base * (1.0 + variation * random.normal());
      picture.rowRange(y, std::min(y + height, kSide)).setTo(tone);
      for (int i = 0; i < height / 2; ++i) {
        const int at = y + random.below(height), from = random.below(kSide);
        const double level = random.uniform(0.75, 1.15);
        cv::line(picture, {from, at}, {from + random.below(700), at + random.below(5) - 2},
                 tone * level, 1, cv::LINE_AA);
      }
      cv::line(picture, {0, y}, {kSide, y}, base * 0.4, 2);
    }
  };
}

void paintBooks(cv::Mat& picture, Random& random) {
  for (int y = 0; y < kSide; y += 128) {
    for (int x = 0; x < kSide;) {
      const int width = 10 + random.below(26), top = random.below(30);
      const double red = random.uniform(20, 220), green = random.uniform(20, 200);
      const cv::Scalar colour(random.uniform(20, 200), green, red);
      cv::rectangle(picture, {x, y + top}, {x + width - 2, y + 120}, colour, cv::FILLED);
      cv::rectangle(picture, {x + 3, y + top + 20}, {x + width - 5, y + top + 34}, colour * 1.6,
                    cv::FILLED);
      x += width;
    }
    cv::rectangle(picture, {0, y + 120}, {kSide, y + 127}, cv::Scalar(60, 90, 120), cv::FILLED);
  }
}

void paintNotices(cv::Mat& picture, Random& random) {
  for (int i = 0; i < 16; ++i) {
    const cv::Rect place((i % 4) * 256, (i / 4) * 256, 256, 256);
    cv::Mat notice = picture(place);
    const cv::Scalar paper = drawColour(120, 250, random);
    notice.setTo(paper);
    const double level = random.uniform(0.2, 0.8);
    cv::rectangle(notice, {16, 16}, {240, 60 + random.below(90)}, paper * level, cv::FILLED);
    for (int k = 0; k < 10; ++k) {
      const int y = 130 + 11 * k;
      cv::line(notice, {20, y}, {60 + random.below(180), y}, cv::Scalar::all(50), 3);
    }
    cv::putText(notice, std::to_string(100 + random.below(900)), {30, 110}, cv::FONT_HERSHEY_DUPLEX,
                2.0, cv::Scalar::all(random.chance(0.5) ? 20 : 240), 4, cv::LINE_AA);
  }
}

void paintCartons(cv::Mat& picture, Random& random) {
  pieces(256, 205, 4, 0.12, 0.4, false)(picture, random);
  for (int y = 0; y < kSide; y += 205) {
    for (int x = 0; x < kSide; x += 256) {
      cv::line(picture, {x + 128, y}, {x + 128, y + 200}, cv::Scalar(140, 180, 205), 12);  // tape
      const cv::Point label = cv::Point(x + 20, y + 60) + drawPoint(60, 60, random);
      cv::rectangle(picture, label, label + cv::Point(70, 45), cv::Scalar::all(225), cv::FILLED);
      for (int k = 0; k < 6; ++k) {
        const cv::Point bar = label + cv::Point(6 + 10 * k, 8);
        cv::line(picture, bar, bar + cv::Point(0, 24), cv::Scalar::all(30), 1 + random.below(5));
      }
    }
  }
}

void paintStripes(cv::Mat& picture, Random&) {
  for (int x = -kSide; x < kSide; x += 256) {
    const std::vector<cv::Point> stripe = {
        {x, kSide}, {x + 128, kSide}, {x + 128 + kSide, 0}, {x + kSide, 0}};
    cv::fillConvexPoly(picture, stripe, cv::Scalar(30, 30, 30));
  }
}

void paintScreen(cv::Mat& picture, Random& random) {
  for (int i = 0; i < 60; ++i) {
    const cv::Point at = anywhere(random);
    const cv::Scalar colour = drawColour(60, 250, random);
    const cv::Point size = cv::Point(40, 20) + drawPoint(260, 90, random);
    cv::rectangle(picture, at, at + size, colour, cv::FILLED);
  }
}

/// Corrugation: light and shade in vertical ribs.
void paintRibs(cv::Mat& picture, Random& random) {
  const cv::Scalar base = cv::mean(picture);
  for (int x = 0; x < kSide; ++x) {
    picture.col(x).setTo(base * (1.0 + 0.18 * std::sin(2.0 * M_PI * x / 64.0)));
  }
  addWear(picture, 60, 0.3, random);
}

const std::map<Material, Recipe>& recipes() {
  static const std::map<Material, Recipe> kRecipes = {
      {Material::kLinoleum,
       {3.0, {135, 150, 155}, 3.0, 5.0, both(specks(9000, 4, 0.12), wear(140, 0.35))}},
      {Material::kCarpet, {2.5, {105, 85, 80}, 11.0, 6.0, specks(20000, 3, 0.15)}},
      {Material::kConcrete,
       {5.0, {130, 135, 138}, 5.0, 11.0, both(specks(3000, 3, 0.15), wear(260, 0.4))}},
      {Material::kAsphalt, {4.0, {82, 82, 84}, 11.0, 7.0, specks(9000, 3, 0.3)}},
      {Material::kPaving, {3.2, {150, 156, 160}, 6.0, 6.0, pieces(128, 128, 3, 0.06, 0.6, true)}},
      {Material::kGrass, {4.0, {45, 105, 80}, 13.0, 10.0, specks(16000, 5, 0.3)}},
      {Material::kPlaster, {5.0, {205, 210, 212}, 1.5, 3.0, wear(40, 0.15)}},
      {Material::kColouredPlaster, {5.0, {150, 185, 205}, 1.5, 3.5, wear(40, 0.15)}},
      {Material::kBrick, {2.6, {75, 95, 150}, 8.0, 6.0, pieces(85, 32, 3, 0.13, 1.25, true)}},
      {Material::kSheetMetal, {4.0, {165, 160, 150}, 2.0, 4.0, paintRibs}},
      {Material::kCeiling,
       {2.4, {215, 218, 220}, 4.0, 2.0, pieces(256, 256, 5, 0.015, 0.7, false)}},
      {Material::kLamp, {1.0, {250, 250, 250}, 0.0, 0.0, {}}},
      {Material::kWood, {1.2, {95, 145, 185}, 4.0, 4.0, boards(256, 0.06)}},
      {Material::kDarkWood, {1.2, {45, 70, 100}, 4.0, 4.0, boards(512, 0.06)}},
      {Material::kPallet, {1.2, {110, 150, 175}, 7.0, 8.0, boards(102, 0.12)}},
      {Material::kCardboard, {2.0, {100, 145, 180}, 3.0, 5.0, paintCartons}},
      {Material::kFabric, {0.8, {125, 80, 55}, 12.0, 6.0, specks(9000, 4, 0.15)}},
      {Material::kSteel, {1.5, {150, 150, 152}, 3.0, 5.0, wear(160, 0.3)}},
      {Material::kBlueSteel, {1.5, {140, 75, 35}, 3.0, 5.0, wear(160, 0.4)}},
      {Material::kOrangeSteel, {1.5, {30, 105, 225}, 3.0, 5.0, wear(160, 0.4)}},
      {Material::kBlackPlastic, {0.8, {45, 44, 42}, 4.0, 4.0, wear(80, 0.5)}},
      {Material::kWhiteboard, {2.5, {235, 235, 235}, 0.8, 1.5, wear(50, 0.7)}},
      {Material::kBooks, {2.2, {40, 55, 70}, 3.0, 3.0, paintBooks}},
      {Material::kNotices, {1.6, {200, 200, 200}, 2.0, 2.0, paintNotices}},
      {Material::kScreen, {0.6, {90, 60, 30}, 1.0, 1.0, paintScreen}},
      {Material::kHazardStripes, {0.8, {40, 200, 235}, 5.0, 8.0, paintStripes}},
      {Material::kWhitePaint, {2.0, {215, 218, 218}, 6.0, 12.0, wear(200, 0.4)}},
      {Material::kYellowPaint, {2.0, {55, 195, 225}, 6.0, 12.0, wear(200, 0.4)}},
      {Material::kSoil, {2.0, {55, 75, 95}, 14.0, 9.0, specks(9000, 5, 0.3)}}};
  return kRecipes;
}

}  // namespace

double pictureSize(Material material) { return recipes().at(material).size_m; }

cv::Mat drawMaterial(Material material, const Grain& grain, Random& random) {
  const Recipe& recipe = recipes().at(material);
  cv::Mat picture(kSide, kSide, CV_8UC3, recipe.colour);
  if (recipe.pattern) recipe.pattern(picture, random);
  grain.roughen(picture, recipe.fine, recipe.coarse, random);
  return picture;
}

namespace {

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
    for (double d = kStreet.carriageway + 0.15; d < kStreet.edge; d += slab) {
      canvas.rectangle(a, side * d, a + slab, side * (d + slab),
                       grey(base + 7.0 * random.normal(), random));
    }
  }
  const cv::Scalar joint = cv::Scalar::all(base - 45);
  for (double a = 0.0; a <= length; a += slab) {
    cv::line(canvas.picture(), canvas.at(a, side * kStreet.carriageway),
             canvas.at(a, side * kStreet.edge), joint, 1);
  }
  for (double d = kStreet.carriageway + 0.15; d < kStreet.edge; d += slab) {
    cv::line(canvas.picture(), canvas.at(0, side * d), canvas.at(length, side * d), joint, 1);
  }
  for (double a = 0.0; a < length; a += 1.0) {  // kerb stones
    canvas.rectangle(a + 0.02, side * kStreet.carriageway, a + 0.98,
                     side * (kStreet.carriageway + 0.15), grey(175 + 8 * random.normal(), random));
  }
  for (int i = 0; i < 90; ++i) {  // leaves, gum, litter
    const double d = side * random.uniform(kStreet.carriageway + 0.2, kStreet.edge);
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
    double d = random.uniform(-kStreet.carriageway, kStreet.carriageway);
    double heading = random.uniform(0, 2 * M_PI);
    const double level = random.uniform(20, 50);
    const int steps = 4 + random.below(14);
    for (int k = 0; k < steps; ++k) {
      heading += 0.5 * random.normal();
      const double a2 = a + 0.35 * std::cos(heading);
      const double d2 =
          std::clamp(d + 0.35 * std::sin(heading), -kStreet.carriageway, kStreet.carriageway);
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
  return static_cast<float>(0.5 - 0.5 * left / (kStreet.edge + 0.1));
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

namespace {

constexpr int kSkyWidth = 2048, kSkyHeight = 512;  // [px]
constexpr int kHorizonRow = 400;                   // row of the horizon
constexpr float kTopElevation = 1.1F;              // [rad] of the picture's upper edge

/// Wraps around without a seam: noise on a torus, one octave.
void addClouds(cv::Mat& density, int cells, double amount, Random& random) {
  cv::Mat coarse(std::max(2, cells / 3), cells, CV_32F);
  for (int y = 0; y < coarse.rows; ++y) {
    for (int x = 0; x < coarse.cols; ++x) {
      coarse.at<float>(y, x) = static_cast<float>(amount * random.uniform(-1, 1));
    }
  }
  cv::Mat wrapped;
  cv::copyMakeBorder(coarse, wrapped, 0, 0, 2, 2, cv::BORDER_WRAP);
  const double scale = static_cast<double>(kSkyWidth) / cells;
  cv::resize(wrapped, wrapped, {static_cast<int>((cells + 4) * scale), kSkyHeight}, 0, 0,
             cv::INTER_CUBIC);
  density += wrapped(cv::Rect(static_cast<int>(2 * scale), 0, kSkyWidth, kSkyHeight));
}

void drawSkyline(cv::Mat& picture, Random& random) {
  double height = 20.0;
  for (int x = 0; x < kSkyWidth; ++x) {  // wooded hills
    height = std::fmin(34.0, std::fmax(6.0, height + 0.9 * random.normal()));
    // The end meets the beginning.
    const double blend = x > kSkyWidth - 100 ? (kSkyWidth - x) / 100.0 : 1.0;
    const int top = kHorizonRow - static_cast<int>(blend * height + (1 - blend) * 20.0);
    const double level = random.uniform(0.85, 1.1);
    cv::line(picture, {x, top}, {x, kSkyHeight - 1}, cv::Scalar(118, 128, 115) * level, 1);
  }
  for (int i = 0; i < 90; ++i) {  // far roofs and towers
    const int x = random.below(kSkyWidth), w = 6 + random.below(24), h = 8 + random.below(40);
    const cv::Scalar colour = cv::Scalar(140, 140, 145) * random.uniform(0.75, 1.1);
    cv::rectangle(picture, {x, kHorizonRow - h}, {x + w, kSkyHeight - 1}, colour, cv::FILLED);
    for (int k = 0; k < w * h / 40; ++k) {
      cv::rectangle(picture, {x + random.below(w), kHorizonRow - random.below(h)},
                    {x + random.below(w), kHorizonRow - random.below(h)}, colour * 0.8, cv::FILLED);
    }
  }
}

}  // namespace

cv::Mat drawSky(Random& random) {
  cv::Mat density = cv::Mat::zeros(kSkyHeight, kSkyWidth, CV_32F);
  for (int cells = 8; cells <= 256; cells *= 2) {
    addClouds(density, cells, std::pow(cells / 8.0, -0.75), random);
  }
  cv::Mat picture(kSkyHeight, kSkyWidth, CV_8UC3);
  for (int y = 0; y < kSkyHeight; ++y) {
    const float haze = static_cast<float>(y) / kHorizonRow;
    for (int x = 0; x < kSkyWidth; ++x) {
      const float cloud = std::fmin(1.0F, std::fmax(0.0F, 0.5F + 0.7F * density.at<float>(y, x)));
      const float light = cloud * 60.0F;
      auto& pixel = picture.at<cv::Vec3b>(y, x);
      pixel[0] = cv::saturate_cast<uchar>(205.0F + 10.0F * haze + light * 0.4F);
      pixel[1] = cv::saturate_cast<uchar>(165.0F + 40.0F * haze + light * 0.8F);
      pixel[2] = cv::saturate_cast<uchar>(135.0F + 65.0F * haze + light);
    }
  }
  drawSkyline(picture, random);
  cv::GaussianBlur(picture, picture, {3, 3}, 0);
  return picture;
}

Mesh skyMesh(float radius) {
  constexpr int kSpans = 48, kRings = 6;
  // The horizon's row lies at elevation 0; rows are equally spaced in elevation.
  const float bottom = -kTopElevation * static_cast<float>(kSkyHeight - kHorizonRow) / kHorizonRow;
  const auto at = [&](int span, int ring) {
    const float azimuth = 2.0F * static_cast<float>(M_PI) * static_cast<float>(span) / kSpans;
    const float elevation =
        kTopElevation + (bottom - kTopElevation) * static_cast<float>(ring) / kRings;
    return MeshVertex{
        radius * Eigen::Vector3f(std::cos(elevation) * std::cos(azimuth),
                                 -std::cos(elevation) * std::sin(azimuth), std::sin(elevation)),
        {static_cast<float>(span) / kSpans, static_cast<float>(ring) / kRings}};
  };
  Mesh mesh;
  for (int span = 0; span < kSpans; ++span) {
    for (int ring = 0; ring < kRings; ++ring) {
      mesh.addTriangle(at(span, ring), at(span + 1, ring), at(span + 1, ring + 1));
      mesh.addTriangle(at(span, ring), at(span + 1, ring + 1), at(span, ring + 1));
    }
  }
  return mesh;
}

}  // namespace headway::sim
