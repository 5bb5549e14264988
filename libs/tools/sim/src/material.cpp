// SPDX-License-Identifier: BSD-3-Clause
#include "material.h"

#include <functional>
#include <map>
#include <opencv2/imgproc.hpp>

#include "random_draws.h"

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

}  // namespace headway::sim
