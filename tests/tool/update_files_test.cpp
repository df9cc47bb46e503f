// SPDX-License-Identifier: MIT
//
// precompute --rows and --update, and what happens to files that are not what they should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const std::vector<std::string> kRows{"--rows", "--texel-size", "0.1", "--cluster-size", "0.25"};

std::string update_of(const Precomputed& old, const std::string& file) {
  return (old.folder / file).string();
}

TEST(UpdateFiles, OfAnUnchangedSceneIsTheSameFileAndTracesNoRow) {
  const Precomputed old = precomputed("furnace_box", kRows);
  const std::string file = update_of(old, "new.relume");
  const nlohmann::json done =
      relume_json({"precompute", old.scene, "-o", file, "--quality", "64", "--rows", "--update", old.file});
  EXPECT_EQ(read_text(file), read_text(old.file));
  EXPECT_EQ(read_text(file + ".rows"), read_text(old.file + ".rows"));
  EXPECT_TRUE(done.at("changed_nodes").empty());
  const auto count = [&](const char* key) { return done.at(key).get<std::uint64_t>(); };
  EXPECT_GE(count("kept_rays"), count("rays")) << "only those between neighbours are traced again";
  EXPECT_EQ(count("kept_rays") + count("traced_rays"), count("rays") + count("occlusion_rays"));
}

TEST(UpdateFiles, AskedToUpdateThemselvesGoOnAsTheyWere) {
  const Precomputed old = precomputed("furnace_box", kRows);
  const std::string model = read_text(old.file), rows = read_text(old.file + ".rows");
  relume_json({"precompute", old.scene, "-o", old.file, "--quality", "64", "--rows", "--update", old.file});
  EXPECT_EQ(read_text(old.file), model);
  EXPECT_EQ(read_text(old.file + ".rows"), rows);
}

TEST(UpdateFiles, WithoutRowsOrWithTornOnesAreRefused) {
  const Precomputed old = precomputed("furnace_box", kRows);
  const std::string file = update_of(old, "new.relume"), rows = old.file + ".rows";
  const auto refusal = [&](const std::string& reason) {
    const Finished refused = run_relume({"precompute", old.scene, "-o", file, "--update", old.file});
    EXPECT_EQ(refused.status, 3) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr(rows));
    EXPECT_THAT(refused.err, HasSubstr(reason));
    EXPECT_EQ(std::count(refused.err.begin(), refused.err.end(), '\n'), 1) << refused.err;
    EXPECT_FALSE(fs::exists(file));
  };
  const std::string good = read_text(rows);
  write_text(rows, good.substr(0, good.size() / 2));
  refusal("bytes in the file");
  std::string future = good;
  future[8] = 9;
  write_text(rows, future);
  refusal("expected file version 1, found 9");
  write_text(rows, read_text(old.file));
  refusal("expected a .rows file");
  fs::remove(rows);
  refusal("expected a file");
}

}  // namespace
}  // namespace relume::test
