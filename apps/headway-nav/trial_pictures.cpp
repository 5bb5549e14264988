// SPDX-License-Identifier: BSD-3-Clause
// Pictures of trials from above, the policies side by side.
#include "trial_pictures.h"

#include <headway/map/map_query.h>
#include <mrpt/maps/COccupancyGridMap2D.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "trial.h"

namespace headway::app {
namespace {

using Eigen::Vector2d;

/// Layout of a picture of trials [px]: three panels fill 1280 x 720.
struct Layout {
  int panel_width = 426, height = 720;
  int title = 64, legend = 54;  ///< heights at the top and at the bottom
};
constexpr Layout kLayout;

const cv::Scalar kPaper(250, 250, 250), kInk(60, 50, 45), kFaint(215, 215, 215);
const cv::Scalar kRobot(170, 95, 30), kPerson(40, 130, 235), kPillar(140, 140, 140);
const cv::Scalar kPrediction(80, 165, 70), kObstacle(60, 60, 215), kContact(40, 40, 220);

/// Colours of what is known of the ground.
struct GroundColours {
  cv::Vec3b blocked{60, 60, 215}, free{205, 235, 200}, entered{90, 190, 250},
      unknown{200, 200, 200}, not_seen{250, 250, 250};

  [[nodiscard]] cv::Vec3b of(map::LocalState state) const {
    switch (state) {
      case map::LocalState::kBlocked:
        return blocked;
      case map::LocalState::kFree:
        return free;
      case map::LocalState::kUnknown:
        return unknown;
      case map::LocalState::kEntered:
        return entered;
      case map::LocalState::kNotInView:
        break;
    }
    return not_seen;
  }
};

/// Panel of one trial in a picture: its ground from above, x upwards, y to the left.
///
/// Places are of the trial's frame [m]. The scale is such that `bounds` fill the panel, and is
/// shown by a bar.
class TrialPanel {
 public:
  /// @param image   of the panel, with room for title and legend; drawn on
  /// @param bounds  x and y that the panel shows, in its middle [m]
  TrialPanel(cv::Mat image, const RobotParams& robot, const Eigen::AlignedBox2d& bounds);

  /// Grid, scale, and what stands there.
  void drawGround(const TrialScene& scene);
  /// A picture in the lower left corner, or in the right one.
  void inset(const cv::Mat& picture, bool right = false);
  void circle(const Eigen::Vector2d& centre, double radius_m, const cv::Scalar& colour,
              int thickness);
  void dot(const Eigen::Vector2d& centre, int radius_px, const cv::Scalar& colour);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& colour,
            int thickness);
  void robot(const mrpt::math::TPose2D& pose, const cv::Scalar& colour, int thickness);
  /// Left out where it would cover another text.
  ///
  /// @param place  of its lower left corner
  void text(const std::string& words, const Eigen::Vector2d& place, double size,
            const cv::Scalar& colour);
  void title(const std::string& name, const std::string& state, bool bad);

  /// Whether a position is in the drawn area.
  [[nodiscard]] bool shows(const Eigen::Vector2d& place) const;

 private:
  [[nodiscard]] double spacingM() const;
  void drawScale(double metres);
  [[nodiscard]] cv::Point at(const Eigen::Vector2d& place) const;
  [[nodiscard]] std::vector<cv::Point> cornersOf(const sim::Footprint& box) const;
  void fill(const sim::Footprint& box, const cv::Scalar& colour);

