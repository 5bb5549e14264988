// SPDX-License-Identifier: BSD-3-Clause
#include "top_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr int kPanelWidth = 426;  ///< [px]
constexpr int kHeight = 720;      ///< [px]
constexpr int kTitle = 64;        ///< [px]
constexpr int kLegend = 54;       ///< [px]
constexpr int kShift = 4;         ///< bits of a pixel's fraction

const cv::Scalar kPaper(250, 250, 250), kInk(60, 50, 45), kFaint(215, 215, 215);
const cv::Scalar kRobot(170, 95, 30), kPerson(40, 130, 235), kPillar(140, 140, 140);
const cv::Scalar kPrediction(80, 165, 70), kObstacle(60, 60, 215), kContact(40, 40, 220);

/// What the panels of a picture show: the same area, with the whole way of every robot.
struct Area {
  double back_m = -1.0;       ///< lowest x
  double front_m = 0.0;       ///< greatest x
  double half_width_m = 0.0;  ///< greatest y, to both sides

  Area(const std::vector<TrialRecord>& records, const RobotParams& robot)
      : front_m(robot.goal_m + 1.0) {
    constexpr double kMarginM = 0.6;  // beyond the centre of a robot
    for (const auto& record : records) {
      for (const auto& moment : record.moments) {
        back_m = std::min(back_m, moment.robot.x - kMarginM);
        front_m = std::max(front_m, moment.robot.x + kMarginM);
        half_width_m = std::max(half_width_m, std::abs(moment.robot.y) + kMarginM);
      }
    }
  }
  [[nodiscard]] double pixelsPerMetre() const {
    return std::min((kHeight - kTitle - kLegend) / (front_m - back_m),
                    0.5 * kPanelWidth / half_width_m);
  }
};

/// Panel of one trial in a picture.
class Panel {
 public:
  Panel(cv::Mat image, const RobotParams& robot, const Area& area)
      : image_(std::move(image)),
        robot_(robot),
        area_(area),
        pixels_per_m_(area.pixelsPerMetre()) {}

  void drawGround() {
    const double side = 0.5 * image_.cols / pixels_per_m_;
    const auto firstEven = [](double from) { return 2 * static_cast<int>(std::ceil(0.5 * from)); };
    for (int x = firstEven(area_.back_m); x <= area_.front_m; x += 2) {
      cv::line(image_, at({x, -side}), at({x, side}), kFaint, 1, cv::LINE_AA, kShift);
    }
    for (int y = firstEven(-side); y <= side; y += 2) {
      cv::line(image_, at({area_.back_m, y}), at({area_.front_m, y}), kFaint, 1, cv::LINE_AA,
               kShift);
    }
    circle({robot_.goal_m, 0.0}, 0.4, kRobot, 2);
    text("goal", {robot_.goal_m, -0.6}, 0.45, kRobot);
  }

  void circle(const Vector2d& centre, double radius_m, const cv::Scalar& colour, int thickness) {
    const int radius = static_cast<int>(radius_m * pixels_per_m_ * (1 << kShift));
    cv::circle(image_, at(centre), radius, colour, thickness, cv::LINE_AA, kShift);
  }

  void dot(const Vector2d& centre, int radius_px, const cv::Scalar& colour) {
    cv::circle(image_, at(centre), radius_px << kShift, colour, cv::FILLED, cv::LINE_AA, kShift);
  }

  void line(const Vector2d& from, const Vector2d& to, const cv::Scalar& colour, int thickness) {
    cv::line(image_, at(from), at(to), colour, thickness, cv::LINE_AA, kShift);
  }

  void robot(const mrpt::math::TPose2D& pose, const cv::Scalar& colour, int thickness) {
    std::vector<cv::Point> corners;
    const double x = 0.5 * robot_.length_m;
    const double y = 0.5 * robot_.width_m;
    for (const Vector2d& corner :
         {Vector2d(x, y), Vector2d(x, -y), Vector2d(-x, -y), Vector2d(-x, y)}) {
      const Vector2d turned = Eigen::Rotation2Dd(pose.phi) * corner;
      corners.push_back(at(Vector2d(pose.x, pose.y) + turned));
    }
    if (thickness == cv::FILLED) {
      cv::fillConvexPoly(image_, corners, colour, cv::LINE_AA, kShift);
    } else {
      cv::polylines(image_, corners, true, colour, thickness, cv::LINE_AA, kShift);
    }
  }

  void text(const std::string& words, const Vector2d& place, double size,
            const cv::Scalar& colour) {
    const cv::Point corner = at(place);
    cv::putText(image_, words, {corner.x >> kShift, corner.y >> kShift}, cv::FONT_HERSHEY_SIMPLEX,
                size, colour, 1, cv::LINE_AA);
  }

  void title(const std::string& name, const std::string& state, bool bad) {
    cv::rectangle(image_, {0, 0, image_.cols, kTitle}, kPaper, cv::FILLED);
    cv::putText(image_, name, {14, 27}, cv::FONT_HERSHEY_SIMPLEX, 0.75, kInk, 2, cv::LINE_AA);
    cv::putText(image_, state, {14, 52}, cv::FONT_HERSHEY_SIMPLEX, 0.5, bad ? kContact : kInk, 1,
                cv::LINE_AA);
    cv::line(image_, {0, kTitle}, {image_.cols, kTitle}, kFaint, 1);
  }

