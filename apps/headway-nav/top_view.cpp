// SPDX-License-Identifier: BSD-3-Clause
#include "top_view.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "trial_panel.h"

namespace headway::app {
namespace {

using Eigen::Vector2d;

constexpr double kMarginM = 1.0;  // around a robot's centre

/// The whole way of the robot, with start and goal.
Eigen::AlignedBox2d boundsOf(const TrialRecord& record, const RobotParams& robot) {
  Eigen::AlignedBox2d bounds(Vector2d(0.0, 0.0));
  bounds.extend(Vector2d(robot.goal_m, 0.0));
  for (const auto& moment : record.moments) {
    bounds.extend(Vector2d(moment.robot.x, moment.robot.y));
  }
  const Vector2d margin(kMarginM, kMarginM);
  return {bounds.min() - margin, bounds.max() + margin};
}

void label(cv::Mat& image, int& x, const std::string& words) {
  cv::putText(image, words, {x, kPictureHeight - 20}, cv::FONT_HERSHEY_SIMPLEX, 0.48, kInk, 1,
              cv::LINE_AA);
  int baseline = 0;
  x += cv::getTextSize(words, cv::FONT_HERSHEY_SIMPLEX, 0.48, 1, &baseline).width + 26;
}

/// Legend and note.
void drawLegend(cv::Mat& image, const std::string& note) {
  cv::rectangle(image, {0, kPictureHeight - kLegendHeight, image.cols, kLegendHeight}, kPaper,
                cv::FILLED);
  cv::line(image, {0, kPictureHeight - kLegendHeight}, {image.cols, kPictureHeight - kLegendHeight},
           kFaint, 1);
  const int y = kPictureHeight - 25;
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
  label(image, x, note);
}

cv::Mat blankPicture(std::size_t panels) {
  const int width = std::max(3, static_cast<int>(panels)) * kPanelWidth;
  return cv::Mat(kPictureHeight, width + width % 2, CV_8UC3, kPaper);
}

cv::Mat panelOf(cv::Mat& picture, std::size_t index, std::size_t count) {
  const int width = picture.cols / static_cast<int>(count);
  return picture(cv::Rect(static_cast<int>(index) * width, 0, width, kPictureHeight));
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

void drawRecordAt(TrialPanel& panel, const TrialRecord& record, double time_s) {
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
  panel.drawGround();
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

}  // namespace

cv::Mat drawMoment(const std::vector<TrialRecord>& records, const RobotParams& robot,
                   double time_s) {
  cv::Mat picture = blankPicture(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    TrialPanel panel(panelOf(picture, i, records.size()), robot, boundsOf(records[i], robot));
    drawRecordAt(panel, records[i], time_s);
  }
  drawLegend(picture, secondsText("time ", time_s));
  return picture;
}

cv::Mat drawWhole(const std::vector<TrialRecord>& records, const RobotParams& robot) {
  cv::Mat picture = blankPicture(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    TrialPanel panel(panelOf(picture, i, records.size()), robot, boundsOf(records[i], robot));
    drawRecordWhole(panel, records[i]);
  }
  drawLegend(picture, "numbers: seconds; red: contact");
  return picture;
}

}  // namespace headway::app