  cv::Mat image_;
  RobotParams robot_;
  Eigen::Vector2d middle_;  ///< position in the middle of the panel [m]
  double pixels_per_m_;
  std::vector<cv::Rect> texts_;  ///< drawn so far [px]
};

constexpr int kShift = 4;  // bits of a pixel's fraction

TrialPanel::TrialPanel(cv::Mat image, const RobotParams& robot, const Eigen::AlignedBox2d& bounds)
    : image_(std::move(image)),
      robot_(robot),
      middle_(bounds.center()),
      pixels_per_m_(std::min((kLayout.height - kLayout.title - kLayout.legend) / bounds.sizes().x(),
                             image_.cols / bounds.sizes().y())) {}

void TrialPanel::drawGround(const TrialScene& scene) {
  const Vector2d reach(0.5 * (kLayout.height - kLayout.title - kLayout.legend) / pixels_per_m_,
                       0.5 * image_.cols / pixels_per_m_);
  const Vector2d least = middle_ - reach, greatest = middle_ + reach;
  const double spacing = spacingM();
  const auto firstFrom = [&](double from) { return spacing * std::ceil(from / spacing); };
  for (double x = firstFrom(least.x()); x <= greatest.x(); x += spacing) {
    line({x, least.y()}, {x, greatest.y()}, kFaint, 1);
  }
  for (double y = firstFrom(least.y()); y <= greatest.y(); y += spacing) {
    line({least.x(), y}, {greatest.x(), y}, kFaint, 1);
  }
  cv::line(image_, {image_.cols - 1, 0}, {image_.cols - 1, image_.rows}, kFaint, 1);
  for (const sim::Footprint& thing : scene.things) fill(thing, kPillar);
  for (std::size_t i = 1; i < scene.course.size(); ++i) {
    line(scene.course[i - 1], scene.course[i], kPrediction, 1);
  }
  drawScale(spacing);
  circle(scene.goal, RobotParams::kGoalRadius_m, kRobot, 2);
  text("goal", scene.goal - Vector2d(0.0, 0.6), 0.45, kRobot);
}

void TrialPanel::inset(const cv::Mat& picture, bool right) {
  if (picture.empty()) return;
  cv::Mat colour = picture;
  if (picture.channels() == 1) cv::cvtColor(picture, colour, cv::COLOR_GRAY2BGR);
  const int bottom = kLayout.height - kLayout.legend - 40;  // above the scale
  const int left = right ? image_.cols - colour.cols : 0;
  const cv::Rect place(left, bottom - colour.rows, colour.cols, colour.rows);
  colour.copyTo(image_(place));
}

std::vector<cv::Point> TrialPanel::cornersOf(const sim::Footprint& box) const {
  std::vector<cv::Point> corners;
  for (const auto& [x, y] : {std::pair{0.5, 0.5}, {0.5, -0.5}, {-0.5, -0.5}, {-0.5, 0.5}}) {
    const Vector2d corner = Vector2d(x, y).cwiseProduct(box.size);
    corners.push_back(at(box.centre + Eigen::Rotation2Dd(box.yaw) * corner));
  }
  return corners;
}

void TrialPanel::fill(const sim::Footprint& box, const cv::Scalar& colour) {
  cv::fillConvexPoly(image_, cornersOf(box), colour, cv::LINE_AA, kShift);
}

void TrialPanel::circle(const Vector2d& centre, double radius_m, const cv::Scalar& colour,
                        int thickness) {
  const int radius = static_cast<int>(radius_m * pixels_per_m_ * (1 << kShift));
  cv::circle(image_, at(centre), radius, colour, thickness, cv::LINE_AA, kShift);
}

void TrialPanel::dot(const Vector2d& centre, int radius_px, const cv::Scalar& colour) {
  cv::circle(image_, at(centre), radius_px << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
}

void TrialPanel::line(const Vector2d& from, const Vector2d& to, const cv::Scalar& colour,
                      int thickness) {
  cv::line(image_, at(from), at(to), colour, thickness, cv::LINE_AA, kShift);
}

void TrialPanel::robot(const mrpt::math::TPose2D& pose, const cv::Scalar& colour, int thickness) {
  const auto corners = cornersOf({{pose.x, pose.y}, {robot_.length_m, robot_.width_m}, pose.phi});
  if (thickness == cv::FILLED) {
    cv::fillConvexPoly(image_, corners, colour, cv::LINE_AA, kShift);
  } else {
    cv::polylines(image_, corners, true, colour, thickness, cv::LINE_AA, kShift);
  }
}

void TrialPanel::text(const std::string& words, const Vector2d& place, double size,
                      const cv::Scalar& colour) {
  const cv::Point corner = at(place);
  const cv::Point left(corner.x >> kShift, corner.y >> kShift);
  int baseline = 0;
  const cv::Size extent =
      cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, size, 1, &baseline) + cv::Size(4, 4);
  const cv::Rect covered({left.x - 2, left.y - extent.height + 2}, extent);
  for (const auto& other : texts_) {
    if (!(covered & other).empty()) return;
  }
  texts_.push_back(covered);
  cv::putText(image_, words, left, cv::FONT_HERSHEY_SIMPLEX, size, colour, 1, cv::LINE_AA);
}

void TrialPanel::title(const std::string& name, const std::string& state, bool bad) {
  cv::rectangle(image_, {0, 0, image_.cols, kLayout.title}, kPaper, cv::FILLED);
  cv::putText(image_, name, {14, 27}, cv::FONT_HERSHEY_SIMPLEX, 0.75, kInk, 2, cv::LINE_AA);
  cv::putText(image_, state, {14, 52}, cv::FONT_HERSHEY_SIMPLEX, 0.5, bad ? kContact : kInk, 1,
              cv::LINE_AA);
  cv::line(image_, {0, kLayout.title}, {image_.cols, kLayout.title}, kFaint, 1);
}

bool TrialPanel::shows(const Vector2d& place) const {
  const cv::Point p = at(place);
  return p.y >> kShift > kLayout.title && p.y >> kShift < kLayout.height - kLayout.legend &&
         p.x > 0 && p.x >> kShift < image_.cols;
}

/// Distance of the grid's lines, of at least 20 px [m].
double TrialPanel::spacingM() const {
  double spacing = 2.0;
  while (spacing * pixels_per_m_ < 20) spacing *= 5.0;
  return spacing;
}

/// A bar as long as the grid's spacing, at the lower left.
void TrialPanel::drawScale(double metres) {
  const int y = kLayout.height - kLayout.legend - 14, x = 14;
  const int end = x + cvRound(metres * pixels_per_m_);
  const std::string words = cv::format("%.0f m", metres);
  cv::line(image_, {x, y}, {end, y}, kInk, 2);
  cv::putText(image_, words, {end + 8, y + 5}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk, 1,
              cv::LINE_AA);
  texts_.emplace_back(x, y - 10, end + 50 - x, 20);
}

/// Pixel of a position, with kShift bits of fraction: x upwards, y to the left.
cv::Point TrialPanel::at(const Vector2d& place) const {
  const Vector2d offset = pixels_per_m_ * (place - middle_);
  const double u = 0.5 * image_.cols - offset.y();
  const double v = 0.5 * (kLayout.title + kLayout.height - kLayout.legend) - offset.x();
  return {cvRound(u * (1 << kShift)), cvRound(v * (1 << kShift))};
}

/// The whole way of the robot, with start and goal.
Eigen::AlignedBox2d boundsOf(const TrialRecord& record) {
  const TrialScene& scene = *record.moments.front().scene;
  Eigen::AlignedBox2d bounds(Vector2d(0.0, 0.0));
  bounds.extend(scene.goal);
  for (const Vector2d& place : scene.course) bounds.extend(place);
  for (const auto& moment : record.moments) {
    bounds.extend(Vector2d(moment.robot.x, moment.robot.y));
  }
  const Vector2d margin(1.0, 1.0);  // the robot and a person beside it
  return {bounds.min() - margin, bounds.max() + margin};
}

void label(cv::Mat& image, int& x, const std::string& words) {
  cv::putText(image, words, {x, kLayout.height - 20}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk, 1,
              cv::LINE_AA);
  int baseline = 0;
  x += cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, 0.48, 1, &baseline).width + 26;
}

