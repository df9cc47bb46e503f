// SPDX-License-Identifier: MIT
//
// Help, usage errors, and what every command promises whatever its input.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

const std::vector<std::string> kCommands{"precompute", "info",    "check",  "solve",
                                         "compare",    "factors", "export", "chart"};

TEST(Arguments, EveryCommandHasHelp) {
  const Finished all = run_relume({"--help"});
  EXPECT_EQ(all.status, 0);
  for (const std::string& command : kCommands) {
    EXPECT_THAT(all.out, HasSubstr("\n  " + command + " "));
    const Finished help = run_relume({command, "--help"});
    EXPECT_EQ(help.status, 0);
    EXPECT_THAT(help.out, HasSubstr("Usage: relume " + command));
    EXPECT_THAT(help.out, HasSubstr("--json"));
    EXPECT_THAT(help.out, HasSubstr("--quiet"));
    EXPECT_THAT(help.out, HasSubstr("Exit status: 0 done"));
    EXPECT_EQ(help.err, "");
  }
}

TEST(Arguments, VersionNamesTheProgram) {
  const Finished version = run_relume({"--version"});
  EXPECT_EQ(version.status, 0);
  EXPECT_THAT(version.out, StartsWith("relume "));
}

struct Misuse {
  std::vector<std::string> arguments;
  std::string sentence;  ///< part of it
};

TEST(Arguments, MisuseEndsWithStatus2AndASentence) {
  const std::vector<Misuse> misuses{
      {{}, "subcommand is required"},
      {{"bake"}, "'bake' is not a command"},
      {{"info"}, "FILE is required"},
      {{"solve", "a.relume"}, "--output is required"},
      {{"chart", "a.glb"}, "--output is required"},
      {{"chart", "a.glb", "-o", "d", "--texel-size", "0"},
       "--texel-size: expected a length above 0 in metres"},
      {{"chart", "a.glb", "-o", "d", "--device", "reference"}, "expected vulkan[:NAME], found 'reference'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--quality", "0"},
       "--quality: expected a whole number of at least 1, found '0'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--quality", "1.5"}, "found '1.5'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--cluster-size", "-1"},
       "expected a length above 0 in metres"},
      {{"precompute", "a.glb", "-o", "a.relume", "--error", "0"},
       "--error: expected a relative error above 0 and below 100%, as 0.02 or 2%, found '0'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--error", "-2%"}, "below 100%, as 0.02 or 2%, found '-2%'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--error", "100%"},
       "below 100%, as 0.02 or 2%, found '100%'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--budget", "-3"}, "--budget: expected a whole number"},
      {{"precompute", "a.glb"}, "--output is required"},
      {{"precompute", "a.glb", "-o", "a.relume", "--max-memory", "2X"},
       "--max-memory: expected a number of bytes, as 500M or 2G, found '2X'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--max-memory", "-1G"}, "found '-1G'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--texel-size", "-0.1"},
       "--texel-size: expected a length above 0 in metres, found '-0.1'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--max-albedo", "1"}, "at most 0.9999, found '1'"},
      {{"precompute", "a.glb", "-o", "a.relume", "--texel-size", "nan"}, "found 'nan'"},
      {{"solve", "a.relume", "-o", "a", "--bounces", "3", "--tolerance", "1%"},
       "--bounces excludes --tolerance"},
      {{"solve", "a.relume", "-o", "a", "--tolerance", "0"}, "expected a relative error above 0"},
      {{"solve", "a.relume", "-o", "a", "--device", "cuda"},
       "expected reference|vulkan[:NAME], found 'cuda'"},
      {{"solve", "a.relume", "-o", "a", "--kernel", "fast"}, "expected row_per_thread or row_per_8_lanes"},
      {{"solve", "a.relume", "-o", "a", "--missing-radiosity", "-1"}, "expected a number of at least 0"},
      {{"precompute", "a.glb", "-o", "a.relume", "--system-lumels", "0"},
       "expected a whole number of at least 1"},
      {{"compare", "a.relume", "--device", "reference"}, "expected vulkan[:NAME]"},
      {{"factors", "a.glb", "--by", "colour"}, "expected node or material"},
      {{"solve", "a.relume", "-o", "b", "--bounds", "--systems", "hall"}, "--systems excludes --bounds"},
      {{"export", "a.relume"}, "expected --matrices, --glb or --debug"},
      {{"export", "a.relume", "--debug", "form_factors", "--at", "1,2"}, "expected X,Y,Z, found '1,2'"},
      {{"export", "a.relume", "--debug", "beauty"}, "found 'beauty'"},
      {{"info", "a.relume", "--colour"}, "--colour"},
  };
  for (const Misuse& misuse : misuses) {
    const Finished finished = run_relume(misuse.arguments);
    EXPECT_EQ(finished.status, 2) << misuse.sentence;
    EXPECT_THAT(finished.err, HasSubstr(misuse.sentence));
    EXPECT_THAT(finished.err, StartsWith("relume: "));
    EXPECT_EQ(std::count(finished.err.begin(), finished.err.end(), '\n'), 1) << finished.err;
    EXPECT_EQ(finished.out, "");
  }
}

