// SPDX-License-Identifier: BSD-3-Clause
// Each program on files that are read and written at once, and on a full standard output.
#include <gmock/gmock.h>
#include <headway_test/folders.h>
#include <headway_test/paths.h>
#include <headway_test/process.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace headway::program {
namespace {

/// Arguments and options with a value of a command, as its help lists them.
struct Command {
  std::string call;
  std::set<std::string> arguments, options, required, outputs;
  bool overwrites = false;
};

std::vector<std::string> linesOf(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

Command commandOf(const std::string& call, const std::string& help) {
  const std::set<std::string> outputs = {"--output", "--json",  "--plot",
                                         "--record", "--video", "--worst"};
  Command command;
  command.call = call;
  command.overwrites = help.find("--overwrite") != std::string::npos;
  const std::string usage = help.substr(0, help.find("\n\n"));
  bool is_argument = false;
  for (const std::string& line : linesOf(help)) {
    std::smatch found;
    if (line == "Arguments:") is_argument = true;
    if (line == "Options:") is_argument = false;
    if (is_argument && std::regex_search(line, found, std::regex("^  (\\S+)"))) {
      command.arguments.insert(found[1]);
    }
    const std::regex option("^  (?:(-\\w), |    )(--[a-z-]+) (\\S+)");
    if (!std::regex_search(line, found, option)) continue;
    const std::string name = found[2];
    (outputs.count(name) > 0 ? command.outputs : command.options).insert(name);
    const std::string in_usage = " " + (found[1].matched ? found[1].str() : name) + " ";
    if (usage.find(in_usage) != std::string::npos) command.required.insert(name);
  }
  for (const char* no_file : {"--set", "--verbosity"}) command.options.erase(no_file);
  return command;
}

std::vector<Command> allCommands() {
  std::vector<Command> commands;
  for (const char* name : {"eval", "export", "import", "live", "nav", "render", "replay", "sim"}) {
    const std::string call = test::program(std::string("headway-") + name);
    const std::string help = test::runProcess(call + " --help").output;
    const auto subcommands = help.find("Sub-commands:\n");
    if (subcommands == std::string::npos) {
      commands.push_back(commandOf(call, help));
      continue;
    }
    for (const std::string& line : linesOf(help.substr(subcommands))) {
      std::smatch found;
      if (!std::regex_search(line, found, std::regex("^  (\\S+)"))) continue;
      const std::string sub = call + " " + found[1].str();
      commands.push_back(commandOf(sub, test::runProcess(sub + " --help").output));
    }
  }
  return commands;
}

class ProtectedInputsTest : public testing::Test {
 protected:
  /// Runs a command that reads and writes the same file by these options.
  ///
  /// @param input  an option, or an argument
  test::ProcessResult run(const Command& command, const std::string& input,
                          const std::string& output) {
    std::ofstream(file_) << "kept\n";
    std::ofstream(other_) << "kept\n";
    std::string line = command.call;
    for (const std::string& name : command.required) {
      if (name != input && name != output) line += " " + name + " " + other_;
    }
    for (const std::string& name : command.arguments) {
      line += " " + (name == input ? file_ : other_);
    }
    if (command.options.count(input) > 0) line += " " + input + " " + file_;
    return test::runProcess(line + " " + output + " " + file_ + (command.overwrites ? " -w" : "") +
                            " </dev/null");
  }

  const test::TemporaryFolder folder_;
  const std::string file_ = folder_ / "file.png", other_ = folder_ / "other";
};

TEST_F(ProtectedInputsTest, AreNeverOutputs) {
  int refused = 0;
  for (const Command& command : allCommands()) {
    std::set<std::string> inputs = command.options;
    inputs.insert(command.arguments.begin(), command.arguments.end());
    for (const std::string& output : command.outputs) {
      int refused_here = 0;
      for (const std::string& input : inputs) {
        const auto result = run(command, input, output);
        SCOPED_TRACE(command.call + " " + input + " FILE " + output + " FILE: " + result.output);
        EXPECT_EQ("kept\n", test::contentsOf(file_));
        const bool is_number = result.output.find("Couldn't read argument") != std::string::npos;
        if (is_number) continue;
        EXPECT_EQ(1, result.status);
        EXPECT_THAT(result.output, testing::HasSubstr("is an input and would be overwritten"));
        ++refused_here;
      }
      EXPECT_GT(refused_here, 0) << command.call << " " << output;
      refused += refused_here;
    }
  }
  EXPECT_GT(refused, 100);
}

/// Of a run, or of truth.
TEST(ProtectedFoldersTest, TheirFilesAreInputs) {
  const test::TemporaryFolder folder;
  const std::string read = folder.path().string(), bundled = HEADWAY_SOURCE_DIR "/rawlogs/hall";
  std::filesystem::copy(bundled + ".truth", read, std::filesystem::copy_options::recursive);
  for (const char* name : {"map_grid.png", "map_grid.yaml", "tracks.csv"})
    std::ofstream(folder / name) << "kept\n";
  std::ofstream(folder / "notes.json") << "old\n";
  const auto contents = [&] {
    std::map<std::string, std::string> files;
    for (const char* name :
         {"trajectory.tum", "objects.csv", "map_grid.png", "map_grid.yaml", "tracks.csv"}) {
      files[name] = test::contentsOf(folder / name);
    }
    return files;
  };
  const auto before = contents();
  for (const std::string& call :
       {"headway-replay -q -i " + bundled + ".rawlog --truth " + read + " -w -o " + read,
        "headway-eval people " + read + " --truth x --json " + read + "/tracks.csv -w",
        "headway-eval grid --truth " + read + " --estimate x --json " + read + "/objects.csv -w",
        "headway-export rosmap " + read + " -w -o " + read + "/map_grid.yaml",
        "headway-render -i " + read + " -w -o " + read + "/map_grid.png"}) {
    SCOPED_TRACE(call);
    const auto space = call.find(' ');
    const auto result = test::runProcess(test::program(call.substr(0, space)) + call.substr(space));
    EXPECT_EQ(1, result.status);
    EXPECT_THAT(result.output, testing::HasSubstr("is an input and would be "));
    EXPECT_EQ(before, contents());
  }
  const auto other = test::runProcess(test::program("headway-eval") + " people " + read +
                                      " --truth x --json " + read + "/notes.json -w");
  EXPECT_THAT(other.output, testing::Not(testing::HasSubstr("is an input")));
}

TEST(ProtectedFoldersTest, FilesOfADatasetOrABagAreInputs) {
  const test::TemporaryFolder folder;
  for (const char* name :
       {"left/0.png", "right/0.png", "lens.yaml", "bag/metadata.yaml", "bag/0.mcap"}) {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << "kept\n";
  }
  const std::string root = folder.path().string() + "/";
  for (const std::string& call :
       {"images --left " + root + "left --right " + root + "right --calibration " + root +
            "lens.yaml -w -o " + root + "left/0.png",
        "rosbag " + root + "bag -w -o " + root + "bag/0.mcap"}) {
    const auto result = test::runProcess(test::program("headway-import") + " " + call);
    EXPECT_EQ(1, result.status);
    EXPECT_THAT(result.output, testing::HasSubstr("is an input and would be overwritten")) << call;
  }
  for (const char* name : {"left/0.png", "bag/0.mcap"}) {
    EXPECT_EQ("kept\n", test::contentsOf(folder / name));
  }
  std::ofstream(folder / "bag/old.rawlog") << "of an import before\n";
  const auto again = test::runProcess(test::program("headway-import") + " rosbag " + root +
                                      "bag -w -o " + root + "bag/old.rawlog");
  EXPECT_THAT(again.output, testing::Not(testing::HasSubstr("is an input")));
}

TEST(ProtectedFoldersTest, ARawlogThatADriverPlaysIsAnInput) {
  const test::TemporaryFolder folder;
  const std::string rawlog = folder / "played.rawlog", sensors = folder / "sensors.ini";
  std::ofstream(rawlog) << "kept\n";
  std::ofstream(sensors)
      << "[camera]\ndriver = CCameraSensor\ngrabber_type = rawlog\nrawlog_file = " << rawlog
      << "\n";
  const auto result =
      test::runProcess(test::program("headway-live") + " --sensors " + sensors + " -o " +
                       (folder / "out").string() + " -w --record " + rawlog);
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, testing::HasSubstr("is an input and would be overwritten"));
  EXPECT_EQ("kept\n", test::contentsOf(rawlog));
}

TEST(ProtectedFoldersTest, WhatAParameterNamesIsAnInput) {
  const test::TemporaryFolder folder;
  const std::string network = folder / "network.onnx";
  std::ofstream(network) << "kept\n";
  std::ofstream(folder / "sensors.ini") << "[sensor]\n";
  const auto result = test::runProcess(
      test::program("headway-live") + " --sensors " + (folder / "sensors.ini").string() + " -o " +
      (folder / "out").string() + " -w --record " + network + " --set dnn.model=" + network);
  EXPECT_EQ(1, result.status);
  EXPECT_THAT(result.output, testing::HasSubstr("is an input and would be overwritten"));
  EXPECT_EQ("kept\n", test::contentsOf(network));
}

TEST(StandardOutputTest, IsWrittenWholeOrAnError) {
  for (const Command& command : allCommands()) {
    const auto full = test::runProcess("(" + command.call + " --help >/dev/full)");
    EXPECT_EQ(1, full.status) << command.call;
    EXPECT_THAT(full.output, testing::HasSubstr("standard output: not written completely"));
  }
}

}  // namespace
}  // namespace headway::program
