// SPDX-License-Identifier: BSD-3-Clause
// Houses: their meshes and painted facades.
#include "house.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "grain.h"

namespace headway::sim {
namespace {

constexpr int kFrontEnd = 576;  // columns: front, then gable
constexpr int kWallEnd = 448;   // rows: walls, then roof

/// One wall of the picture, addressed in metres from its bottom left.
class Wall {
 public:
  Wall(cv::Mat picture, double width, double height)
      : picture_(std::move(picture)), px_x_(picture_.cols / width), px_y_(picture_.rows / height) {}

  [[nodiscard]] cv::Rect area(double x, double y, double w, double h) const {
    const int left = static_cast<int>(std::lround(x * px_x_));
    const int right = static_cast<int>(std::lround((x + w) * px_x_));
    const int top = picture_.rows - static_cast<int>(std::lround((y + h) * px_y_));
    const int bottom = picture_.rows - static_cast<int>(std::lround(y * px_y_));
    return cv::Rect(left, top, right - left, bottom - top) &
           cv::Rect(0, 0, picture_.cols, picture_.rows);
  }
  void fill(double x, double y, double w, double h, const cv::Scalar& colour) {
    const cv::Rect rect = area(x, y, w, h);
    if (!rect.empty()) picture_(rect).setTo(colour);
  }
  void shade(double x, double y, double w, double h, double factor) {
    const cv::Rect rect = area(x, y, w, h);
    if (!rect.empty()) picture_(rect).convertTo(picture_(rect), -1, factor);
  }
  [[nodiscard]] cv::Mat& picture() { return picture_; }