  /// Whether a position is in the drawn area.
  [[nodiscard]] bool shows(const Vector2d& place) const {
    const cv::Point p = at(place);
    return p.y >> kShift > kTitle && p.y >> kShift < kHeight - kLegend && p.x > 0 &&
           p.x >> kShift < image_.cols;
  }

 private:
  /// Pixel of a position, with kShift bits of fraction: x upwards, y to the left.
  [[nodiscard]] cv::Point at(const Vector2d& place) const {
    const double u = 0.5 * image_.cols - place.y() * pixels_per_m_;
    const double v = kHeight - kLegend - (place.x() - area_.back_m) * pixels_per_m_;
    return {cvRound(u * (1 << kShift)), cvRound(v * (1 << kShift))};
  }

  cv::Mat image_;
  RobotParams robot_;
  Area area_;
  double pixels_per_m_;
};

void label(cv::Mat& image, int& x, const std::string& words) {
  cv::putText(image, words, {x, kHeight - 20}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk, 1,
              cv::LINE_AA);
  int baseline = 0;
  x += cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, 0.48, 1, &baseline).width + 26;
}

/// Legend, scale bar and notes.
void drawLegend(cv::Mat& image, double pixels_per_m, const std::string& note) {
  cv::rectangle(image, {0, kHeight - kLegend, image.cols, kLegend}, kPaper, cv::FILLED);
  cv::line(image, {0, kHeight - kLegend}, {image.cols, kHeight - kLegend}, kFaint, 1);
  const int y = kHeight - 25;
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
  const int bar = static_cast<int>(2.0 * pixels_per_m);
  cv::line(image, {x, y}, {x + bar, y}, kInk, 2);
  x += bar + 8;
  label(image, x, "2 m");
  label(image, x, note);
}

cv::Mat blankPicture(std::size_t panels) {
  const int width = std::max(3, static_cast<int>(panels)) * kPanelWidth;
  return cv::Mat(kHeight, width + width % 2, CV_8UC3, kPaper);
}

cv::Mat panelOf(cv::Mat& picture, std::size_t index, std::size_t count) {
  const int width = picture.cols / static_cast<int>(count);
  return picture(cv::Rect(static_cast<int>(index) * width, 0, width, kHeight));
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

void drawPredictions(Panel& panel, const TrialMoment& moment) {
  for (const auto& track : moment.tracks) {
    if (track.status == TrackStatus::kTentative || track.predictions.empty()) continue;
    const auto& points = track.predictions.front().points;
    for (std::size_t i = 1; i < points.size(); i += 2) {
      panel.dot(points[i].position.head<2>(), 2, kPrediction);
    }
  }
}

void drawRecordAt(Panel& panel, const TrialRecord& record, double time_s) {
  const std::size_t last = momentAt(record, time_s);
  const TrialMoment& moment = record.moments[last];
  panel.drawGround();
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
  const bool contact = contactUntil(record, last);
  std::string state = secondsText("", moment.time_s);
  if (last + 1 == record.moments.size() && record.result.goal_reached) {
    state = secondsText("at the goal after ", moment.time_s);
  }
  if (contact) state += ", touched a person";
  panel.title(record.policy, state, contact);
}

void drawRecordWhole(Panel& panel, const TrialRecord& record) {
  panel.drawGround();
  const auto per_second = [&](std::size_t i) {
    return i == 0 || std::floor(record.moments[i].time_s + 1e-6) >
                         std::floor(record.moments[i - 1].time_s + 1e-6);
  };
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
  }
  for (std::size_t i = 0; i < record.moments.size(); ++i) {
    const TrialMoment& moment = record.moments[i];
    if (moment.contact) panel.robot(moment.robot, kContact, 2);
    if (!per_second(i)) continue;
    const std::string second = std::to_string(static_cast<int>(moment.time_s + 1e-6));
    panel.robot(moment.robot, kRobot, 1);
    panel.text(second, {moment.robot.x - 0.1, moment.robot.y - 0.4}, 0.4, kRobot);
    for (const auto& person : moment.people) {
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

}  // namespace

cv::Mat drawMoment(const std::vector<TrialRecord>& records, const RobotParams& robot,
                   double time_s) {
  cv::Mat picture = blankPicture(records.size());
  const Area area(records, robot);
  for (std::size_t i = 0; i < records.size(); ++i) {
    Panel panel(panelOf(picture, i, records.size()), robot, area);
    drawRecordAt(panel, records[i], time_s);
  }
  drawLegend(picture, area.pixelsPerMetre(), secondsText("time ", time_s));
  return picture;
}

cv::Mat drawWhole(const std::vector<TrialRecord>& records, const RobotParams& robot) {
  cv::Mat picture = blankPicture(records.size());
  const Area area(records, robot);
  for (std::size_t i = 0; i < records.size(); ++i) {
    Panel panel(panelOf(picture, i, records.size()), robot, area);
    drawRecordWhole(panel, records[i]);
  }
  drawLegend(picture, area.pixelsPerMetre(), "numbers: seconds; red: contact");
  return picture;
}

}  // namespace headway::app
