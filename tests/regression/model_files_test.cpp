// SPDX-License-Identifier: BSD-3-Clause
// Networks' files: checked on a bundled frame, and downloaded from a server.
#include <gmock/gmock.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <headway_test/waiting.h>
#include <signal.h>

#include <filesystem>
#include <fstream>

#include "plain_rawlog.h"

namespace headway {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;

TEST(CheckModelTest, NeedsNeitherInputNorOutput) {
  const std::string command = test::program("headway-replay") + " --check-model ";
  const auto missing = test::runProcess(command + "/nowhere/yolox.onnx");
  EXPECT_EQ(1, missing.status);
  EXPECT_THAT(missing.output, HasSubstr("/nowhere/yolox.onnx: no such file"));
  EXPECT_EQ(2, test::runProcess(command + "yolox.onnx -i in.rawlog").status);
  EXPECT_EQ(2, test::runProcess(test::program("headway-replay") + " -q").status);
  HEADWAY_REQUIRE_DATA(data);
  const auto run = test::runProcess(command + (data / "models" / "yolox_nano.onnx").string());
  EXPECT_EQ(0, run.status) << run.output;
  EXPECT_THAT(run.output, AllOf(HasSubstr("SHA-256: "), HasSubstr("classes: coco"),
                                HasSubstr(" ms"), HasSubstr("Car "), HasSubstr("Pedestrian ")));
}

/// A folder served on the loopback, and a home to install in.
class GetModelTest : public ::testing::Test {
 protected:
  GetModelTest() {
    fs::create_directories(served_);
    const auto log = (folder_ / "server.log").string();
    const auto start = test::runProcess("cd " + served_.string() +
                                        " && python3 -u -m http.server 0 --bind 127.0.0.1 > " +
                                        log + " 2>&1 & echo $!");
    server_ = std::stoi(start.output);
    const std::string before = "port ";
    test::waitUntil([&] { return test::contentsOf(log).find(before) != std::string::npos; });
    const std::string line = test::contentsOf(log);
    url_ = "http://127.0.0.1:" +
           std::to_string(std::stoi(line.substr(line.find(before) + before.size())));
  }
  ~GetModelTest() override { kill(server_, SIGTERM); }

  test::ProcessResult get(const std::string& url, const std::string& options = "yolox_nano") {
    return test::runProcess("HEADWAY_MODELS_MIRROR=" + url + " XDG_DATA_HOME=" + home_.string() +
                            " " + test::program("headway-replay") + " --get-model " + options);
  }

  void serve(const std::string& bytes) { std::ofstream(served_ / "yolox_nano.onnx") << bytes; }

  test::TemporaryFolder folder_;
  const fs::path served_ = folder_ / "served", home_ = folder_ / "home";
  const fs::path installed_ = home_ / "headway" / "models" / "yolox_nano.onnx";
  std::string url_;
  pid_t server_ = 0;
};

TEST_F(GetModelTest, InstallsNothingButTheModelItself) {
  serve("another network");
  const auto wrong = get(url_);
  EXPECT_EQ(1, wrong.status);
  EXPECT_THAT(wrong.output, AllOf(HasSubstr("licence Apache-2.0, 3.7 MB"), HasSubstr("SHA-256 is "),
                                  HasSubstr("nothing was installed")));
  EXPECT_TRUE(fs::is_empty(installed_.parent_path()));
  serve(std::string(4'000'000, 'x'));
  EXPECT_THAT(get(url_).output, HasSubstr("it is larger than the model"));
  EXPECT_TRUE(fs::is_empty(installed_.parent_path()));
  EXPECT_THAT(get(url_ + "/elsewhere").output, HasSubstr("the server does not have it"));
  const auto offline = get("http://127.0.0.1:1");
  EXPECT_EQ(1, offline.status);
  EXPECT_THAT(offline.output, AllOf(HasSubstr("no connection; offline, copy the file to "),
                                    HasSubstr(installed_.parent_path().string())));
}

TEST_F(GetModelTest, RefusesWhatItDoesNotKnow) {
  EXPECT_EQ(2, get(url_, "resnet").status);
  EXPECT_EQ(2, get(url_, "yolox_nano -i in.rawlog").status);
  fs::create_directories(installed_.parent_path());
  std::ofstream(installed_) << "mine";
  const auto other = get(url_);
  EXPECT_EQ(1, other.status);
  EXPECT_THAT(other.output, HasSubstr("is another file; remove it first"));
  EXPECT_EQ("mine", test::contentsOf(installed_));
}

TEST_F(GetModelTest, InstallsItWhereAutoFindsIt) {
  HEADWAY_REQUIRE_DATA(data);
  fs::copy_file(data / "models" / "yolox_nano.onnx", served_ / "yolox_nano.onnx");
  const auto first = get(url_);
  EXPECT_EQ(0, first.status) << first.output;
  EXPECT_THAT(first.output, HasSubstr("installed: " + installed_.string()));
  EXPECT_THAT(get(url_).output, HasSubstr("is there already"));
  const std::string rawlog = (folder_ / "in.rawlog").string();
  test::writePlainRawlog(rawlog);
  const auto run =
      test::runProcess("XDG_DATA_HOME=" + home_.string() + " " + test::program("headway-replay") +
                       " --snapshots 0 -i " + rawlog + " -o " + (folder_ / "out").string());
  EXPECT_THAT(run.output, HasSubstr("detector: network " + installed_.string()));
}

}  // namespace
}  // namespace headway
