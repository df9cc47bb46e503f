// SPDX-License-Identifier: MIT
#include "frames.h"

#include <fmt/format.h>

#include <cstring>
#include <glm/common.hpp>
#include <glm/gtc/packing.hpp>

#include "compute/standalone/solve_on_device.h"
#include "core/reference_solver.h"
#include "measure/statistics.h"
#include "precompute/direct_irradiance.h"

namespace relume::bench {
namespace {

constexpr double kAllowed = 1e-3;
constexpr double kLargestHalf = 65504.0;  ///< more light than that a lightmap does not show

Result<void> compare(const char* what, std::span<const Rgb> found, std::span<const Rgb> expected) {
  if (found.size() != expected.size())
    return fail(ErrorCode::check_failed,
                fmt::format("{} of a frame: {} values, expected {}", what, found.size(), expected.size()));
  const double off = relative_difference(found, expected);
  if (off <= kAllowed) return {};
  return fail(ErrorCode::check_failed, fmt::format("{} of a frame is off by {:.2g}", what, off));
}

/// The values that a lightmap (RGBA16F) shows for lumels, where it has texels of their own.
Result<void> check_lightmap(FrameSession& session, const Model& model, std::uint32_t s,
                            std::span<const Rgb> lumels) {
  const System& system = model.systems[s];
  const auto bytes = session.read_lightmap(s);
  if (!bytes) return tl::unexpected(bytes.error());
  std::vector<Rgb> shown, expected;
  for (std::size_t i = 0; i < system.lumels.size() && !bytes->empty(); ++i) {
    const Lumel& lumel = system.lumels[i];
    if ((lumel.flags & kLumelInvalid) != 0) continue;
    std::uint64_t texel = 0;
    std::memcpy(&texel, &(*bytes)[8 * (std::size_t{system.lightmap_width} * lumel.y + lumel.x)], 8);
    shown.emplace_back(glm::unpackHalf4x16(texel));
    expected.push_back(glm::min(lumels[i], Rgb(kLargestHalf)));
  }
  return compare("lightmap", shown, expected);
}

}  // namespace

FrameSessionOptions frame_options(const StandaloneDevice& device, const Model& model) {
  FrameSessionOptions options;
  options.solver.kernel = default_row_kernel(device, model);
  return options;
}

Result<void> check_frame(FrameSession& session, const Model& model, std::span<const Light> lights,
                         const Lighting& lighting) {
  const auto shown =
      session.frame({.lights = lights, .sky = lighting.sky_radiosity, .bounces = kBouncesToTheEnd});
  if (!shown) return tl::unexpected(shown.error());
  const auto direct = direct_irradiance(model, lights);
  if (!direct) return tl::unexpected(direct.error());
  Lighting lit = lighting;
  lit.direct = direct->clusters;
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto solution = solve_reference(matrices.bounce, lit, {10000, 1e-6});
  if (!solution) return tl::unexpected(solution.error());
  const std::vector<Rgb> indirect = gather(matrices.gather, lit, solution->radiosity);
  const auto found = session.read_irradiance(), found_direct = session.read_gather_direct();
  if (!found || !found_direct) return tl::unexpected((found ? found_direct : found).error());
  if (auto same = compare("indirect irradiance", *found, indirect); !same) return same;
  if (auto same = compare("direct irradiance", *found_direct, direct->gather); !same) return same;
  std::vector<Rgb> sum(indirect);
  for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += direct->gather[i];
  const std::vector<std::uint32_t> first = gather_offsets(model);
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const auto lumels = std::span(sum).subspan(first[s], model.systems[s].lumels.size());
    if (auto same = check_lightmap(session, model, s, lumels); !same) return same;
  }
  return {};
}

}  // namespace relume::bench
