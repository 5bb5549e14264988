#include "report_page.h"

#include <headway/core/error.h>
#include <headway/eval/trajectory_error.h>
#include <headway/io/trajectory_file.h>
#include <headway/report/report.h>

#include <cstdio>

namespace headway::render_program {
namespace {

constexpr double kSameTimeS = 0.02;

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Errors of the final trajectory after rigid alignment; none where there are too few pairs.
std::vector<report::Figure> errorsOf(const Options& options, const Note& note) {
  const std::filesystem::path replay(options.input), truth(options.truth);
  try {
    const auto error =
        eval::trajectoryError(eval::pairByTime(io::readTum(truth / "trajectory.tum"),
                                               io::readTum(replay / "trajectory.tum"), kSameTimeS),
                              {});
    return {{"Frames compared", std::to_string(error.frames_matched)},
            {"True path", formatted("%.1f m", error.path_m)},
            {"Absolute trajectory error, RMSE", formatted("%.3f m", error.ate_m.rmse)},
            {"its median", formatted("%.3f m", error.ate_m.median)},
            {"its maximum", formatted("%.3f m", error.ate_m.max)},
            {"Relative pose error a frame", formatted("%.4f m", error.rpe_trans_rmse_m) + ", " +
                                                formatted("%.4f deg", error.rpe_rot_rmse_deg)}};
  } catch (const InputError& error) {
    note(std::string("no errors worked out: ") + error.what());
    return {};
  }
}

}  // namespace

void writeReportPage(const Options& options, const Note& note) {
  report::ReportOptions page;
  page.output = options.output;
  page.truth = options.truth;
  if (!options.truth.empty()) page.errors = errorsOf(options, note);
  report::writeReport(options.input, page);
}

}  // namespace headway::render_program