TEST(Arguments, KnobsBeyondTheSceneEndWithStatus2AndTheNumberNeeded) {
  const std::filesystem::path folder = fresh_folder();
  // A cube of 1 m; two rooms joined by a door: whoever sees through it sees two cluster trees.
  const std::string box = make_scene("furnace_box", folder), rooms = make_scene("two_rooms", folder);
  const std::vector<Misuse> misuses{
      {{box, "--cluster-size", "2"}, "cluster size 2: expected at most the diagonal of the scene, 1.732 m"},
      {{box, "--texel-size", "1.8"}, "texel size 1.8: expected at most the diagonal of the scene, 1.732 m"},
      {{rooms, "--cluster-size", "0.5", "--texel-size", "0.25", "--budget", "1"},
       "budget 1: expected at least "},
  };
  for (const Misuse& misuse : misuses) {
    std::vector<std::string> arguments{"precompute", "-o", (folder / "a.relume").string()};
    arguments.insert(arguments.end(), misuse.arguments.begin(), misuse.arguments.end());
    const Finished finished = run_relume(arguments);
    EXPECT_EQ(finished.status, 2) << misuse.sentence;
    EXPECT_THAT(finished.err, HasSubstr(misuse.sentence));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.relume"));
  }
}

TEST(Arguments, ErrorsAreOneJsonObjectWithJson) {
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"info", "/nowhere/a.relume", "--json"}, {"info", "--json"}}) {
    const Finished finished = run_relume(arguments);
    const auto json = nlohmann::json::parse(finished.out);
    EXPECT_EQ(json.at("exit"), finished.status);
    EXPECT_THAT(finished.err, HasSubstr(json.at("error").get<std::string>()));
  }
}

TEST(Arguments, MissingFilesEndWithStatus3AndTheirName) {
  const std::string folder = fresh_folder();
  for (const std::vector<std::string>& arguments :
       {std::vector<std::string>{"precompute", "/nowhere/a.glb", "-o", folder + "/a.relume"},
        {"precompute", make_scene("furnace_box", folder), "-o", "/nowhere/a.relume"},
        {"info", "/nowhere/a.relume"},
        {"check", "/nowhere/a.relume"},
        {"solve", "/nowhere/a.relume", "-o", folder},
        {"compare", "/nowhere/a.relume"},
        {"factors", "/nowhere/a.glb"},
        {"export", "/nowhere/a.relume", "--glb", "-o", folder}}) {
    const Finished finished = run_relume(arguments);
    EXPECT_EQ(finished.status, 3) << arguments[0];
    EXPECT_THAT(finished.err, HasSubstr("/nowhere/a.")) << arguments[0];
  }
}

}  // namespace
}  // namespace relume::test
