// SPDX-License-Identifier: MIT
//
// A room that changes from frame to frame: a lamp, the sun, a wall, a film on a screen, the sky.
#pragma once

#include <vulkan/vulkan_core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/sky.h"
#include "support/scene_builder.h"
#include "verification/whole_path.h"

namespace relume::test {

inline constexpr std::uint32_t kFrames = 18;
inline constexpr std::uint32_t kAccent = 1;  ///< material of one wall
inline constexpr std::uint32_t kScreen = 2;  ///< material of the screen
inline constexpr std::uint32_t kFilmImages = 4;
inline constexpr VkExtent2D kFilmSize{16, 9};
inline const Rgb kScreenWhite(400.0, 390.0, 370.0);  ///< cd/m2

/// 6 x 3 x 4 m, of which half is under a ceiling; a wall with a way past it stands between the halves.
inline Scene half_a_roof() {
  using P = glm::dvec3;
  SceneBuilder b;
  const std::uint32_t white = b.material("white", Rgb(0.6)), accent = b.material("accent", Rgb(0.6));
  const std::uint32_t screen = b.material("screen", Rgb(0.1), kScreenWhite);
  b.add_quad("floor/in", white, {P(0, 0, 0), P(0, 0, 4), P(3, 0, 4), P(3, 0, 0)});
  b.add_quad("floor/out", white, {P(3, 0, 0), P(3, 0, 4), P(6, 0, 4), P(6, 0, 0)});
  b.add_quad("ceiling", white, {P(0, 3, 0), P(3, 3, 0), P(3, 3, 4), P(0, 3, 4)});
  b.add_quad("near", white, {P(0, 0, 0), P(6, 0, 0), P(6, 3, 0), P(0, 3, 0)});
  b.add_quad("far", white, {P(6, 0, 4), P(0, 0, 4), P(0, 3, 4), P(6, 3, 4)});
  b.add_quad("left", accent, {P(0, 0, 4), P(0, 0, 0), P(0, 3, 0), P(0, 3, 4)});
  b.add_quad("right", white, {P(6, 0, 0), P(6, 0, 4), P(6, 3, 4), P(6, 3, 0)});
  b.add_standing_box("between", white, P(2.9, 0, 0), P(3.1, 2.6, 2.6));
  b.add_quad("screen", screen, {P(1, 0.8, 0.02), P(2.6, 0.8, 0.02), P(2.6, 1.7, 0.02), P(1, 1.7, 0.02)});
  Scene scene = b.scene();
  const glm::vec2 corners[] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  std::copy(std::begin(corners), std::end(corners), scene.vertices.uv0.end() - 4);
  scene.surfaces.back().has_uv0 = true;
  return scene;
}

/// sRGB codes of an image of the film: a bright stripe of another colour at another place in each, and half
/// of the picture dark in every second one.
inline std::vector<std::uint8_t> film_image(std::uint32_t image) {
  std::vector<std::uint8_t> codes;
  for (std::uint32_t y = 0; y < kFilmSize.height; ++y) {
    for (std::uint32_t x = 0; x < kFilmSize.width; ++x) {
      const bool stripe = (x + 16 - 4 * image) % 16 < 3, dark = image % 2 == 1 && y < 5;
      std::array<std::uint8_t, 3> color{90, 60, 120};
      if (dark) color = {0, 0, 10};
      if (stripe) color[image % 3] = 255;
      codes.insert(codes.end(), {color[0], color[1], color[2], 255});
    }
  }
  return codes;
}

/// As IEC 61966-2-1 decodes them.
inline std::vector<float> linear(const std::vector<std::uint8_t>& codes) {
  std::vector<float> values;
  for (const std::uint8_t code : codes) {
    const double v = code / 255.0;
    values.push_back(static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4)));
  }
  return values;
}

/// A bright side that goes once around in kFrames frames.
inline Sky turned_sky(std::uint32_t frame) {
  EquirectangularSky sky{16, 8, std::vector<glm::vec3>(16 * 8, glm::vec3(60.0f, 80.0f, 120.0f))};
  for (std::uint32_t row = 0; row < 4; ++row) {
    for (std::uint32_t i = 0; i < 4; ++i)
      sky.radiance[16 * row + (16 * frame / kFrames + i) % 16] = glm::vec3(900.0f, 700.0f, 400.0f);
  }
  return sky;
}

/// What the host shows in a frame: one thing after the other begins to change.
struct Shown {
  std::vector<Light> lights;
  Rgb accent{0.6};
  std::uint32_t image = 0;  ///< of the film
  Sky sky = turned_sky(0);
};

inline Shown shown_in(std::uint32_t frame) {
  using P = glm::dvec3;
  Shown out;
  Light lamp;
  lamp.intensity = Rgb(300.0, 240.0, 150.0);
  lamp.position = P(0.73 + 0.29 * std::min(frame, 12u), 1.9, 1.37);
  Light sun;
  sun.type = LightType::directional;
  sun.intensity = Rgb(800.0, 780.0, 700.0);
  sun.direction = glm::normalize(P(-0.53, -1.0, 0.21));
  out.lights = {lamp, sun};
  if (frame >= 6) out.accent = Rgb(0.6, 0.05, 0.1 + 0.02 * frame);
  if (frame >= 3) out.image = frame % kFilmImages;
  if (frame >= 10) out.sky = turned_sky(frame);
  return out;
}

inline Model half_a_roof_model(const Scene& scene) {
  PrecomputeOptions options;
  options.texel_size = 0.4;
  options.cluster_size = 0.8;
  options.quality = 32;
  options.system_lumels = 300;
  return precompute_or_throw(scene, options);
}

/// An upper bound of all that is shown.
inline Lighting brightest_lighting(const Model& model) {
  Lighting brightest = stored_lighting(model);
  for (Rgb& direct : brightest.direct) direct = Rgb(3000.0);
  for (Rgb& sky : brightest.sky_radiosity) sky = Rgb(kPi * 900.0);
  return brightest;
}

}  // namespace relume::test
