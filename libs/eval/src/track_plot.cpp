#include <headway/eval/chart.h>
#include <headway/eval/text_table.h>
#include <headway/eval/track_plot.h>

namespace headway::eval {
namespace {

using Points = std::vector<Eigen::Vector2d>;

Points over(const std::vector<RecallPoint>& curve, double RecallPoint::*figure) {
  Points points;
  for (const auto& point : curve) points.emplace_back(100.0 * point.recall, 100.0 * point.*figure);
  return points;
}

}  // namespace

cv::Mat trackPlot(const TrackErrors& errors) {
  ChartFrame frame{"Accuracy over recall", "recall [%]", "MOTA, sMOTA [%]", {0, 100}, {0, 100}};
  for (const auto& [object_class, error] : errors.classes) {
    for (const auto& point : error.curve) frame.y.include(std::max(-100.0, 100.0 * point.mota));
  }
  Chart chart(frame);
  std::size_t number = 0;
  for (const auto& [object_class, error] : errors.classes) {
    const Colour colour = categoryColour(number++);
    const std::string name(toString(object_class));
    const auto percent = [](std::optional<double> share) {
      return share ? fixedText(100.0 * *share, 1) : fixedText(share, 1);
    };
    chart.line(over(error.curve, &RecallPoint::smota), colour, 2.4);
    chart.line(over(error.curve, &RecallPoint::mota), colour, 2.0, LineStyle::kDashed);
    chart.legend(name + " sMOTA (sAMOTA " + percent(error.samota) + ")", colour);
    chart.legend(name + " MOTA (best " + percent(error.mota) + ")", colour, LineStyle::kDashed);
  }
  return chart.picture();
}

}  // namespace headway::eval
