// SPDX-License-Identifier: MIT
//
// relume-make-scene NAME -o FILE.glb: writes one of Relume's own small scenes.
#include <fmt/format.h>

#include <cstdio>
#include <string>
#include <vector>

#include "scene/generate_scene.h"

namespace {

int complain(const relume::Error& error) {
  fmt::print(stderr, "relume-make-scene: {}\n", error.message);
  return static_cast<int>(error.code);
}

void print_usage(std::FILE* to) {
  fmt::print(to, "usage: relume-make-scene NAME -o FILE.glb\n  NAME is one of {}\n",
             fmt::join(relume::scene_names(), ", "));
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 1 && arguments[0] == "--help") {
    print_usage(stdout);
    return 0;
  }
  if (arguments.size() != 3 || arguments[1] != "-o") {
    print_usage(stderr);
    return static_cast<int>(relume::ErrorCode::usage);
  }
  const auto scene = relume::generate_scene(arguments[0]);
  if (!scene) return complain(scene.error());
  if (const auto written = relume::write_glb(*scene, arguments[2]); !written)
    return complain(written.error());
  return 0;
}
