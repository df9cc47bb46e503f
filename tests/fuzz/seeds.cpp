// SPDX-License-Identifier: MIT
//
// relume_fuzz_seeds FOLDER: writes the seeds that are not text into FOLDER/gltf and FOLDER/model.
#include <cstdio>
#include <filesystem>

#include "core/halvings.h"
#include "core/model_file.h"
#include "scene/generate_scene.h"
#include "support/tiny_model.h"

namespace {

using namespace relume;

Result<void> write_glb_seed(const std::filesystem::path& folder, const std::string& name) {
  auto scene = generate_scene(name);
  if (!scene) return tl::unexpected(scene.error());
  Light light;
  light.type = LightType::spot;
  add_light(*scene, light);
  return write_glb(*scene, folder / (name + ".glb"));
}

/// More to the first leaf of each node of two leaves that a row sees.
std::vector<std::uint8_t> halvings(const Model& model, const System& system, const BlockMatrix& matrix) {
  const std::vector<std::uint32_t> leaves = leaves_of_columns(model, system);
  HalvingList list;
  for (const std::uint32_t column : decode(matrix).column_indices) {
    if (leaves[column] == 2) list.push_back(Halving::first_more);
  }
  return list.bytes();
}

Result<void> write_seeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / "gltf");
  std::filesystem::create_directories(folder / "model");
  for (const char* name : {"light_plane", "furnace_box"}) {
    if (auto written = write_glb_seed(folder / "gltf", name); !written) return written;
  }
  Model trees = test::tiny_model();
  trees.sky_cells = {8, 3};
  trees.sky_tree = {{{0, 2, 0}}, {0.25f, 0.75f}};
  trees.systems[0].imports = {{1, 0}, {kSkySystem, 2}};
  System& floor = trees.systems[0];
  floor.bounce_halvings = halvings(trees, floor, floor.bounce);
  floor.gather_halvings = halvings(trees, floor, floor.gather);
  if (auto checked = check_model(trees); !checked) return checked;
  if (auto written = write_model(trees, folder / "model" / "trees.relume"); !written) return written;
  return write_model(test::tiny_model(), folder / "model" / "tiny.relume");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return static_cast<int>(ErrorCode::usage);
  const auto written = write_seeds(argv[1]);
  if (written) return 0;
  std::fprintf(stderr, "%s\n", written.error().message.c_str());
  return static_cast<int>(written.error().code);
}
