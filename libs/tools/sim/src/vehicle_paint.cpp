// SPDX-License-Identifier: BSD-3-Clause
#include "vehicle_paint.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "random_draws.h"

namespace headway::sim {
namespace {

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

}  // namespace

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

}  // namespace headway::sim
