// SPDX-License-Identifier: BSD-3-Clause
// The picture that all vehicles and people wear.
#include "actor_atlas.h"

#include <headway/core/random.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "actor.h"
#include "grain.h"

namespace headway::sim {
namespace {

// Layout of one vehicle's cell in the atlas [px]: x of the side and the top picture runs from the
// rear to the front of the vehicle.
inline constexpr int kVehicleCellWidth = 512;
inline constexpr int kVehicleCellHeight = 256;
inline const cv::Rect kVehicleSide{0, 0, 320, 128};
inline const cv::Rect kVehicleTop{0, 128, 320, 128};
inline const cv::Rect kVehicleFront{320, 0, 160, 128};
inline const cv::Rect kVehicleRear{320, 128, 160, 128};
inline const cv::Rect kVehicleDark{480, 0, 32, 256};

cv::Scalar paintColour(ActorKind kind, Random& random) {
  static const std::vector<cv::Scalar> kCars = {{200, 200, 200}, {45, 45, 48},  {120, 120, 122},
                                                {165, 165, 168}, {50, 45, 150}, {130, 75, 35},
                                                {225, 225, 222}, {70, 90, 60},  {60, 100, 150},
                                                {40, 60, 110},   {90, 80, 60},  {40, 150, 200}};
  static const std::vector<cv::Scalar> kBuses = {
      {40, 50, 190}, {60, 180, 220}, {170, 120, 40}, {70, 130, 60}};
  const auto& colours = kind == ActorKind::kBus ? kBuses : kCars;
  const double level = random.uniform(0.85, 1.1);
  return colours[static_cast<std::size_t>(random.below(static_cast<int>(colours.size())))] * level;
}

cv::Point inSide(double x, double z) {
  return {static_cast<int>(std::lround(x * 319)), static_cast<int>(std::lround((1.0 - z) * 127))};
}

void fillPolygon(cv::Mat picture, const std::vector<cv::Point>& corners, const cv::Scalar& colour) {
  cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{corners}, colour, cv::LINE_AA);
}

/// Body paint: lighter above (sky), darker below.
void paintBody(cv::Mat part, const cv::Scalar& colour) {
  for (int y = 0; y < part.rows; ++y) part.row(y).setTo(colour * (1.12 - 0.5 * y / part.rows));
}

void paintWheels(cv::Mat side, double rear, double front, double radius) {
  for (const double x : {rear, front}) {
    const cv::Point centre = inSide(x, radius);
    const int rx = static_cast<int>(22 * radius / 0.21), rz = static_cast<int>(radius * 127);
    cv::ellipse(side, centre, {rx * 12 / 10, rz * 12 / 10}, 0, 180, 360, cv::Scalar::all(18),
                cv::FILLED, cv::LINE_AA);
    cv::ellipse(side, centre, {rx, rz}, 0, 0, 360, cv::Scalar::all(28), cv::FILLED, cv::LINE_AA);
    cv::ellipse(side, centre, {rx * 6 / 10, rz * 6 / 10}, 0, 0, 360, cv::Scalar::all(150),
                cv::FILLED, cv::LINE_AA);
    for (int k = 0; k < 5; ++k) {
      const double a = 2 * M_PI * k / 5;
      cv::line(side, centre,
               centre + cv::Point(static_cast<int>(rx * 0.55 * std::cos(a)),
                                  static_cast<int>(rz * 0.55 * std::sin(a))),
               cv::Scalar::all(70), 2, cv::LINE_AA);
    }
  }
}

const cv::Scalar kGlass{78, 68, 60};

void paintCarSide(cv::Mat side, const cv::Scalar& colour) {
  fillPolygon(side,
              {inSide(0.15, 0.66), inSide(0.27, 0.92), inSide(0.54, 0.94), inSide(0.67, 0.67)},
              kGlass);
  fillPolygon(side, {inSide(0.2, 0.78), inSide(0.27, 0.92), inSide(0.54, 0.94), inSide(0.6, 0.8)},
              kGlass * 1.5);
  cv::line(side, inSide(0.42, 0.25), inSide(0.42, 0.95), colour * 0.5, 4, cv::LINE_AA);
  cv::line(side, inSide(0.66, 0.25), inSide(0.67, 0.66), colour * 0.5, 1, cv::LINE_AA);
  cv::line(side, inSide(0.25, 0.5), inSide(0.26, 0.66), colour * 0.5, 1, cv::LINE_AA);
  cv::line(side, inSide(0.0, 0.27), inSide(1.0, 0.27), cv::Scalar::all(40), 3);
  cv::line(side, inSide(0.03, 0.53), inSide(0.95, 0.5), colour * 1.25, 1, cv::LINE_AA);
  cv::line(side, inSide(0.45, 0.57), inSide(0.49, 0.57), colour * 0.4, 2);
  cv::line(side, inSide(0.27, 0.57), inSide(0.31, 0.57), colour * 0.4, 2);
}

/// A firm's mark: shapes without a reading direction, since both sides wear the same picture.
void paintMark(cv::Mat side, const cv::Point& centre, int size, Random& random) {
  const auto colour = [&] { return drawColour(20, 220, random); };
  cv::ellipse(side, centre, {size * 2, size}, 0, 0, 360, colour(), cv::FILLED, cv::LINE_AA);
  cv::ellipse(side, centre, {size, size * 2 / 3}, 0, 0, 360, colour(), cv::FILLED, cv::LINE_AA);
  for (int i = 0; i < 3; ++i) {
    const int y = centre.y + size + 5 + 5 * i, half = 10 + random.below(size * 2);
    cv::line(side, {centre.x - half, y}, {centre.x + half, y}, colour(), 2);
  }
}

void paintVanSide(cv::Mat side, const cv::Scalar& colour, Random& random) {
  fillPolygon(side, {inSide(0.64, 0.6), inSide(0.64, 0.9), inSide(0.71, 0.9), inSide(0.83, 0.6)},
              kGlass);
  cv::line(side, inSide(0.6, 0.15), inSide(0.6, 0.95), colour * 0.5, 1);
  cv::line(side, inSide(0.3, 0.15), inSide(0.3, 0.95), colour * 0.6, 1);
  paintMark(side, inSide(0.35, 0.7), 17, random);
}

void paintTruckSide(cv::Mat side, Random& random) {
  const cv::Scalar box = drawColour(120, 230, random);
  cv::rectangle(side, inSide(0.0, 1.0), inSide(0.73, 0.3), box, cv::FILLED);
  cv::rectangle(side, inSide(0.0, 0.3), inSide(0.75, 0.1), cv::Scalar::all(45), cv::FILLED);
  for (double x = 0.06; x < 0.7; x += 0.08) {
    cv::line(side, inSide(x, 0.3), inSide(x, 1.0), box * 0.85, 1);
  }
  paintMark(side, inSide(0.36, 0.72), 22, random);
  fillPolygon(side, {inSide(0.8, 0.55), inSide(0.8, 0.8), inSide(0.92, 0.8), inSide(0.96, 0.55)},
              kGlass);
}

void paintBusSide(cv::Mat side, const cv::Scalar& colour, Random& random) {
  cv::rectangle(side, inSide(0.0, 0.88), inSide(1.0, 0.45), kGlass, cv::FILLED);
  for (double x = 0.02; x < 1.0; x += random.uniform(0.09, 0.13)) {
    cv::line(side, inSide(x, 0.88), inSide(x, 0.45), colour * 0.6, 3);
    if (random.chance(0.5)) {  // passengers
      cv::circle(side, inSide(x + 0.05, 0.58), 6, cv::Scalar(110, 140, 180), cv::FILLED);
    }
  }
  cv::rectangle(side, inSide(0.06, 0.38), inSide(0.6, 0.18), cv::Scalar(200, 220, 230), cv::FILLED);
  paintMark(side, inSide(0.2, 0.3), 6, random);
  paintMark(side, inSide(0.45, 0.3), 6, random);
}

void paintFront(cv::Mat front, const cv::Scalar& colour, bool tall) {
  paintBody(front, colour);
  const int glass_top = tall ? 14 : 6, glass_bottom = tall ? 60 : 48;
  cv::rectangle(front, {14, glass_top}, {146, glass_bottom}, kGlass, cv::FILLED);
  cv::rectangle(front, {14, glass_top}, {146, (glass_top + glass_bottom) / 2}, kGlass * 1.5,
                cv::FILLED);
  for (const int x : {8, 122}) {
    cv::rectangle(front, {x, 66}, {x + 30, 80}, cv::Scalar(240, 245, 245), cv::FILLED);
    cv::rectangle(front, {x, 66}, {x + 30, 80}, cv::Scalar::all(60), 1);
  }
  cv::rectangle(front, {46, 66}, {114, 84}, cv::Scalar::all(35), cv::FILLED);
  cv::rectangle(front, {54, 92}, {106, 102}, cv::Scalar::all(225), cv::FILLED);
  cv::rectangle(front, {0, 108}, {159, 127}, cv::Scalar::all(35), cv::FILLED);
}

void paintRear(cv::Mat rear, const cv::Scalar& colour, bool tall, Random& random) {
  paintBody(rear, colour);
  if (tall) {
    cv::line(rear, {80, 0}, {80, 110}, colour * 0.5, 2);
    cv::rectangle(rear, {20, 12}, {70, 44}, kGlass, cv::FILLED);
    cv::rectangle(rear, {90, 12}, {140, 44}, kGlass, cv::FILLED);
  } else {
    cv::rectangle(rear, {18, 6}, {142, 44}, kGlass, cv::FILLED);
    cv::rectangle(rear, {18, 6}, {142, 20}, kGlass * 1.6, cv::FILLED);
  }
  for (const int x : {4, 130}) {
    cv::rectangle(rear, {x, 56}, {x + 26, 76}, cv::Scalar(40, 40, 190), cv::FILLED);
  }
  cv::rectangle(rear, {52, 70}, {108, 82}, cv::Scalar(215, 225, 225), cv::FILLED);
  std::string plate;
  for (int i = 0; i < 5; ++i) plate += static_cast<char>('0' + random.below(10));
  cv::putText(rear, plate, {56, 80}, cv::FONT_HERSHEY_PLAIN, 0.8, cv::Scalar::all(20), 1);
  cv::line(rear, {0, 90}, {159, 90}, colour * 0.5, 2);
  cv::rectangle(rear, {0, 108}, {159, 127}, cv::Scalar::all(35), cv::FILLED);
}

/// Bonnet, windscreen, roof, rear window along the outline's ratios of the length.
void paintTop(cv::Mat top, ActorKind kind, const cv::Scalar& colour) {
  top.setTo(colour * 1.15);
  const auto columns = [&](double x0, double x1) {
    return top.colRange(static_cast<int>(x0 * 320), static_cast<int>(x1 * 320));
  };
  if (kind == ActorKind::kCar) {
    columns(0.56, 0.7).setTo(kGlass * 1.3);
    columns(0.08, 0.24).setTo(kGlass * 1.3);
    cv::line(top, {230, 20}, {300, 30}, colour * 0.8, 1, cv::LINE_AA);
    cv::line(top, {230, 108}, {300, 98}, colour * 0.8, 1, cv::LINE_AA);
  } else if (kind == ActorKind::kVan) {
    columns(0.73, 0.85).setTo(kGlass * 1.3);
  } else if (kind == ActorKind::kTruck) {
    columns(0.0, 0.73).setTo(cv::Scalar::all(190));
    columns(0.93, 0.985).setTo(kGlass * 1.3);
  } else {
    columns(0.985, 1.0).setTo(kGlass * 1.3);
  }
}

/// Paints body, windows, lights, doors and wheels of one vehicle into its cell.
void paintVehicle(cv::Mat cell, ActorKind kind, Random& random) {
  const cv::Scalar colour = paintColour(kind, random);
  cv::Mat side = cell(kVehicleSide);
  paintBody(side, colour);
  if (kind == ActorKind::kCar) {
    paintCarSide(side, colour);
    paintWheels(side, 0.19, 0.8, 0.21);
  } else if (kind == ActorKind::kVan) {
    paintVanSide(side, colour, random);
    paintWheels(side, 0.19, 0.8, 0.145);
  } else if (kind == ActorKind::kTruck) {
    paintTruckSide(side, random);
    paintWheels(side, 0.2, 0.86, 0.145);
  } else {
    paintBusSide(side, colour, random);
    paintWheels(side, 0.25, 0.78, 0.155);
  }
  paintTop(cell(kVehicleTop), kind, colour);
  const bool tall = kind != ActorKind::kCar;
  paintFront(cell(kVehicleFront), colour, tall);
  paintRear(cell(kVehicleRear), colour, tall, random);
  cell(kVehicleDark).setTo(cv::Scalar::all(24));
}

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