/// Legend, also of pictures of the ground, and note.
void drawLegend(cv::Mat& image, bool has_ground, const std::string& note) {
  cv::rectangle(image, {0, kLayout.height - kLayout.legend, image.cols, kLayout.legend}, kPaper,
                cv::FILLED);
  cv::line(image, {0, kLayout.height - kLayout.legend},
           {image.cols, kLayout.height - kLayout.legend}, kFaint, 1);
  const int y = kLayout.height - 25;
  int x = 14;
  const auto mark = [&](const cv::Scalar& colour, int radius, const std::string& words) {
    cv::circle(image, {x + radius, y}, radius, colour, cv::FILLED, cv::LINE_AA);
    x += 2 * radius + 8;
    label(image, x, words);
  };
  cv::rectangle(image, {x, y - 8, 20, 16}, kRobot, cv::FILLED);
  x += 28;
  label(image, x, "robot");
  mark(kPerson, 9, "person");
  mark(kPillar, 8, "pillar");
  mark(kPrediction, 4, "predicted, 3 s");
  mark(kObstacle, 3, "obstacles the planner gets");
  if (has_ground) {
    const GroundColours ground;
    mark(ground.free, 8, "free");
    mark(ground.entered, 8, "may be entered");
    mark(ground.unknown, 8, "unknown");
  }
  label(image, x, note);
}

cv::Mat blankPicture(std::size_t panels) {
  const int width = std::max(3, static_cast<int>(panels)) * kLayout.panel_width;
  return cv::Mat(kLayout.height, width + width % 2, CV_8UC3, kPaper);
}

cv::Mat panelOf(cv::Mat& picture, std::size_t index, std::size_t count) {
  const int width = picture.cols / static_cast<int>(count);
  return picture(cv::Rect(static_cast<int>(index) * width, 0, width, kLayout.height));
}

