// SPDX-License-Identifier: MIT
//
// No file outside the scene's folder is opened, whatever a URI says; what is inside may be named in any legal
// way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "scene/gltf_sketch.h"
#include "scene/load_scene.h"

namespace relume {
namespace {

using test::GltfSketch;
using test::ScratchFolder;
namespace fs = std::filesystem;

/// A scene in folder/scene whose buffer has the given URI; a good buffer lies outside as folder/secret.bin.
class Paths : public testing::Test {
 protected:
  Paths() {
    sketch_ = test::one_triangle();
    outer_.write("secret.bin", sketch_.binary);
    outer_.write("scene/inside.bin", sketch_.binary);
    outer_.write("scene/sub folder/100%.bin", sketch_.binary);
  }

  Result<Scene> load_with(const std::string& uri) {
    sketch_.json["buffers"] = {{{"byteLength", sketch_.binary.size()}, {"uri", uri}}};
    return load_scene(outer_.write("scene/scene.gltf", sketch_.json.dump()));
  }

  void expect_refused(const std::string& uri) {
    const auto scene = load_with(uri);
    ASSERT_FALSE(scene.has_value()) << uri;
    EXPECT_EQ(scene.error().code, ErrorCode::bad_input);
    EXPECT_THAT(scene.error().message, testing::StartsWith("scene.gltf: /buffers/0/uri: expected ")) << uri;
  }

  void expect_loaded(const std::string& uri) {
    const auto scene = load_with(uri);
    EXPECT_TRUE(scene.has_value()) << uri << ": " << scene.error().message;
  }

  ScratchFolder outer_;
  GltfSketch sketch_;
};

TEST_F(Paths, LeavingTheFolderIsRefused) {
  for (const char* uri : {"../secret.bin", "..%2fsecret.bin", "%2e%2e/secret.bin", "%2E%2E%2Fsecret.bin",
                          "./../secret.bin", "sub folder/../../secret.bin", "..\\secret.bin", "..", "."}) {
    expect_refused(uri);
  }
}

TEST_F(Paths, AbsolutePathsAndSchemesAreRefused) {
  const std::string secret = (outer_.path() / "secret.bin").string();
  for (const std::string& uri : {secret, "file://" + secret, "file:" + secret, "%2F" + secret.substr(1),
                                 std::string("http://localhost/inside.bin"), std::string("C:\\inside.bin")}) {
    expect_refused(uri);
  }
}

TEST_F(Paths, OddBytesAndEmptyNamesAreRefused) {
  for (const char* uri : {"", "inside.bin%00", "%00", "`touch pwned`", "$(touch pwned)", "missing.bin"}) {
    expect_refused(uri);
  }
  EXPECT_FALSE(fs::exists("pwned"));
}

TEST_F(Paths, LinksMustStayInside) {
  fs::create_symlink("../secret.bin", outer_.path() / "scene/out.bin");
  fs::create_symlink("inside.bin", outer_.path() / "scene/in.bin");
  fs::create_directory_symlink("..", outer_.path() / "scene/up");
  expect_refused("out.bin");
  expect_refused("up/secret.bin");
  expect_loaded("in.bin");
}

TEST_F(Paths, OnlyRegularFilesAreOpened) {
  ASSERT_EQ(::mkfifo((outer_.path() / "scene/pipe.bin").c_str(), 0600), 0);
  expect_refused("pipe.bin");  // opening it would wait for a writer for ever
  expect_refused("sub folder");
}

TEST_F(Paths, SpacesAndPercentCodesAreRead) {
  expect_loaded("inside.bin");
  expect_loaded("./inside.bin");
  expect_loaded("%69nside.bin");
  expect_loaded("sub folder/100%.bin");
  expect_loaded("sub%20folder/100%25.bin");
}

TEST_F(Paths, DataUrisAreDecoded) {
  const std::string payload = test::base64(sketch_.binary);
  expect_loaded("data:application/octet-stream;base64," + payload);
  expect_loaded("data:application/gltf-buffer;base64," + payload);
  expect_refused("data:application/octet-stream;base64,@@@@");
  expect_refused("data:application/octet-stream," + payload);
}

TEST_F(Paths, AFileAboveTheLimitIsRefused) {
  sketch_.json["buffers"] = {{{"byteLength", sketch_.binary.size()}, {"uri", "big.bin"}}};
  const auto file = outer_.write("scene/scene.gltf", sketch_.json.dump());
  outer_.write("scene/big.bin", std::string(10000, ' '));
  SceneLimits limits;
  limits.max_file_bytes = 9999;
  const auto scene = load_scene(file, limits);
  ASSERT_FALSE(scene.has_value());
  EXPECT_THAT(scene.error().message, testing::HasSubstr("10000 bytes"));
}

TEST_F(Paths, TheSceneItselfMustBeAFile) {
  EXPECT_EQ(load_scene(outer_.path()).error().code, ErrorCode::bad_input);
  EXPECT_EQ(load_scene(outer_.path() / "none.glb").error().code, ErrorCode::bad_input);
}

}  // namespace
}  // namespace relume
