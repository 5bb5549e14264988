// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <fstream>

#include "replay_run.h"

namespace headway {
namespace {

const std::string kBrowser =
    "chromium --headless --no-sandbox --disable-gpu --hide-scrollbars "
    "--allow-file-access-from-files "
    "--virtual-time-budget=5000 --timeout=60000 ";

bool hasBrowser() { return test::runProcess("command -v chromium").status == 0; }

/// How wide a browser lays out a page in a window, and how many things it fetched besides the page,
/// as "width=... fetched=...".
std::string layoutOf(const std::filesystem::path& page, int window_width) {
  const auto frame = page.parent_path() / "frame.html";
  std::ofstream(frame) << "<body><iframe id=f src='" << page.filename().string()
                       << "' width=" << window_width << " height=900 style='border:0' onload=\""
                       << "const w=f.contentWindow;document.title='width='+"
                       << "w.document.documentElement.scrollWidth+' fetched='+"
                       << "w.performance.getEntriesByType('resource')"
                       << ".filter(e=>!e.name.startsWith('data:')).length\"></iframe>";
  const auto shown = test::runProcess(kBrowser + "--dump-dom file://" + frame.string());
  const auto start = shown.output.find("<title>");
  const auto end = shown.output.find("</title>");
  if (end == std::string::npos) return "no page was laid out: " + shown.output;
  return shown.output.substr(start + 7, end - start - 7);
}

/// The page of a replay with many tracks and pictures, in a browser.
TEST(ReportPageTest, FitsALaptopAndAPhoneWithoutANetwork) {
  if (!hasBrowser()) GTEST_SKIP() << "chromium is not installed";
  const test::TemporaryFolder folder;
  const auto run = test::replay(std::string(HEADWAY_SOURCE_DIR) + "/rawlogs/street.rawlog",
                                folder / "out", "--to-index 60 --snapshots 3 -q");
  ASSERT_EQ(0, run.process.status) << run.process.output;
  for (const int width : {360, 390, 768, 1280}) {
    EXPECT_EQ("width=" + std::to_string(width) + " fetched=0",
              layoutOf(run.file("report.html"), width));
  }
}

TEST(ReportPageTest, DetectsAWidePage) {
  if (!hasBrowser()) GTEST_SKIP() << "chromium is not installed";
  const test::TemporaryFolder folder;
  std::ofstream(folder / "report.html") << "<body style='margin:0'><div style='width:700px'>wide";
  EXPECT_EQ("width=700 fetched=0", layoutOf(folder / "report.html", 390));
}

}  // namespace
}  // namespace headway
