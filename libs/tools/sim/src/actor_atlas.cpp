// SPDX-License-Identifier: BSD-3-Clause
#include "actor_atlas.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "vehicle_paint.h"

namespace headway::sim {
namespace {

// Four columns of vehicles, six rows (three of cars, one each of vans, trucks, buses); below them
// sixteen columns of people, four rows.
constexpr int kAtlas = 2048;  // [px]
constexpr int kVehicleColumns = 4;
constexpr int kPeopleTop = 6 * kVehicleCellHeight;
constexpr int kPersonCell = 128;
constexpr int kPeople = 64;

struct Rows {
  int first;
  int count;
};

Rows rowsOf(ActorKind kind) {
  switch (kind) {
    case ActorKind::kVan:
      return {3, 1};
    case ActorKind::kTruck:
      return {4, 1};
    case ActorKind::kBus:
      return {5, 1};
    default:
      return {0, 3};
  }
}

/// A rectangle of the atlas, a little inside its edges so that neighbours do not bleed in.
UvRect inset(const cv::Rect& rect) {
  constexpr float kMargin = 1.5F;
  const auto ratio = [](float pixels) { return pixels / static_cast<float>(kAtlas); };
  return {ratio(static_cast<float>(rect.x) + kMargin), ratio(static_cast<float>(rect.y) + kMargin),
          ratio(static_cast<float>(rect.x + rect.width) - kMargin),
          ratio(static_cast<float>(rect.y + rect.height) - kMargin)};
}

cv::Rect personPart(int look, int x, int y, int width, int height) {
  const int cell = look % kPeople;
  return {(cell % 16) * kPersonCell + x, kPeopleTop + (cell / 16) * kPersonCell + y, width, height};
}

cv::Scalar clothColour(Random& random) {
  static const std::vector<cv::Scalar> kColours = {
      {40, 40, 45},   {120, 70, 40},  {60, 60, 170},   {200, 200, 205}, {70, 110, 60},
      {90, 90, 90},   {60, 130, 200}, {160, 140, 120}, {130, 60, 110},  {50, 170, 210},
      {100, 60, 150}, {180, 120, 60}, {30, 60, 110}};
  const double level = random.uniform(0.7, 1.25);
  return kColours[static_cast<std::size_t>(random.below(static_cast<int>(kColours.size())))] *
         level;
}

/// Darker towards the lower edge and in vertical folds.
void drape(cv::Mat part, int folds, Random& random) {
  for (int i = 0; i < folds; ++i) {
    const int x = random.below(part.cols), w = 1 + random.below(4);
    cv::Mat fold = part(cv::Rect(x, 0, std::min(w, part.cols - x), part.rows));
    fold.convertTo(fold, -1, random.uniform(0.75, 1.15));
  }
  for (int y = 0; y < part.rows; ++y) {
    cv::Mat row = part.row(y);
    row.convertTo(row, -1, 1.08 - 0.28 * y / part.rows);
  }
}

void drawTorso(cv::Mat part, Random& random) {
  const cv::Scalar cloth = clothColour(random), second = clothColour(random);
  part.setTo(cloth);
  const int pattern = random.below(4);
  if (pattern == 1) {
    for (int y = 4; y < part.rows; y += 10)
      part.rowRange(y, std::min(y + 5, part.rows)).setTo(second);
  } else if (pattern == 2) {  // open jacket: the shirt shows in front
    part.colRange(part.cols * 7 / 16, part.cols * 9 / 16).setTo(second);
  } else if (pattern == 3) {
    cv::rectangle(part, {part.cols * 3 / 8, 10}, {part.cols * 5 / 8, 26}, second, cv::FILLED);
  }
  cv::line(part, {part.cols / 2, 0}, {part.cols / 2, part.rows}, cloth * 0.6, 1);
  part.rowRange(part.rows - 4, part.rows).setTo(cv::Scalar(30, 35, 45));  // belt
  drape(part, 14, random);
}

void drawHead(cv::Mat part, const cv::Scalar& skin, Random& random) {
  static const std::vector<cv::Scalar> kHair = {
      {20, 22, 28}, {35, 50, 75}, {70, 120, 160}, {150, 150, 150}, {30, 45, 100}};
  const cv::Scalar hair = kHair[static_cast<std::size_t>(random.below(5))];
  part.setTo(hair);
  const int hairline = part.rows * 3 / 10;
  cv::rectangle(part, {part.cols * 5 / 16, hairline}, {part.cols * 11 / 16, part.rows}, skin,
                cv::FILLED);
  part.rowRange(part.rows * 3 / 4, part.rows).setTo(skin * 0.9);
  const int eyes = part.rows / 2;
  for (const int side : {-1, 1}) {
    cv::circle(part, {part.cols / 2 + side * part.cols / 16, eyes}, 1, cv::Scalar(30, 30, 40),
               cv::FILLED);
  }
  cv::line(part, {part.cols / 2 - 2, part.rows * 7 / 10}, {part.cols / 2 + 2, part.rows * 7 / 10},
           cv::Scalar(60, 60, 120), 1);
}

void drawPerson(cv::Mat& atlas, int look, Random& random) {
  const double tone = random.uniform(0.45, 1.05);
  const cv::Scalar skin = cv::Scalar(125, 155, 205) * tone;
  drawTorso(atlas(personPart(look, 0, 0, 128, 48)), random);
  cv::Mat trousers = atlas(personPart(look, 0, 48, 64, 40));
  trousers.setTo(clothColour(random) * 0.75);
  drape(trousers, 10, random);
  cv::Mat bare = atlas(personPart(look, 64, 48, 64, 24));
  bare.setTo(skin);
  drape(bare, 3, random);
  atlas(personPart(look, 64, 72, 64, 16)).setTo(cv::Scalar::all(random.uniform(20, 90)));
  drawHead(atlas(personPart(look, 0, 88, 64, 40)), skin, random);
  cv::Mat bag = atlas(personPart(look, 64, 88, 64, 40));
  bag.setTo(clothColour(random));
  cv::rectangle(bag, {10, 14}, {54, 34}, clothColour(random), 2);
  drape(bag, 4, random);
}

}  // namespace

VehicleSkin vehicleSkin(ActorKind kind, int look) {
  const Rows rows = rowsOf(kind);
  const int cell = look % (rows.count * kVehicleColumns);
  const cv::Point origin((cell % kVehicleColumns) * kVehicleCellWidth,
                         (rows.first + cell / kVehicleColumns) * kVehicleCellHeight);
  const auto at = [&](const cv::Rect& rect) { return inset(rect + origin); };
  return {at(kVehicleSide), at(kVehicleTop), at(kVehicleFront), at(kVehicleRear), at(kVehicleDark)};
}

PersonSkin personSkin(int look) {
  return {inset(personPart(look, 0, 0, 128, 48)),  inset(personPart(look, 0, 48, 64, 40)),
          inset(personPart(look, 64, 48, 64, 24)), inset(personPart(look, 64, 72, 64, 16)),
          inset(personPart(look, 0, 88, 64, 40)),  inset(personPart(look, 64, 88, 64, 40))};
}

cv::Mat drawActorAtlas(const Grain& grain, Random& random) {
  cv::Mat atlas(kAtlas, kAtlas, CV_8UC3, cv::Scalar::all(60));
  for (const ActorKind kind :
       {ActorKind::kCar, ActorKind::kVan, ActorKind::kTruck, ActorKind::kBus}) {
    const Rows rows = rowsOf(kind);
    for (int cell = 0; cell < rows.count * kVehicleColumns; ++cell) {
      const cv::Rect place((cell % kVehicleColumns) * kVehicleCellWidth,
                           (rows.first + cell / kVehicleColumns) * kVehicleCellHeight,
                           kVehicleCellWidth, kVehicleCellHeight);
      paintVehicle(atlas(place), kind, random);
    }
  }
  for (int look = 0; look < kPeople; ++look) drawPerson(atlas, look, random);
  grain.roughen(atlas, 5.0, 4.0, random);
  return atlas;
}

}  // namespace headway::sim