/// Index of the moment at a time, or of the last one.
std::size_t momentAt(const TrialRecord& record, double time_s) {
  const auto after =
      std::upper_bound(record.moments.begin(), record.moments.end(), time_s,
                       [](double time, const TrialMoment& moment) { return time < moment.time_s; });
  const auto index = static_cast<std::size_t>(after - record.moments.begin());
  return index == 0 ? 0 : index - 1;
}

bool contactUntil(const TrialRecord& record, std::size_t last) {
  for (std::size_t i = 0; i <= last; ++i) {
    if (record.moments[i].contact) return true;
  }
  return false;
}

std::string secondsText(const char* what, double seconds) {
  return cv::format("%s%.1f s", what, seconds);
}

void drawPredictions(TrialPanel& panel, const TrialMoment& moment) {
  for (const auto& track : moment.tracks) {
    if (track.status == TrackStatus::kTentative || track.predictions.empty()) continue;
    const auto& points = track.predictions.front().points;
    for (std::size_t i = 1; i < points.size(); i += 2) {
      panel.dot(points[i].position.head<2>(), 2, kPrediction);
    }
  }
}

void drawRecordAt(TrialPanel& panel, const TrialRecord& record, const RobotParams& robot,
                  double time_s) {
  const std::size_t last = momentAt(record, time_s);
  const TrialMoment& moment = record.moments[last];
  panel.drawGround(*record.moments.front().scene);
  for (std::size_t i = 1; i <= last; ++i) {
    const auto& from = record.moments[i - 1].robot;
    const auto& to = record.moments[i].robot;
    panel.line({from.x, from.y}, {to.x, to.y}, kRobot, 2);
  }
  for (const auto& pillar : moment.pillars) {
    panel.circle(pillar.position, pillar.radius, kPillar, cv::FILLED);
  }
  for (const auto& person : moment.people) {
    panel.circle(person.position, person.radius, kPerson, cv::FILLED);
    panel.line(person.position, person.position + 0.5 * person.velocity(), kPerson, 2);
  }
  drawPredictions(panel, moment);
  panel.robot(moment.robot, moment.contact ? kContact : kRobot, cv::FILLED);
  const Vector2d nose(std::cos(moment.robot.phi), std::sin(moment.robot.phi));
  const Vector2d centre(moment.robot.x, moment.robot.y);
  panel.line(centre, centre + 0.22 * nose, kPaper, 2);
  for (const auto& point : moment.obstacles) panel.dot(point, 1, kObstacle);
  panel.inset(moment.image);
  panel.inset(drawGround(moment.ground, robot), true);
  const bool contact = contactUntil(record, last);
  std::string state = secondsText("", moment.time_s);
  if (last + 1 == record.moments.size() && record.result.goal_reached) {
    state = secondsText("at the goal after ", moment.time_s);
  }
  if (contact) state += ", touched a person";
  panel.title(record.policy, state, contact);
}

/// Moments at which a second begins, with that second.
std::vector<std::pair<const TrialMoment*, std::string>> secondsOf(const TrialRecord& record) {
  std::vector<std::pair<const TrialMoment*, std::string>> result;
  int next = 0;
  for (const auto& moment : record.moments) {
    const int second = static_cast<int>(std::floor(moment.time_s + 1e-6));
    if (second < next) continue;
    result.emplace_back(&moment, std::to_string(second));
    next = second + 1;
  }
  return result;
}

void drawRecordWhole(TrialPanel& panel, const TrialRecord& record) {
  panel.drawGround(*record.moments.front().scene);
  for (const auto& pillar : record.moments.front().pillars) {
    panel.circle(pillar.position, pillar.radius, kPillar, cv::FILLED);
  }
  for (std::size_t i = 1; i < record.moments.size(); ++i) {
    const TrialMoment& before = record.moments[i - 1];
    const TrialMoment& moment = record.moments[i];
    for (std::size_t j = 0; j < moment.people.size(); ++j) {
      panel.line(before.people[j].position, moment.people[j].position, kPerson, 1);
    }
    panel.line({before.robot.x, before.robot.y}, {moment.robot.x, moment.robot.y}, kRobot, 2);
    if (moment.contact) panel.robot(moment.robot, kContact, 2);
  }
  const auto seconds = secondsOf(record);
  for (const auto& [moment, second] : seconds) {  // first: they keep their place
    panel.robot(moment->robot, kRobot, 1);
    panel.text(second, {moment->robot.x - 0.1, moment->robot.y - 0.4}, 0.4, kRobot);
  }
  for (const auto& [moment, second] : seconds) {
    for (const auto& person : moment->people) {
      if (!panel.shows(person.position)) continue;
      panel.circle(person.position, person.radius, kPerson, 1);
      panel.text(second, person.position + Vector2d(-0.1, 0.1), 0.36, kPerson);
    }
  }
  std::string state = record.result.goal_reached
                          ? secondsText("goal after ", record.result.time_to_goal_s)
                          : std::string("goal not reached");
  state += cv::format(", least distance %.2f m", record.result.min_distance_m);
  if (record.result.collided) state += ", collision";
  panel.title(record.policy, state, record.result.collided);
}

