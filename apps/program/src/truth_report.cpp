// SPDX-License-Identifier: BSD-3-Clause
// The report of a finished replay with its errors against the truth.
#include <headway/core/error.h>
#include <headway/io/trajectory_file.h>
#include <headway/program/truth_report.h>
#include <headway/report/report.h>
#ifdef HEADWAY_WITH_EVAL
#include <headway/eval/trajectory_error.h>
#include <headway/plot/text_table.h>
#endif

namespace headway::program {
namespace {

#ifdef HEADWAY_WITH_EVAL

constexpr double kSameTimeS = 0.02;

/// Errors of the final trajectory after rigid alignment.
///
/// @throws InputError if there are too few poses of equal times
std::vector<report::Figure> errorsOf(const std::filesystem::path& replay,
                                     const std::filesystem::path& truth) {
  const auto error =
      eval::trajectoryError(eval::pairByTime(io::readTum(truth / "trajectory.tum"),
                                             io::readTum(replay / "trajectory.tum"), kSameTimeS),
                            {});
  return {
      {"Frames compared", std::to_string(error.frames_matched)},
      {"True path", plot::fixedText(error.path_m, 1) + " m"},
      {"Absolute trajectory error, RMSE", plot::fixedText(error.ate_m.rmse, 3) + " m"},
      {"Absolute trajectory error, median", plot::fixedText(error.ate_m.median, 3) + " m"},
      {"Absolute trajectory error, maximum", plot::fixedText(error.ate_m.max, 3) + " m"},
      {"Relative pose error per frame", plot::fixedText(error.rpe_trans_rmse_m, 4) + " m, " +
                                            plot::fixedText(error.rpe_rot_rmse_deg, 4) + " deg"}};
}

#else

std::vector<report::Figure> errorsOf(const std::filesystem::path&, const std::filesystem::path&) {
  throw InputError("headway was built without evaluation (HEADWAY_BUILD_EVAL=OFF)");
}

#endif

}  // namespace

void writeTruthReport(const std::filesystem::path& replay, const std::filesystem::path& truth,
                      const std::filesystem::path& output, const std::string& title,
                      const std::function<void(const std::string&)>& note) {
  report::ReportOptions page;
  page.output = output;
  page.title = title;
  page.truth = truth;
  if (!truth.empty()) {
    try {
      page.errors = errorsOf(replay, truth);
    } catch (const InputError& error) {
      note(std::string("no errors computed: ") + error.what());
    }
  }
  report::writeReport(replay, page);
}

}  // namespace headway::program
