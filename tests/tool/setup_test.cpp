// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tool/program.h"

namespace relume::test {
namespace {

const std::string kScript = RELUME_SOURCE_DIR "/setup.sh";

TEST(Setup, WithoutAptSaysWhatIsMissing) {
  const std::string empty = fresh_folder();
  for (const std::string command : {"demo", "day", "test"}) {
    const Finished finished = run_command({"/bin/bash", kScript, command}, {"PATH=" + empty});
    EXPECT_EQ(finished.status, 2);
    for (const char* package : {"cmake", "ninja-build", "libembree-dev", "libtinygltf-dev",
                                "mesa-vulkan-drivers", "libgtest-dev"}) {
      EXPECT_THAT(finished.err, testing::HasSubstr(package));
    }
  }
}

TEST(Setup, MisuseEndsWithStatus2) {
  EXPECT_EQ(run_command({"/bin/bash", kScript}).status, 2);
  EXPECT_EQ(run_command({"/bin/bash", kScript, "install"}).status, 2);
}

}  // namespace
}  // namespace relume::test
