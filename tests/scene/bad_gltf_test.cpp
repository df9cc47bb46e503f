// SPDX-License-Identifier: MIT
//
// The shared set of malformed files: each must end as its manifest says, with a message that names the file
// and the place at fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scene/load_scene.h"
#include "scene/shared_files.h"

namespace relume {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

struct BadFile {
  const char* name;
  const char* place;  ///< JSON path or byte offset that the message must name
  const char* what;   ///< a word on what is wrong
};

void PrintTo(const BadFile& file, std::ostream* out) {
  *out << file.name;
}

class BadGltf : public testing::TestWithParam<BadFile> {};

TEST_P(BadGltf, IsRefusedWithItsPlace) {
  const auto shared = test::shared_files();
  if (!shared) GTEST_SKIP() << "the shared files are not beside the repository";
  const auto file = *shared / "bad-gltf" / GetParam().name;
  ASSERT_TRUE(std::filesystem::exists(file)) << file;
  const auto scene = load_scene(file);
  ASSERT_FALSE(scene.has_value());
  EXPECT_EQ(scene.error().code, ErrorCode::bad_input);
  EXPECT_THAT(scene.error().message, StartsWith(std::string(GetParam().name) + ": "));
  EXPECT_THAT(scene.error().message, HasSubstr(GetParam().place));
  EXPECT_THAT(scene.error().message, HasSubstr(GetParam().what));
  EXPECT_EQ(scene.error().message.find('\n'), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(
    Manifest, BadGltf,
    testing::Values(
        BadFile{"glb_magic_zero.glb", "byte 0", "magic"}, BadFile{"glb_trunc_half.glb", "byte 8", "10856"},
        BadFile{"glb_trunc_header.glb", "byte 0", "7 bytes"}, BadFile{"not_json.gltf", "byte 1", "JSON"},
        BadFile{"acc_count_huge.gltf", "/accessors/1", "72 bytes"},
        BadFile{"bv_offset_past_end.gltf", "/bufferViews/1", "4096"},
        BadFile{"position_one_nan.gltf", "/meshes/0/primitives/0/attributes/POSITION, element 1", "finite"},
        BadFile{"index_500.gltf", "/meshes/0/primitives/0/indices, element 0", "500"},
        BadFile{"node_cycle2.gltf", "/nodes/0", "cycle"},
        BadFile{"uri_parent_dir.gltf", "/buffers/0/uri", "secret"},
        BadFile{"uri_gone.gltf", "/buffers/0/uri", "gone.bin"},
        BadFile{"ext_required_draco.gltf", "/extensionsRequired/0", "KHR_draco_mesh_compression"},
        BadFile{"data_uri_cut.gltf", "/buffers/0", "168"},
        BadFile{"tinygltf_invalid-buffer-index.gltf", "/bufferViews/1/buffer", "found 1"},
        BadFile{"assimp_IndexOutOfRange.gltf", "/meshes/0/primitives/0/indices", "255"},
        BadFile{"assimp_badObject.gltf", "/materials/0/pbrMetallicRoughness", "an object"},
        BadFile{"magnum_scene-invalid-node-oob.gltf", "/scenes/0/nodes/0", "found 7"}),
    [](const auto& named) {
      std::string name = named.param.name;
      std::replace_if(
          name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

TEST(BadGltf, AlbedoAboveOneIsClampedWithAWarning) {
  const auto shared = test::shared_files();
  if (!shared) GTEST_SKIP() << "the shared files are not beside the repository";
  const auto scene = load_scene(*shared / "bad-gltf" / "albedo_2.gltf");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->materials.at(0).base_color, Rgb(1.0));
  EXPECT_THAT(scene->warnings,
              testing::ElementsAre(HasSubstr("materials with a base colour outside 0 to 1, clamped: 1")));
}

TEST(BadGltf, EveryFileOfTheManifestIsCovered) {
  const auto shared = test::shared_files();
  if (!shared) GTEST_SKIP() << "the shared files are not beside the repository";
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*shared / "bad-gltf")) {
    const auto kind = entry.path().extension();
    if (kind == ".gltf" || kind == ".glb") ++files;
  }
  EXPECT_EQ(files, 18);
}

}  // namespace
}  // namespace relume
