// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>
#include <stb_image.h>
#include <tinyexr.h>

#include <cmath>
#include <memory>

#include "support/quad_model.h"
#include "tool/free_memory.h"
#include "tool/image.h"
#include "tool/lightmap_image.h"
#include "tool/surface_shading.h"
#include "tool/tone_curve.h"
#include "tool/view_rays.h"

namespace relume::test {
namespace {

const unsigned char* bytes_of(const std::vector<std::byte>& bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

TEST(Exr, HoldsHalfPrecisionOfEachChannel) {
  ColorImage image(3, 2);
  image.at(0, 0) = {1.0f, 2.0f, 3.0f};
  image.at(2, 0) = {0.1f, 1000.5f, 0.0f};
  image.at(1, 1) = {1e6f, -1.0f, 6.1e-5f};
  image.at(1, 0) = {0.0f, -1e6f, 0.0f};
  const Result<std::vector<std::byte>> bytes = encode_exr(image);
  ASSERT_TRUE(bytes);
  EXRVersion version;
  ASSERT_EQ(ParseEXRVersionFromMemory(&version, bytes_of(*bytes), bytes->size()), TINYEXR_SUCCESS);
  EXRHeader header;
  InitEXRHeader(&header);
  const char* message = nullptr;
  ASSERT_EQ(ParseEXRHeaderFromMemory(&header, &version, bytes_of(*bytes), bytes->size(), &message),
            TINYEXR_SUCCESS);
  EXPECT_EQ(header.num_channels, 3);
  for (int c = 0; c < 3; ++c) {
    EXPECT_EQ(std::string(header.channels[c].name), std::string(1, "BGR"[c]));
    EXPECT_EQ(header.pixel_types[c], TINYEXR_PIXELTYPE_HALF);
  }
  FreeEXRHeader(&header);

  float* pixels = nullptr;
  int width = 0, height = 0;
  ASSERT_EQ(LoadEXRFromMemory(&pixels, &width, &height, bytes_of(*bytes), bytes->size(), &message),
            TINYEXR_SUCCESS);
  const std::unique_ptr<float, FreeMemory> owner(pixels);
  EXPECT_EQ(width, 3);
  EXPECT_EQ(height, 2);
  const auto channel = [&](int x, int y, int c) { return pixels[4 * (y * width + x) + c]; };
  EXPECT_EQ(channel(0, 0, 0), 1.0f);
  EXPECT_EQ(channel(0, 0, 1), 2.0f);
  EXPECT_EQ(channel(0, 0, 2), 3.0f);
  EXPECT_NEAR(channel(2, 0, 0), 0.1f, 0.1f * 0x1p-11f);  // half a unit of 11 bits
  EXPECT_EQ(channel(2, 0, 1), 1000.5f);
  EXPECT_EQ(channel(1, 1, 0), 65504.0f);  // clamped, not infinite
  EXPECT_EQ(channel(1, 1, 1), -1.0f);
  EXPECT_EQ(channel(1, 0, 1), -65504.0f);
}

TEST(Png, ComesBackAsItWas) {
  ByteImage image(5, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {std::uint8_t(i), std::uint8_t(255 - i), 7};
  const Result<std::vector<std::byte>> bytes = encode_png(image);
  ASSERT_TRUE(bytes);
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<stbi_uc, FreeMemory> pixels(stbi_load_from_memory(
      bytes_of(*bytes), static_cast<int>(bytes->size()), &width, &height, &channels, 3));
  ASSERT_TRUE(pixels);
  EXPECT_EQ(width, 5);
  EXPECT_EQ(height, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(pixels.get()[3 * i + c], image.pixels[i][c]);
  }
}

TEST(Srgb, CodesKnownValues) {
  // ((128 / 255 + 0.055) / 1.055)^2.4 = 0.2158605; below 0.0031308 the curve is 12.92 x: 12.92 * 0.0015654 *
  // 255 = 5.16
  EXPECT_EQ(srgb_bytes(Rgb(0.0, 1.0, 0.2158605)), (ByteColor{0, 255, 128}));
  EXPECT_EQ(srgb_bytes(Rgb(-1.0, 2.0, 0.0015654)), (ByteColor{0, 255, 5}));
}

//   x 0 1 2 3 4 5 6 7 8 9        texels of one row, 10 wide
//     . . . . . A i . . .        A: lumel of value 8, i: invalid lumel
TEST(LightmapImage, GrowsChartsAndFillsInvalidLumels) {
  System system;
  system.lightmap_width = 10;
  system.lightmap_height = 1;
  system.lumels = {{5, 0, 0, 0}, {6, 0, 0, kLumelInvalid}};
  const std::vector<Rgb> values{Rgb(8.0), Rgb(1000.0)};
  const ColorImage image = lightmap_image(system, values);
  for (std::uint32_t x = 0; x < 10; ++x) {
    const bool reached = x >= 5 - kDilation;  // to the right, the picture ends first
    EXPECT_EQ(image.at(x, 0).x, reached ? 8.0f : 0.0f) << x;
  }
}

//     A .          the texel between A = 2 (left) and B = 6 (below right, diagonal) takes their mean
//     . B
TEST(LightmapImage, TakesTheMeanOfNeighbours) {
  System system;
  system.lightmap_width = 2;
  system.lightmap_height = 2;
  system.lumels = {{0, 0, 0, 0}, {1, 1, 0, 0}};
  const std::vector<Rgb> values{Rgb(2.0, 0.0, 4.0), Rgb(6.0, 1.0, 0.0)};
  const ColorImage image = lightmap_image(system, values);
  EXPECT_EQ(image.at(0, 0), glm::vec3(2.0f, 0.0f, 4.0f));
  EXPECT_EQ(image.at(1, 1), glm::vec3(6.0f, 1.0f, 0.0f));
  EXPECT_EQ(image.at(1, 0), glm::vec3(4.0f, 0.5f, 2.0f));
  EXPECT_EQ(image.at(0, 1), glm::vec3(4.0f, 0.5f, 2.0f));
}

TEST(LightmapImage, FarInvalidLumelsAreFilledWhateverTheDistance) {
  System system;
  system.lightmap_width = 20;
  system.lightmap_height = 1;
  system.lumels.push_back({0, 0, 0, 0});
  for (std::uint16_t x = 1; x < 20; ++x) system.lumels.push_back({x, 0, 0, kLumelInvalid});
  const std::vector<Rgb> values(20, Rgb(3.0));
  EXPECT_EQ(lightmap_image(system, values).at(19, 0), glm::vec3(3.0f));
}

TEST(ToneCurve, ScalesWithTheScene) {
  const std::vector<Rgb> dim{Rgb(0.0), Rgb(1.0), Rgb(2.0), Rgb(4.0)};
  std::vector<Rgb> bright;
  for (const Rgb& radiance : dim) bright.push_back(1000.0 * radiance);
  const ToneCurve low = fit_tone_curve(dim);
  const ToneCurve high = fit_tone_curve(bright);
  EXPECT_NEAR(low.exposure, 1000.0 * high.exposure, 1e-9 * low.exposure);
  EXPECT_NEAR(low.white, high.white, 1e-9 * low.white);
  EXPECT_EQ(tone_mapped(low, Rgb(0.0)), Rgb(0.0));
  double before = 0.0;
  for (double radiance = 0.1; radiance < 3.9; radiance += 0.1) {
    const double shown = tone_mapped(low, Rgb(radiance)).x;
    EXPECT_GT(shown, before);
    before = shown;
  }
  EXPECT_EQ(fit_tone_curve(std::vector<Rgb>(4, Rgb(0.0))).exposure, 1.0);
}

/// A triangle with corners (0,0,z), (1,0,z), (0,1,z), counter-clockwise seen from +z.
void add_triangle(Model& model, float z, std::uint32_t material) {
  Occluders& occluders = model.occluders;
  const auto first = static_cast<std::uint32_t>(occluders.positions.size());
  for (const glm::vec3& corner : {glm::vec3(0, 0, z), glm::vec3(1, 0, z), glm::vec3(0, 1, z)})
    occluders.positions.push_back(corner);
  occluders.triangles.push_back({first, first + 1, first + 2});
  occluders.material.push_back(material);
  occluders.node.push_back(0);
  occluders.system.push_back(kNone);
}

TEST(ViewRays, PassTheBacksOfSingleSidedMaterials) {
  Model model;
  model.materials = {{"one side", false, false}, {"two sides", true, false}};
  add_triangle(model, 1.0f, 0);
  add_triangle(model, 2.0f, 1);
  const Result<RayCaster> caster =
      RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
  ASSERT_TRUE(caster);
  ViewRays rays;
  rays.fill({{0.25f, 0.5f, 0.0f}, {0.0f, 0.0f, 1.0f}});  // from below: both backs
  rays[1] = {{0.25f, 0.5f, 5.0f}, {0.0f, 0.0f, -1.0f}};  // from above
  rays[2] = {{5.0f, 5.0f, 5.0f}, {0.0f, 0.0f, -1.0f}};   // beside
  const ViewHits hits = trace(model, *caster, rays);
  ASSERT_TRUE(hits[0].met);
  EXPECT_EQ(hits[0].point.triangle, 1u);
  EXPECT_EQ(hits[0].point.side, Side::back);
  EXPECT_NEAR(hits[0].distance, 2.0f, 1e-5f);
  EXPECT_NEAR(hits[0].point.barycentric.x, 0.25f, 1e-6f);
  EXPECT_NEAR(hits[0].point.barycentric.y, 0.5f, 1e-6f);
  ASSERT_TRUE(hits[1].met);
  EXPECT_EQ(hits[1].point.triangle, 1u);
  EXPECT_EQ(hits[1].point.side, Side::front);
  EXPECT_FALSE(hits[2].met);
}

/// A square of one cluster, one element and one lumel; albedo 0.5.
Model one_lumel() {
  Model model;
  add_quad(model, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, 1);
  model.systems[0].lightmap_width = 1;
  model.systems[0].lightmap_height = 1;
  for (glm::vec2& uv : model.occluders.front_uv) uv = glm::vec2(0.5f);
  return model;
}

TEST(SurfaceShading, RadianceIsReflectedAndEmittedOverPi) {
  const Model model = one_lumel();
  const Lighting lighting{{Rgb(0.5)}, {Rgb(0.0, 0.0, 2.0 * kPi)}, {Rgb(0.0)}, {}};
  const std::vector<Rgb> irradiance{Rgb(kPi, 2.0 * kPi, 0.0)};
  const SurfaceShading shading(model, lighting, irradiance);
  const Rgb seen = shading.radiance({0, Side::front, {0.2f, 0.3f}});
  EXPECT_NEAR(seen.x, 0.5, 1e-12);
  EXPECT_NEAR(seen.y, 1.0, 1e-12);
  EXPECT_NEAR(seen.z, 2.0, 1e-12);
  EXPECT_EQ(shading.radiance({0, Side::back, {0.2f, 0.3f}}),
            Rgb(0.0));  // the back of a single-sided material
}

TEST(SurfaceShading, ColoursOfASceneReplaceThoseOfClusters) {
  const Model model = one_lumel();
  Scene scene;
  scene.materials.emplace_back().base_color = Rgb(0.25, 0.9, 0.0);
  scene.materials[0].emission = Rgb(0.0, 0.0, 3.0);
  for (const glm::vec3& corner : model.occluders.positions) scene.vertices.positions.emplace_back(corner);
  scene.vertices.uv0.resize(4);
  scene.vertices.uv1.resize(4);
  scene.vertices.colors.resize(4);
  scene.triangles = model.occluders.triangles;
  scene.surfaces.push_back({0, 0, 0, 2, false, false, false});
  const Lighting lighting{{Rgb(0.5)}, {Rgb(0.0)}, {Rgb(0.0)}, {}};
  const std::vector<Rgb> irradiance{Rgb(kPi)};
  const SeenPoint point{1, Side::front, {0.2f, 0.3f}};
  const Rgb seen = SurfaceShading(model, lighting, irradiance, {&scene, 0.8, {}}).radiance(point);
  EXPECT_NEAR(seen.x, 0.25, 1e-6);
  EXPECT_NEAR(seen.y, 0.8, 1e-6);  // clamped
  EXPECT_NEAR(seen.z, 3.0, 1e-6);
  const Rgb replaced = SurfaceShading(model, lighting, irradiance, {&scene, 0.8, {0}}).radiance(point);
  EXPECT_NEAR(replaced.x, 0.5, 1e-12);
}

TEST(ViewRays, FrameOfACameraThatLooksAlongMinusZ) {
  Camera camera;
  camera.position = {1.0, 2.0, 3.0};
  camera.vertical_field_of_view = kPi / 2.0;  // half the height is 1 at distance 1
  const ViewFrame frame(Model{}, camera, 2.0);
  const ViewRay middle = frame.ray({0.5, 0.5});
  EXPECT_EQ(middle.origin, glm::vec3(1, 2, 3));
  EXPECT_NEAR(middle.direction.z, -1.0f, 1e-6f);
  const ViewRay top_left = frame.ray({0.0, 0.0});  // (-2, 1, -1) / sqrt 6
  EXPECT_NEAR(top_left.direction.x, -2.0f / std::sqrt(6.0f), 1e-6f);
  EXPECT_NEAR(top_left.direction.y, 1.0f / std::sqrt(6.0f), 1e-6f);
  EXPECT_NEAR(top_left.direction.z, -1.0f / std::sqrt(6.0f), 1e-6f);
}

}  // namespace
}  // namespace relume::test
