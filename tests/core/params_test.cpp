#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/params.h>
#include <headway_test/folders.h>

#include <fstream>
#include <sstream>

namespace headway {
namespace {

enum class Colour { kRed, kBlue };

struct ExampleParams {
  double ratio = 0.5;
  int count = 3;
  bool enabled = true;
  std::string name = "left camera";
  Colour colour = Colour::kBlue;

  void describe(Params::Section section) {
    section.add("ratio", ratio, 0.0, 1.0, "", "Share kept");
    section.add("count", count, 1, 10, "frames", "Frames waited");
    section.add("enabled", enabled, "Whether it runs");
    section.add("name", name, "Its name");
    section.add("colour", colour, {{"red", Colour::kRed}, {"blue", Colour::kBlue}}, "Its colour");
  }
};

class ParamsTest : public ::testing::Test {
 protected:
  ParamsTest() { values.describe(params.section("example")); }

  std::string errorOfLoading(const std::string& text) {
    const auto path = folder / "file.ini";
    std::ofstream(path) << text;
    try {
      params.loadFile(path);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder;
  ExampleParams values;
  Params params;
};

TEST_F(ParamsTest, loadsEveryKindOfValueAndIgnoresComments) {
  EXPECT_EQ("", errorOfLoading("[example]\nratio = 0.25 // a quarter\ncount=7\n# nothing\n"
                               "enabled=false\nname = a b\ncolour = red\n"));
  EXPECT_EQ(0.25, values.ratio);
  EXPECT_EQ(7, values.count);
  EXPECT_FALSE(values.enabled);
  EXPECT_EQ("a b", values.name);
  EXPECT_EQ(Colour::kRed, values.colour);
}

TEST_F(ParamsTest, whatItPrintsItLoadsUnchanged) {
  values.ratio = 1.0 / 3.0;
  std::ostringstream text;
  params.print(text);
  values = ExampleParams();
  EXPECT_EQ("", errorOfLoading(text.str()));
  EXPECT_EQ(1.0 / 3.0, values.ratio);
  std::ostringstream again;
  params.print(again);
  EXPECT_EQ(text.str(), again.str());
  EXPECT_THAT(text.str(), ::testing::HasSubstr("Frames waited [frames, 1 .. 10]"));
}

TEST_F(ParamsTest, namesFileSectionAndKeyOfWhatIsWrong) {
  using ::testing::AllOf;
  using ::testing::HasSubstr;
  EXPECT_THAT(errorOfLoading("[example]\nration=1\n"),
              AllOf(HasSubstr("file.ini"), HasSubstr("[example]"), HasSubstr("ration")));
  EXPECT_THAT(errorOfLoading("[exmaple]\nratio=1\n"), HasSubstr("exmaple"));
  EXPECT_THAT(errorOfLoading("[example]\nratio=1.5\n"),
              AllOf(HasSubstr("ratio"), HasSubstr("out of range")));
  EXPECT_THAT(errorOfLoading("[example]\nratio=nan\n"), HasSubstr("out of range"));
  EXPECT_THAT(errorOfLoading("[example]\ncount=3.5\n"), HasSubstr("not a number"));
  EXPECT_THAT(errorOfLoading("[example]\nenabled=perhaps\n"), HasSubstr("neither"));
  EXPECT_THAT(errorOfLoading("[example]\ncolour=green\n"), HasSubstr("red, blue"));
  EXPECT_EQ(0.5, values.ratio);
}

TEST_F(ParamsTest, setsOneValueFromTheCommandLine) {
  params.set("example.count=9");
  EXPECT_EQ(9, values.count);
  EXPECT_THROW(params.set("example.count"), InputError);
  EXPECT_THROW(params.set("count=9"), InputError);
  EXPECT_THROW(params.set("example.none=9"), InputError);
  EXPECT_EQ("9", params.get("example", "count"));
}

TEST_F(ParamsTest, missingFileIsAnInputError) {
  EXPECT_THROW(params.loadFile("/nowhere/x.ini"), InputError);
}

}  // namespace
}  // namespace headway
