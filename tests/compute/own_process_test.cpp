// SPDX-License-Identifier: MIT
//
// What needs a process of its own. The same bits at every subgroup width and from every kernel: Mesa's
// software driver has the width of its vectors, which its environment sets; other drivers ignore that, and
// all runs have one width.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/wait.h>

#include <cstdio>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "core/result.h"

namespace relume::test {
namespace {

struct DigestRun {
  int status = -1;
  std::uint32_t subgroup_size = 0;
  std::vector<std::string> digests;  ///< codec:digest, of each kernel
};

DigestRun run_with(const std::string& environment) {
  const std::string command = environment + " " + RELUME_SOLVE_DIGEST + " 2>/dev/null";
  DigestRun run;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return run;
  std::string output;
  for (int character = std::fgetc(pipe); character != EOF; character = std::fgetc(pipe)) {
    output += static_cast<char>(character);
  }
  const int status = pclose(pipe);
  run.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  std::istringstream words(output);
  words >> run.subgroup_size;
  for (std::string word; words >> word;) run.digests.push_back(word);
  return run;
}

TEST(SubgroupWidth, ChangesNoBit) {
  std::set<std::uint32_t> widths;
  std::set<std::string> digests;
  for (const int bits : {128, 256, 512}) {
    // The driver's cache of compiled kernels does not know the width.
    const DigestRun run =
        run_with("MESA_SHADER_CACHE_DISABLE=1 LP_NATIVE_VECTOR_WIDTH=" + std::to_string(bits));
    if (run.status == 4) GTEST_SKIP() << "no usable Vulkan device";
    ASSERT_EQ(run.status, 0);
    widths.insert(run.subgroup_size);
    // Two fetches of three kernels, of four where subgroups have eight for shuffles; two more formats.
    ASSERT_EQ(run.digests.size(), run.subgroup_size < 8 ? 8u : 10u);
    digests.insert(run.digests.begin(), run.digests.end());
  }
  RecordProperty("subgroup_widths", static_cast<int>(widths.size()));
  EXPECT_EQ(digests.size(), 3u) << "one of each format: " << testing::PrintToString(digests);
  EXPECT_EQ(digests.begin()->size(), 18u);
}

TEST(NoDriver, GivesNoDevice) {
  const DigestRun run = run_with("VK_ICD_FILENAMES=/dev/null VK_DRIVER_FILES=/dev/null");
  EXPECT_EQ(run.status, static_cast<int>(ErrorCode::no_device));
}

}  // namespace
}  // namespace relume::test