 private:
  cv::Mat picture_;
  double px_x_, px_y_;
};

cv::Scalar wallColour(Random& random) {
  static const std::vector<cv::Scalar> kColours = {
      {150, 180, 200}, {130, 160, 190}, {90, 110, 165},  {75, 85, 140},   {170, 180, 185},
      {140, 165, 160}, {120, 130, 135}, {105, 150, 190}, {165, 170, 205}, {110, 125, 120}};
  const cv::Scalar base =
      kColours[static_cast<std::size_t>(random.below(static_cast<int>(kColours.size())))];
  return base * random.uniform(0.8, 1.15);
}

void drawBricks(Wall& wall, double width, double height, const cv::Scalar& colour, Random& random) {
  const double course = random.uniform(0.14, 0.22), brick = random.uniform(0.35, 0.55);
  int row = 0;
  for (double y = 0; y < height; y += course, ++row) {
    for (double x = (row % 2) * -0.5 * brick; x < width; x += brick) {
      wall.fill(x, y, brick - 0.03, course - 0.03, colour * random.uniform(0.78, 1.12));
    }
  }
}

void drawPanels(Wall& wall, double width, double height, Random& random) {
  for (int i = 0; i < 14; ++i) {  // repairs and weathering
    const double level = random.uniform(0.86, 1.1);
    const double h = random.uniform(0.2, 1.6), w = random.uniform(0.3, 2.5);
    const double y = random.uniform(0, height), x = random.uniform(0, width);
    wall.shade(x, y, w, h, level);
  }
  for (int i = 0; i < 5; ++i) {  // runs of rain water
    const double level = random.uniform(0.75, 0.9);
    const double h = random.uniform(1.0, 4.0), w = random.uniform(0.05, 0.25);
    const double y = random.uniform(0, height * 0.6), x = random.uniform(0, width);
    wall.shade(x, y, w, h, level);
  }
}

void drawWindow(Wall& wall, double x, double y, double w, double h, const cv::Scalar& frame,
                Random& random) {
  wall.fill(x - 0.12, y - 0.16, w + 0.24, h + 0.28, frame * random.uniform(0.95, 1.0));
  const double glass = random.uniform(35, 85);
  wall.fill(x, y, w, h, cv::Scalar(glass * 1.15, glass, glass * 0.85));
  const double lit = random.uniform(1.2, 2.2);  // the sky mirrored in the upper part
  wall.fill(x, y + h * random.uniform(0.4, 0.8), w, h * 0.2,
            cv::Scalar(glass * lit * 1.1, glass * lit, glass * lit * 0.9));
  if (random.chance(0.55)) {  // curtains
    const cv::Scalar cloth = drawColour(120, 220, random);
    const double part = w * random.uniform(0.12, 0.4);
    wall.fill(x, y, part, h, cloth);
    wall.fill(x + w - part, y, part, h, cloth * 0.93);
  }
  if (random.chance(0.2)) wall.fill(x, y + h * 0.45, w, h * 0.55, cv::Scalar::all(170));  // blind
  wall.fill(x + w / 2 - 0.03, y, 0.06, h, frame);
  if (random.chance(0.6)) wall.fill(x, y + h * random.uniform(0.55, 0.7), w, 0.05, frame);
  wall.fill(x - 0.18, y - 0.22, w + 0.36, 0.09, frame * 0.8);  // sill
  wall.shade(x - 0.18, y - 0.34, w + 0.36, 0.12, 0.65);        // and its shade
  if (random.chance(0.35)) {                                   // flowers or things on the sill
    for (int i = 0; i < 7; ++i) {
      const double red = random.uniform(40, 220), green = random.uniform(60, 170),
                   blue = random.uniform(20, 120);
      const double height = random.uniform(0.08, 0.3), width = random.uniform(0.06, 0.18);
      wall.fill(x + random.uniform(0, w), y - 0.13, width, height, {blue, green, red});
    }
  }
}

std::string randomWord(Random& random) {
  std::string word;
  const int letters = 3 + random.below(6);
  for (int i = 0; i < letters; ++i) word += static_cast<char>('A' + random.below(26));
  return word;
}

void drawShop(Wall& wall, double width, Random& random) {
  const cv::Scalar board = drawColour(20, 200, random);
  wall.fill(0.3, 0.45, width - 0.6, 2.35, cv::Scalar(70, 62, 55));
  for (int i = 0; i < 36; ++i) {  // goods behind the glass
    const cv::Scalar colour = drawColour(20, 220, random);
    const double h = random.uniform(0.1, 0.6), w = random.uniform(0.1, 0.7);
    const double y = random.uniform(0.5, 2.0), x = random.uniform(0.4, width - 1.2);
    wall.fill(x, y, w, h, colour);
  }
  for (double x = 0.3; x < width; x += random.uniform(1.2, 2.4)) {
    wall.fill(x, 0.45, 0.08, 2.35, cv::Scalar::all(random.uniform(30, 190)));
  }
  const double door = random.uniform(0.5, width - 1.6);
  wall.fill(door, 0.0, 1.1, 2.5, board * 0.6);
  wall.fill(door + 0.15, 0.5, 0.8, 1.8, cv::Scalar(85, 80, 70));
  wall.fill(0.2, 2.8, width - 0.4, 0.75, board);
  wall.shade(0.2, 2.7, width - 0.4, 0.12, 0.5);
  const cv::Rect sign = wall.area(0.4, 2.9, width - 0.8, 0.55);
  const double brightness = random.chance(0.5) ? 235 : 20;
  const double scale = random.uniform(0.7, 0.95);
  const int font = random.below(4);
  const cv::Point at(sign.x + random.below(60), sign.y + sign.height - 3);
  const std::string second = randomWord(random), first = randomWord(random);
  cv::putText(wall.picture(), first + " " + second, at, font, scale, cv::Scalar::all(brightness), 2,
              cv::LINE_AA);
}

void drawGroundFloor(Wall& wall, double width, const cv::Scalar& frame, Random& random) {
  const double door = random.uniform(0.6, width - 1.8);
  const cv::Scalar paint = drawColour(20, 140, random);
  for (double x = random.uniform(0.5, 1.0); x < width - 1.4; x += random.uniform(1.9, 2.8)) {
    if (std::abs(x - door) < 1.8) continue;
    const double h = random.uniform(1.2, 1.5), w = random.uniform(0.9, 1.3);
    drawWindow(wall, x, 0.95, w, h, frame, random);
  }
  wall.fill(door - 0.15, 0.0, 1.4, 2.5, frame);
  wall.fill(door, 0.12, 1.1, 2.25, paint);
  wall.fill(door + 0.12, 1.3, 0.86, 0.85, cv::Scalar(75, 65, 60));
  wall.fill(door + 0.12, 0.3, 0.86, 0.8, paint * 1.25);
  wall.fill(door - 0.2, 0.0, 1.5, 0.12, cv::Scalar::all(140));
  if (random.chance(0.4)) {  // graffiti
    const cv::Rect at = wall.area(random.uniform(0.2, width * 0.5), 0.5, 1, 0.6);
    const cv::Scalar colour = drawColour(0, 255, random);
    const double scale = random.uniform(1.2, 2.2);
    cv::putText(wall.picture(), randomWord(random), at.tl() + cv::Point(0, at.height), 1, scale,
                colour, 2, cv::LINE_AA);
  }
}

void drawWall(Wall wall, double width, double height, bool front, bool shop,
              const cv::Scalar& colour, bool brick, Random& random) {
  wall.picture().setTo(colour);
  if (brick) drawBricks(wall, width, height, colour, random);
  drawPanels(wall, width, height, random);
  const cv::Scalar frame =
      random.chance(0.7) ? cv::Scalar::all(random.uniform(170, 225)) : cv::Scalar(60, 80, 100);
  const double storey = random.uniform(2.9, 3.4);
  const double ground_storey = storey + 0.5;
  const double pitch = random.uniform(1.9, 3.0);
  const int columns = std::max(1, static_cast<int>((width - 0.6) / pitch));
  const double margin = 0.5 * (width - columns * pitch);
  const double window_w = pitch * random.uniform(0.4, 0.6), window_h = random.uniform(1.2, 1.8);
  for (double y = ground_storey; y + storey <= height + 0.2; y += storey) {
    wall.fill(0, y - 0.15, width, 0.14, colour * random.uniform(0.7, 1.25));
    for (int c = 0; c < columns; ++c) {
      if (!front && random.chance(0.6)) continue;
      if (random.chance(0.04)) continue;  // bricked up
      drawWindow(wall, margin + (c + 0.5) * pitch - window_w / 2, y + 0.75, window_w, window_h,
                 frame, random);
    }
  }
  if (front && shop) drawShop(wall, width, random);
  if (front && !shop) drawGroundFloor(wall, width, frame, random);
  wall.shade(0, 0, width, 0.5, 0.72);  // plinth
  wall.shade(0, height - 0.5, width, 0.5, 0.75);
  wall.fill(0, height - 0.2, width, 0.2, cv::Scalar::all(random.uniform(90, 200)));
  const double pipe = random.uniform(70, 130);
  wall.fill(random.uniform(0.1, 0.3), 0, 0.12, height, cv::Scalar::all(pipe));
}

void drawRoof(cv::Mat picture, Random& random) {
  const cv::Scalar tile = random.chance(0.6) ? cv::Scalar(60, 75, 135) : cv::Scalar(85, 82, 80);
  for (int y = 0; y < picture.rows; y += 6) {
    for (int x = 0; x < picture.cols; x += 7) {
      cv::rectangle(picture, {x, y}, {x + 5, y + 4}, tile * random.uniform(0.7, 1.2), cv::FILLED);
    }
  }
}

}  // namespace

UvRect facadeFront() {
  return {0.0F, 0.0F, static_cast<float>(kFrontEnd) / kFacadeTextureWidth,
          static_cast<float>(kWallEnd) / kFacadeTextureHeight};
}
UvRect facadeGable() {
  return {static_cast<float>(kFrontEnd) / kFacadeTextureWidth, 0.0F, 1.0F,
          static_cast<float>(kWallEnd) / kFacadeTextureHeight};
}
UvRect facadeRoof() {
  return {0.0F, static_cast<float>(kWallEnd + 2) / kFacadeTextureHeight, 1.0F, 1.0F};
}

cv::Mat drawFacade(const FacadePlan& plan, const Grain& grain, Random& random) {
  cv::Mat picture(kFacadeTextureHeight, kFacadeTextureWidth, CV_8UC3, cv::Scalar::all(90));
  const cv::Scalar colour = wallColour(random);
  const bool brick = random.chance(0.45);
  drawWall(Wall(picture(cv::Rect(0, 0, kFrontEnd, kWallEnd)), plan.width_m, plan.height_m),
           plan.width_m, plan.height_m, true, plan.shop, colour, brick, random);
  drawWall(Wall(picture(cv::Rect(kFrontEnd, 0, kFacadeTextureWidth - kFrontEnd, kWallEnd)),
                plan.side_m, plan.height_m),
           plan.side_m, plan.height_m, false, false, colour, brick, random);
  drawRoof(picture(cv::Rect(0, kWallEnd, kFacadeTextureWidth, kFacadeTextureHeight - kWallEnd)),
           random);
  grain.roughen(picture, 6.0, 6.0, random);
  return picture;
}

namespace {

using Eigen::Vector3f;

/// Half the front, the depth and the height of the walls, as ways.
struct HouseAxes {
  HouseAxes(const FacadePlan& facade, float yaw)
      : half(0.5F * static_cast<float>(facade.width_m) * Vector3f(std::cos(yaw), std::sin(yaw), 0)),
        deep(static_cast<float>(facade.side_m) * Vector3f(-std::sin(yaw), std::cos(yaw), 0)),
        up(0, 0, static_cast<float>(facade.height_m) + 0.3F) {}

