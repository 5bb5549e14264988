#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/program/command_line.h>
#include <headway_test/folders.h>

#include <fstream>

namespace headway::program {
namespace {

bool parse(CommandLine& line, std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "program");
  return line.parse(static_cast<int>(arguments.size()), arguments.data());
}

TEST(CommandLineTest, readsArgumentsAndKeepsDefaults) {
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

TEST(CommandLineTest, configurationFileThenSet) {
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

TEST(CommandLineTest, wrongUseIsAUsageErrorAndWrongValueAnInputError) {
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

TEST(CommandLineTest, dumpConfigNeedsNothingElse) {
  std::string input;
  double x = 1.0;
  Params params;
  params.section("a").add("x", x, 0, 10, "m", "meaning of x");
  CommandLine line("program", "Summary");
  line.option(input, 'i', "input", "FILE", "input", true);
  line.parameters(params);
  ::testing::internal::CaptureStdout();
  EXPECT_FALSE(parse(line, {"--dump-config", "--set", "a.x=4"}));
  EXPECT_THAT(::testing::internal::GetCapturedStdout(),
              ::testing::AllOf(::testing::HasSubstr("meaning of x"), ::testing::HasSubstr("x = 4")));
}

TEST(RunTest, mapsExceptionsToExitStatusAndOneLine) {
  ::testing::internal::CaptureStderr();
  EXPECT_EQ(kInputFault, run("p", []() -> int { throw InputError("a\nb"); }));
  EXPECT_EQ(kUsage, run("p", []() -> int { throw UsageError("c"); }));
  EXPECT_EQ(kDone, run("p", [] { return kDone; }));
  EXPECT_EQ("p: a b\np: c\n", ::testing::internal::GetCapturedStderr());
}

TEST(RequireWritableTest, refusesWhatExists) {
  test::TemporaryFolder folder;
  EXPECT_THROW(requireWritable(folder.path(), false), InputError);
  EXPECT_NO_THROW(requireWritable(folder.path(), true));
  EXPECT_NO_THROW(requireWritable(folder / "new", false));
}

}  // namespace
}  // namespace headway::program
