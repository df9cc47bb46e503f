// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <optional>
#include <vector>

#include "compute/host_image.h"
#include "compute/lightmap_pass.h"
#include "compute/pass_fixture.h"
#include "kernels/shared/glsl_types.h"

namespace relume::test {

/// A lumel for each value, row by row in an image so wide.
inline System lumels_in_rows(std::size_t count, std::uint32_t width) {
  System system;
  system.name = "room";
  system.lightmap_width = width;
  system.lightmap_height = static_cast<std::uint32_t>((count + width - 1) / width);
  for (std::size_t i = 0; i < count; ++i)
    system.lumels.push_back({std::uint16_t(i % width), std::uint16_t(i / width), 0, 0});
  return system;
}

class LightmapTest : public PassTest {
 protected:
  /// The image after one pass over these values, as kImageWritten; nothing when something failed. For
  /// directions the moments follow in `irradiance`.
  std::optional<HostImage> written(const System& system, LightmapFormat format,
                                   const std::vector<glm::vec3>& irradiance,
                                   const std::vector<glm::vec3>& direct = {}) {
    const LightmapTexels texels = lightmap_texels(system);
    auto pass = LightmapPass::create(device().host(), system, texels, format);
    EXPECT_TRUE(pass) << pass.error().message;
    if (!pass) return {};
    HostImage image = make_lightmap_image(device(), pass->image());
    const std::vector<BufferRange> ranges = allocate(pass->buffers());
    const BufferRange rows = allocate("irradiance", 16 * irradiance.size());
    LightmapInputs inputs{rows};
    if (format == LightmapFormat::direction_rgba16f) {
      inputs.irradiance.byte_size = rows.byte_size / 4;
      inputs.moments = BufferRange{rows.buffer, rows.offset + rows.byte_size / 4, rows.byte_size / 4 * 3};
    }
    if (!direct.empty()) inputs.direct = allocate("direct", 16 * direct.size());
    upload(ranges, lightmap_data(texels));
    upload(rows, device_rows(irradiance));
    if (inputs.direct) upload(*inputs.direct, device_rows(direct));

    const auto bound =
        pass->bind(ranges, inputs, image.view(pass->image().storage_view_format, VK_IMAGE_USAGE_STORAGE_BIT));
    EXPECT_TRUE(bound) << bound.error().message;
    EXPECT_TRUE(device().submit([&](VkCommandBuffer commands) { pass->record(commands); }));
    return image;
  }

 private:
  static std::vector<kernels::vec4> device_rows(const std::vector<glm::vec3>& values) {
    std::vector<kernels::vec4> rows;
    for (const glm::vec3& v : values) rows.push_back({v.x, v.y, v.z, 0.0f});
    return rows;
  }
};

}  // namespace relume::test
