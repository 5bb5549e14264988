#include <headway/eval/prediction_error.h>
#include <headway/eval/text_table.h>
#include <headway/eval/track_error.h>
#include <headway/eval/trajectory_error.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

namespace headway::eval {
namespace {

/// Columns of a terminal that UTF-8 text takes: its code points.
std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), [](char c) {
    return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
  }));
}

std::vector<std::size_t> columnWidths(const TextTable& table) {
  std::vector<std::size_t> widths;
  for (const auto& row : table) {
    widths.resize(std::max(widths.size(), row.size()), 3);
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], widthOf(row[i]));
  }
  return widths;
}

void writeRow(std::ostream& out, const std::vector<std::string>& row,
              const std::vector<std::size_t>& widths) {
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string cell = i < row.size() ? row[i] : "—";
    const std::string blank(widths[i] - widthOf(cell), ' ');
    out << "| " << (i == 0 ? cell + blank : blank + cell) << " ";
  }
  out << "|\n";
}

std::string percent(std::optional<double> share) {
  if (share) share = 100.0 * *share;
  return fixedText(share, 2);
}

std::vector<std::string> rowOf(const std::string& name, const TrackError& error) {
  return {name,
          fixedText(error.rmse_m, 3),
          percent(error.precision),
          percent(error.recall),
          percent(error.f1),
          percent(error.mota),
          percent(error.motp),
          std::to_string(error.idsw),
          std::to_string(error.frag),
          percent(error.hota),
          percent(error.deta),
          percent(error.assa),
          percent(error.samota),
          percent(error.amota)};
}

std::vector<std::string> rowOf(const std::string& name, const PredictionError& error) {
  std::vector<std::string> row = {name, std::to_string(error.cases), fixedText(error.ade_m, 3),
                                  fixedText(error.fde_m, 3), fixedText(error.best_of_k_ade_m, 3)};
  for (const auto& rate : error.miss_rate) row.push_back(percent(rate));
  for (const auto& share : error.coverage[1]) row.push_back(percent(share));
  row.push_back(fixedText(error.nees, 2));
  return row;
}

/// Headings, one row for each class, one for all.
template <typename Errors>
TextTable byClass(std::vector<std::string> headings, const Errors& errors) {
  TextTable table = {std::move(headings)};
  for (const auto& [object_class, error] : errors.classes) {
    table.push_back(rowOf(std::string(toString(object_class)), error));
  }
  table.push_back(rowOf("all", errors.all));
  return table;
}

}  // namespace

void writeTable(std::ostream& out, const TextTable& table) {
  const auto widths = columnWidths(table);
  for (std::size_t r = 0; r < table.size(); ++r) {
    writeRow(out, table[r], widths);
    if (r > 0) continue;
    for (std::size_t i = 0; i < widths.size(); ++i) {
      out << "| " << std::string(widths[i] - 1, '-') << (i == 0 ? "- " : ": ");
    }
    out << "|\n";
  }
}

std::string fixedText(std::optional<double> value, int decimals) {
  if (!value || !std::isfinite(*value)) return "—";
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.*f", decimals, *value);
  return text.data();
}

TextTable tableOf(const TrajectoryError& error) {
  const auto& ate = error.ate_m;
  TextTable table = {{"figure", "value", "unit"}};
  table.push_back({"frames matched",
                   std::to_string(error.frames_matched) + " of " + std::to_string(error.frames),
                   ""});
  table.push_back({"true path", fixedText(error.path_m, 2), "m"});
  table.push_back({"path ratio", fixedText(error.path_ratio, 4), ""});
  table.push_back({"ATE RMSE", fixedText(ate.rmse, 4), "m"});
  table.push_back({"ATE mean", fixedText(ate.mean, 4), "m"});
  table.push_back({"ATE standard deviation", fixedText(ate.sd, 4), "m"});
  table.push_back({"ATE median", fixedText(ate.median, 4), "m"});
  table.push_back({"ATE maximum", fixedText(ate.max, 4), "m"});
  table.push_back({"RPE translation RMSE, a frame", fixedText(error.rpe_trans_rmse_m, 4), "m"});
  table.push_back({"RPE rotation RMSE, a frame", fixedText(error.rpe_rot_rmse_deg, 4), "deg"});
  const auto& kitti = error.kitti;
  table.push_back({"KITTI translation", kitti ? fixedText(kitti->trans_percent, 3) : "—", "%"});
  table.push_back({"KITTI rotation", kitti ? fixedText(kitti->rot_deg_per_m, 5) : "—", "deg/m"});
  if (error.scale != 1.0) table.push_back({"scale", fixedText(error.scale, 5), ""});
  return table;
}

TextTable tableOf(const TrackErrors& errors) {
  return byClass({"class", "RMSE m", "prec %", "recall %", "F1 %", "MOTA %", "MOTP %", "IDSW",
                  "FRAG", "HOTA %", "DetA %", "AssA %", "sAMOTA %", "AMOTA %"},
                 errors);
}

TextTable positionTable(const TrackErrors& raw, const TrackErrors& tracks) {
  TextTable table = {{"class", "RMSE m", "precision %", "recall %", "F1 %"}};
  const auto add = [&table](const std::string& name, const TrackError& a, const TrackError& b) {
    table.push_back({name, fixedText(a.rmse_m, 3) + " / " + fixedText(b.rmse_m, 3),
                     percent(a.precision) + " / " + percent(b.precision),
                     percent(a.recall) + " / " + percent(b.recall),
                     percent(a.f1) + " / " + percent(b.f1)});
  };
  for (const auto& [object_class, error] : raw.classes) {
    add(std::string(toString(object_class)), error, tracks.classes.at(object_class));
  }
  add("all", raw.all, tracks.all);
  return table;
}

TextTable tableOf(const PredictionErrors& errors) {
  return byClass({"class", "cases", "ADE m", "FDE m", "best ADE m", "miss 1s %", "miss 2s %",
                  "miss 3s %", "in 90% 1s", "in 90% 2s", "in 90% 3s", "NEES"},
                 errors);
}

}  // namespace headway::eval