  Vector3f half, deep, up;
};

}  // namespace

Block houseBlock(const HousePlan& plan, const Vector3f& foot, float yaw) {
  const HouseAxes to(plan.facade, yaw);
  // Seen from the street the front's left end is where `half` points away from.
  const Vector3f fl = foot - to.half, fr = foot + to.half, bl = fl + to.deep, br = fr + to.deep;
  return {fl, fr, br, bl, fl + to.up, fr + to.up, br + to.up, bl + to.up};
}

Mesh houseMesh(const HousePlan& plan, const Vector3f& foot, float yaw) {
  const HouseAxes to(plan.facade, yaw);
  const auto [fl, fr, br, bl, top_fl, top_fr, top_br, top_bl] = houseBlock(plan, foot, yaw);
  Mesh mesh;
  mesh.addQuad(top_fl, top_fr, fr, fl, facadeFront());
  mesh.addQuad(top_fr, top_br, br, fr, facadeGable());
  mesh.addQuad(top_bl, top_fl, fl, bl, facadeGable());
  mesh.addQuad(top_br, top_bl, bl, br, facadeFront());
  const UvRect roof = facadeRoof();
  if (plan.ridge_m <= 0.0) {
    mesh.addQuad(top_bl, top_br, top_fr, top_fl, roof);
    return mesh;
  }
  const Vector3f ridge = to.up + Vector3f(0, 0, static_cast<float>(plan.ridge_m)) + 0.5F * to.deep;
  mesh.addQuad(fl + ridge, fr + ridge, top_fr, top_fl, roof);
  mesh.addQuad(fr + ridge, fl + ridge, top_bl, top_br, roof);
  const UvRect wall = facadeGable().part(0.1F, 0.02F, 0.9F, 0.2F);
  mesh.addTriangle({top_fl, wall.at(0, 1)}, {top_bl, wall.at(1, 1)},
                   {fl + ridge, wall.at(0.5F, 0)});
  mesh.addTriangle({top_fr, wall.at(0, 1)}, {fr + ridge, wall.at(0.5F, 0)},
                   {top_br, wall.at(1, 1)});
  return mesh;
}

}  // namespace headway::sim