/// Layout of a picture of the ground.
struct GroundLayout {
  int cells = 110;  ///< along a side
  double cell_m = 0.06;
  int scale = 2;   ///< pixels of a cell
  int title = 22;  ///< height [px]
};
constexpr GroundLayout kGround;

/// What a grid's cell says, as the newest frames would.
map::LocalState stateOf(float free_probability) {
  if (free_probability > 0.6F) return map::LocalState::kFree;
  return free_probability < 0.4F ? map::LocalState::kBlocked : map::LocalState::kNotInView;
}

}  // namespace

cv::Mat1b groundAbout(const mrpt::math::TPose2D& pose, const map::PerceptionMap& map,
                      double caution) {
  map::MapQueryParams params;
  params.caution = caution;
  const map::MapQuery query(map, map.movingObjects().time(), params);
  const auto grid = map.staticGrid();
  cv::Mat1b ground(kGround.cells, 2 * kGround.cells);
  const Eigen::Rotation2Dd turn(pose.phi);
  for (int row = 0; row < kGround.cells; ++row) {
    for (int column = 0; column < kGround.cells; ++column) {
      const Vector2d cell(0.5 * kGround.cells - row - 0.5, 0.5 * kGround.cells - column - 0.5);
      const Vector2d place = Vector2d(pose.x, pose.y) + turn * (kGround.cell_m * cell);
      const float free =
          grid ? grid->getPos(static_cast<float>(place.x()), static_cast<float>(place.y())) : 0.5F;
      ground(row, column) = static_cast<uchar>(query.localAt(place));
      ground(row, column + kGround.cells) = static_cast<uchar>(stateOf(free));
    }
  }
  return ground;
}

cv::Mat drawGround(const cv::Mat1b& ground, const RobotParams& robot) {
  if (ground.empty()) return {};
  const GroundColours colours;
  cv::Mat3b cells(ground.size());
  std::transform(ground.begin(), ground.end(), cells.begin(),
                 [&](uchar state) { return colours.of(static_cast<map::LocalState>(state)); });
  cv::Mat picture;
  cv::resize(cells, picture, {}, kGround.scale, kGround.scale, cv::INTER_NEAREST);
  const int side = kGround.scale * kGround.cells;
  const double px = kGround.scale / kGround.cell_m;
  const cv::Size body(cvRound(px * robot.width_m), cvRound(px * robot.length_m));
  for (const int left : {0, side}) {
    const cv::Point corner(left + (side - body.width) / 2, (side - body.height) / 2);
    cv::rectangle(picture, {corner, body}, kRobot, cv::FILLED);
    cv::rectangle(picture, cv::Rect(left, 0, side, side), kFaint);
  }
  cv::copyMakeBorder(picture, picture, kGround.title, 0, 0, 0, cv::BORDER_CONSTANT, kPaper);
  for (const auto& [left, words] : {std::pair{0, "seen now"}, {side, "map"}}) {
    cv::putText(picture, words, {left + 6, kGround.title - 6}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk,
                1, cv::LINE_AA);
  }
  return picture;
}

cv::Mat drawMoment(const std::vector<TrialRecord>& records, const RobotParams& robot,
                   double time_s) {
  cv::Mat picture = blankPicture(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    TrialPanel panel(panelOf(picture, i, records.size()), robot, boundsOf(records[i]));
    drawRecordAt(panel, records[i], robot, time_s);
  }
  const bool has_ground = !records.front().moments.front().ground.empty();
  drawLegend(picture, has_ground, secondsText("time ", time_s));
  return picture;
}

cv::Mat drawWhole(const std::vector<TrialRecord>& records, const RobotParams& robot) {
  cv::Mat picture = blankPicture(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    TrialPanel panel(panelOf(picture, i, records.size()), robot, boundsOf(records[i]));
    drawRecordWhole(panel, records[i]);
  }
  drawLegend(picture, false, "numbers: seconds; red: contact");
  return picture;
}

}  // namespace headway::app
