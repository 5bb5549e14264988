#include <headway/core/error.h>
#include <headway/eval/trajectory_error.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/truth_report.h>
#include <headway/report/report.h>

#include <cstdio>

namespace headway::program {
namespace {

constexpr double kSameTimeS = 0.02;

std::string formatted(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// Errors of the final trajectory after rigid alignment.
///
/// @throws InputError where there are too few pairs of one time
std::vector<report::Figure> errorsOf(const std::filesystem::path& replay,
                                     const std::filesystem::path& truth) {
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
}

}  // namespace

void writeTruthReport(const std::filesystem::path& replay, const std::filesystem::path& truth,
                      const std::filesystem::path& output,
                      const std::function<void(const std::string&)>& note) {
  report::ReportOptions page;
  page.output = output;
  page.truth = truth;
  if (!truth.empty()) {
    try {
      page.errors = errorsOf(replay, truth);
    } catch (const InputError& error) {
      note(std::string("no errors worked out: ") + error.what());
    }
  }
  report::writeReport(replay, page);
}

}  // namespace headway::program
