// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/version.h>
#include <headway/program/command_line.h>
#include <headway/program/files.h>
#include <headway_test/folders.h>

#include <cstring>
#include <filesystem>
#include <fstream>

namespace headway::program {
namespace {

bool parse(CommandLine& line, std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "program");
  return line.parse(static_cast<int>(arguments.size()), arguments.data());
}

TEST(CommandLineTest, ReadsArgumentsAndKeepsDefaults) {
  std::string input;
  std::string output = "default";
  bool overwrite = false;
  std::optional<std::size_t> from;
  CommandLine line("program", "Summary");
  line.positional(input, "IN", "input");
  line.option(output, 'o', "output", "FILE", "output");
  line.flag(overwrite, 'w', "overwrite", "overwrite");
  line.option(from, 0, "from-index", "N", "first");
  EXPECT_TRUE(parse(line, {"a.rawlog", "-w", "--from-index", "12", "-q"}));
  EXPECT_EQ("a.rawlog", input);
  EXPECT_EQ("default", output);
  EXPECT_TRUE(overwrite);
  EXPECT_EQ(12u, from);
  EXPECT_TRUE(line.quiet());
}

TEST(CommandLineTest, AnEmptyValueTakesNoOtherWordAndTwoHyphensEndTheOptions) {
  std::string input, label = "default";
  bool overwrite = false;
  const auto read = [&](std::vector<const char*> words) {
    CommandLine line("program", "Summary");
    line.positional(input, "FILE", "Input");
    line.option(label, 'l', "label", "LABEL", "Its label");
    line.flag(overwrite, 'w', "overwrite", "Overwrite files");
    return parse(line, std::move(words));
  };
  EXPECT_TRUE(read({"a", "--label=", "-w"}));
  EXPECT_EQ("", label);
  EXPECT_TRUE(overwrite);
  EXPECT_TRUE(read({"--label", "b", "--", "-a"}));
  EXPECT_EQ("-a", input);
  try {
    (void)read({"a", "--overwrite=yes", "-l", "b"});
    FAIL() << "a flag has no value";
  } catch (const UsageError& error) {
    EXPECT_EQ(nullptr, std::strstr(error.what(), "label")) << error.what();
  }
}

TEST(CommandLineTest, ConfigurationFileThenSet) {
  test::TemporaryFolder folder;
  std::ofstream(folder / "x.ini") << "[a]\nx = 2\ny = 3\n";
  double x = 1.0;
  double y = 1.0;
  Params params;
  params.section("a").add("x", x, 0, 10, "m", "x");
  params.section("a").add("y", y, 0, 10, "m", "y");
  CommandLine line("program", "Summary");
  line.parameters(params);
  const std::string config = folder / "x.ini";
  EXPECT_TRUE(parse(line, {"--set", "a.y=7", "-c", config.c_str()}));
  EXPECT_EQ(2.0, x);
  EXPECT_EQ(7.0, y);
}

TEST(CommandLineTest, AFormerKeyIsSaidOnceOnStandardError) {
  double x = 1.0;
  Params params;
  auto section = params.section("a");
  section.add("x_m", x, 0, 10, "m", "x");
  section.renamed("x", "x_m");
  CommandLine line("program", "Summary");
  line.parameters(params);
  testing::internal::CaptureStderr();
  EXPECT_TRUE(parse(line, {"--set", "a.x=7", "--set", "a.x=8"}));
  EXPECT_EQ(8.0, x);
  EXPECT_EQ("program: [a] x is now x_m; the former name has an effect until version 0.5\n",
            testing::internal::GetCapturedStderr());
}

TEST(CommandLineTest, WrongUseIsAUsageErrorAndWrongValueAnInputError) {
  std::string input;
  double x = 1.0;
  Params params;
  params.section("a").add("x", x, 0, 10, "m", "x");
  const auto parsed = [&](std::vector<const char*> arguments) {
    CommandLine line("program", "Summary");
    line.option(input, 'i', "input", "FILE", "input", true);
    line.parameters(params);
    return parse(line, arguments);
  };
  EXPECT_THROW((void)parsed({}), UsageError);
  EXPECT_THROW((void)parsed({"-i", "x", "--unknown"}), UsageError);
  EXPECT_THROW((void)parsed({"-i", "x", "-v", "LOUD"}), UsageError);
  EXPECT_THROW((void)parsed({"-i", "x", "--set", "a.z=1"}), InputError);
  EXPECT_THROW((void)parsed({"-i", "x", "-c", "/nowhere.ini"}), InputError);
}

TEST(CommandLineTest, ErrorsNameTheOption) {
  const auto errorOf = [](std::vector<const char*> arguments) -> std::string {
    std::string input, output, label;
    double factor = 0.0;
    bool overwrite = false;
    std::optional<std::size_t> first;
    CommandLine line("program", "Summary");
    line.positional(input, "IN", "input");
    line.option(output, 'o', "output", "FILE", "output", true);
    line.option(label, 0, "label", "NAME", "label", true);
    line.option(factor, 0, "factor", "X", "factor");
    line.option(first, 0, "first", "N", "first");
    line.flag(overwrite, 'w', "overwrite", "overwrite");
    try {
      return parse(line, std::move(arguments)) ? "read" : "done";
    } catch (const UsageError& error) {
      return error.what();
    }
  };
  const std::string hint = " (--help shows the options)";
  EXPECT_EQ(errorOf({}), "IN, -o/--output, --label: are required" + hint);
  EXPECT_EQ(errorOf({"a", "-o", "b"}), "--label: is required" + hint);
  EXPECT_EQ(errorOf({"a", "-o", "b", "--label"}),
            "Argument: (--label): Missing a value for this argument!" + hint);
  EXPECT_EQ(errorOf({"--label", "c", "a", "-o"}),
            "Argument: -o (--output): Missing a value for this argument!" + hint);
  EXPECT_EQ(errorOf({"-o", "b", "-o", "c"}),
            "Argument: -o (--output): Argument already set!" + hint);
  EXPECT_EQ(errorOf({"-w", "-w"}), "Argument: -w (--overwrite): Argument already set!" + hint);
  for (const char* bad : {"x", "1x", "0x10", "1,5", "nan", "", "1 "}) {
    EXPECT_EQ(errorOf({"--factor", bad}),
              "Argument: (--factor): Couldn't read argument value from string '" +
                  std::string(bad) + "'" + hint);
  }
  EXPECT_EQ(errorOf({"--first", "-1"}), "--first must not be negative");
  for (const char* unknown : {"--bogus", "-Z"}) {
    EXPECT_EQ(errorOf({unknown}),
              std::string("Argument: ") + unknown + ": Couldn't find match for argument" + hint);
  }
  EXPECT_EQ(errorOf({"a", "stray"}), "Argument: stray: Couldn't find match for argument" + hint);
  EXPECT_EQ(errorOf({"a", "-wo", "b", "--label=c", "--factor", "-1.5e2"}), "read");
}

TEST(CommandLineTest, DumpConfigNeedsNothingElse) {
  std::string input;
  double x = 1.0;
  Params params;
  params.section("a").user().add("x", x, 0, 10, "m", "meaning of x");
  CommandLine line("program", "Summary");
  line.option(input, 'i', "input", "FILE", "input", true);
  line.parameters(params);
  ::testing::internal::CaptureStdout();
  EXPECT_FALSE(parse(line, {"--dump-config", "--set", "a.x=4"}));
  EXPECT_THAT(
      ::testing::internal::GetCapturedStdout(),
      ::testing::AllOf(::testing::HasSubstr("meaning of x"), ::testing::HasSubstr("x = 4")));
}

TEST(CommandLineTest, LaterConfigurationFilesWin) {
  test::TemporaryFolder folder;
  std::ofstream(folder / "first.ini") << "[a]\nx = 2\ny = 3\n";
  std::ofstream(folder / "second.ini") << "[a]\ny = 4\n";
  double x = 1.0;
  double y = 1.0;
  Params params;
  params.section("a").add("x", x, 0, 10, "m", "x");
  params.section("a").add("y", y, 0, 10, "m", "y");
  CommandLine line("program", "Summary");
  line.parameters(params);
  const std::string first = folder / "first.ini";
  const std::string second = folder / "second.ini";
  EXPECT_TRUE(parse(line, {"-c", first.c_str(), "-c", second.c_str()}));
  EXPECT_EQ(2.0, x);
  EXPECT_EQ(4.0, y);
}

TEST(CommandLineTest, ExpertKeysArePrintedOnDemandOnly) {
  double x = 1.0;
  double y = 1.0;
  Params params;
  params.section("a").user().add("x", x, 0, 10, "m", "x");
  params.section("a").add("y", y, 0, 10, "m", "y");
  const auto printed = [&](const std::vector<const char*>& arguments) {
    CommandLine line("program", "Summary");
    line.parameters(params);
    ::testing::internal::CaptureStdout();
    EXPECT_FALSE(parse(line, arguments));
    return ::testing::internal::GetCapturedStdout();
  };
  using ::testing::HasSubstr;
  using ::testing::Not;
  EXPECT_THAT(printed({"--dump-config"}),
              ::testing::AllOf(HasSubstr("x = 1"), Not(HasSubstr("y ="))));
  EXPECT_THAT(printed({"--dump-config", "--expert"}),
              ::testing::AllOf(HasSubstr("x = 1"), HasSubstr("y = 1")));
  CommandLine line("program", "Summary");
  line.parameters(params);
  EXPECT_THROW((void)parse(line, {"--expert"}), UsageError);
}

TEST(CommandLineTest, HelpHasTheLayoutThatToolsRead) {
  std::string text;
  bool overwrite = false;
  double factor = 0.0;
  int threads = 1;
  std::vector<std::string> inputs;
  std::optional<std::size_t> first;
  CommandLine line("headway-x part", "Does one thing. And another.");
  line.positional(text, "IN", "Input");
  line.option(text, 'o', "output", "FILE", "Output", true);
  line.option(factor, 0, "a-name-that-is-long-itself", "FACTOR",
              "A meaning of so many words that they do not fit into the line that they begin in");
  line.option(inputs, 'i', "input", "FILE", "Inputs; repeatable");
  line.option(threads, 't', "threads", "N", "Threads");
  line.option(first, 0, "from-index", "N", "First frame");
  line.flag(overwrite, 'w', "overwrite", "Overwrite");
  ::testing::internal::CaptureStdout();
  EXPECT_FALSE(parse(line, {"--help"}));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(),
            R"(Usage: headway-x part IN -o FILE [OPTION]...

Does one thing. And another.

Arguments:
  IN                         Input

Options:
  -o, --output FILE          Output
      --a-name-that-is-long-itself FACTOR
                             A meaning of so many words that they do not fit
                             into the line that they begin in
  -i, --input FILE           Inputs; repeatable
  -t, --threads N            Threads
      --from-index N         First frame
  -w, --overwrite            Overwrite
  -q, --quiet                Print errors only
  -v, --verbosity LEVEL      Least important messages to print: DEBUG, INFO,
                             WARN or ERROR
  -h, --help                 Print this help and end
      --version              Print the version and end
)");
}

