// SPDX-License-Identifier: BSD-3-Clause
#include <gmock/gmock.h>
#include <headway/core/error.h>
#include <headway/core/params.h>
#include <headway_test/folders.h>

#include <fstream>
#include <limits>
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
    section.user().add("ratio", ratio, 0.0, 1.0, "", "Ratio of samples kept");
    section.add("count", count, 1, 10, "frames", "Frames waited");
    section.add("enabled", enabled, "Whether it runs");
    section.add("name", name, "Its name");
    section.add("colour", colour, {{"red", Colour::kRed}, {"blue", Colour::kBlue}}, "Its colour");
    section.renamed("share", "ratio");
    section.renamed("frame_count", "count");
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

TEST_F(ParamsTest, LoadsEveryKindOfValueAndIgnoresComments) {
  EXPECT_EQ("", errorOfLoading("[example]\nratio = 0.25 // a quarter\ncount=7\n# nothing\n"
                               "enabled=false\nname = a b\ncolour = red\n"));
  EXPECT_EQ(0.25, values.ratio);
  EXPECT_EQ(7, values.count);
  EXPECT_FALSE(values.enabled);
  EXPECT_EQ("a b", values.name);
  EXPECT_EQ(Colour::kRed, values.colour);
}

TEST_F(ParamsTest, LoadsItsOutputUnchanged) {
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

TEST_F(ParamsTest, ErrorsNameFileSectionAndKey) {
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

TEST_F(ParamsTest, SetsOneValueFromTheCommandLine) {
  params.set("example.count=9");
  EXPECT_EQ(9, values.count);
  EXPECT_THROW(params.set("example.count"), InputError);
  EXPECT_THROW(params.set("count=9"), InputError);
  EXPECT_THROW(params.set("example.none=9"), InputError);
  EXPECT_EQ("9", params.get("example", "count"));
}

TEST_F(ParamsTest, AFormerKeyInAnotherUnitIsConverted) {
  using ::testing::ElementsAre;
  using ::testing::HasSubstr;
  double wait_s = 1.0;
  params.section("example").add("wait_s", wait_s, 0.0, 5.0, "s", "Time waited");
  params.section("example").renamed("wait_frames", "wait_s", secondsOfFrames);
  params.set("example.wait_frames=7");
  EXPECT_EQ(0.7, wait_s) << "at 10 Hz";
  EXPECT_THAT(params.warnings(),
              ElementsAre(HasSubstr("[example] wait_frames is now wait_s, in another unit")));
  EXPECT_THAT(errorOfLoading("[example]\nwait_frames = 70\n"), HasSubstr("out of range"));
  EXPECT_THAT(errorOfLoading("[example]\nwait_frames = few\n"), HasSubstr("not a number"));
}

TEST_F(ParamsTest, AFormerKeySetsTheValueWithOneWarning) {
  using ::testing::AllOf;
  using ::testing::ElementsAre;
  using ::testing::HasSubstr;
  EXPECT_EQ("", errorOfLoading("[example]\nshare = 0.1\n"));
  EXPECT_EQ(0.1, values.ratio);
  params.set("example.share=0.2");
  EXPECT_EQ(0.2, values.ratio);
  EXPECT_THAT(params.warnings(), ElementsAre(HasSubstr("[example] share is now ratio")));
  params.set("example.frame_count=2");
  EXPECT_EQ(2, values.count);
  EXPECT_EQ(2u, params.warnings().size());
  EXPECT_THAT(errorOfLoading("[example]\nshare = 3\n"),
              AllOf(HasSubstr("file.ini"), HasSubstr("share"), HasSubstr("out of range")));
  std::ostringstream text;
  params.print(text);
  EXPECT_THAT(text.str(), ::testing::Not(HasSubstr("share =")));
}

TEST_F(ParamsTest, PrintsUserKeysThenExpertKeys) {
  const auto printed = [this](Params::Keys keys) {
    std::ostringstream text;
    params.print(text, keys);
    return text.str();
  };
  const std::string user = printed(Params::Keys::kUser);
  const std::string expert = printed(Params::Keys::kExpert);
  EXPECT_EQ("[example]\n# Ratio of samples kept [0 .. 1]\nratio = 0.5\n\n", user);
  EXPECT_THAT(expert, ::testing::StartsWith("[example]\n# Frames waited"));
  EXPECT_THAT(expert, ::testing::Not(::testing::HasSubstr("ratio")));
  EXPECT_EQ(user + expert, printed(Params::Keys::kAll));
}

TEST_F(ParamsTest, ListsEveryValue) {
  const std::map<std::string, std::string> expected = {{"ratio", "0.5"},
                                                       {"count", "3"},
                                                       {"enabled", "true"},
                                                       {"name", "left camera"},
                                                       {"colour", "blue"}};
  EXPECT_EQ(expected, params.values().at("example"));
}

/// The error of validateRanges(), empty if there is none.
std::string errorOf(const ExampleParams& values) {
  try {
    validateRanges(values, "example");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ValidateRangesTest, AcceptsDefaultsAndTheEndsOfARange) {
  ExampleParams values;
  EXPECT_EQ("", errorOf(values));
  values.ratio = 1.0;
  values.count = 10;
  EXPECT_EQ("", errorOf(values));
}

TEST(ValidateRangesTest, NamesSectionKeyValueAndRange) {
  ExampleParams values;
  values.ratio = 1.5;
  EXPECT_EQ("[example] ratio: '1.5' is out of range [0 .. 1]", errorOf(values));
  values = {};
  values.count = 0;
  EXPECT_EQ("[example] count: '0' is out of range [frames, 1 .. 10]", errorOf(values));
}

TEST(ValidateRangesTest, RefusesNanAndUnknownEnumerators) {
  ExampleParams values;
  values.ratio = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(errorOf(values), ::testing::HasSubstr("out of range"));
  values = {};
  values.colour = static_cast<Colour>(7);
  EXPECT_EQ("[example] colour: the value is none of red, blue", errorOf(values));
}

TEST(ValidateRangesTest, GivesTheSameErrorAsAFile) {
  ExampleParams values;
  Params params;
  values.describe(params.section("example"));
  std::string from_text;
  try {
    params.set("example.count=11");
  } catch (const InputError& error) {
    from_text = error.what();
  }
  values.count = 11;
  EXPECT_EQ(from_text, errorOf(values));
}

TEST_F(ParamsTest, MissingFileIsAnInputError) {
  EXPECT_THROW(params.loadFile("/nowhere/x.ini"), InputError);
}

}  // namespace
}  // namespace headway