TEST(CommandLineTest, VersionIsOneLineOfProgramAndNumber) {
  CommandLine line("headway-x part", "Summary");
  ::testing::internal::CaptureStdout();
  EXPECT_FALSE(parse(line, {"--version"}));
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), std::string("headway-x ") + kVersion + "\n");
}

TEST(FindDataFileTest, PrefersTheWorkingFolderAndFallsBackToTheInstallation) {
  const test::TemporaryFolder installed;
  const test::WorkingInTemporaryFolder working;
  const std::string name = "config/x.ini";
  EXPECT_EQ(name, findDataFile(name, installed.path()));
  const auto create = [&](const std::filesystem::path& folder) {
    std::filesystem::create_directories(folder / "config");
    std::ofstream(folder / name) << "[a]\n";
  };
  create(installed.path());
  EXPECT_EQ((std::filesystem::path(installed.path()) / name).string(),
            findDataFile(name, installed.path()));
  EXPECT_EQ("/" + name, findDataFile("/" + name, installed.path()));
  create(".");
  EXPECT_EQ(name, findDataFile(name, installed.path()));
}

TEST(RunTest, MapsExceptionsToExitStatusAndOneLine) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(kInputFault, run("p", []() -> int { throw InputError("a\nb"); }));
  EXPECT_EQ(kUsage, run("p", []() -> int { throw UsageError("c"); }));
  EXPECT_EQ(kDone, run("p", [] { return kDone; }));
  EXPECT_EQ("p: a b\np: c\n", ::testing::internal::GetCapturedStderr());
}

TEST(RequireWritableTest, RefusesWhatExists) {
  test::TemporaryFolder folder;
  EXPECT_THROW(requireWritable(folder.path(), false), InputError);
  EXPECT_NO_THROW(requireWritable(folder.path(), true));
  EXPECT_NO_THROW(requireWritable(folder / "new", false));
}

}  // namespace
}  // namespace headway::program
