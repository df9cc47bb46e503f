// SPDX-License-Identifier: MIT
#include "measure/device_check.h"

#include <fmt/format.h>

#include "core/compare.h"
#include "core/reference_solver.h"

namespace relume {

const char* codec_name(ValueCodec codec) {
  if (codec == ValueCodec::f32) return "f32";
  return codec == ValueCodec::unorm16 ? "unorm16" : "sqrt8";
}

std::string name_of(const KernelVariant& variant) {
  return fmt::format("{}, {}, {}, {}{}", variant.tile_rows == 8 ? "tiles" : "CSR",
                     row_kernel_name(variant.kernel),
                     variant.fetch == MatrixFetch::texels ? "texels" : "storage", codec_name(variant.codec),
                     variant.half_senders ? ", half senders" : "");
}

Result<void> check_device(SolverSession& session, const Model& model, const Lighting& lighting,
                          const std::string& name, double tolerance) {
  if (auto lit = session.light(lighting, {}); !lit) return lit;
  if (auto ran = session.run({.restart = true, .bounces = 2, .gather = true}); !ran)
    return tl::unexpected<Error>(ran.error());
  const auto radiosity = session.read_radiosity();
  if (!radiosity) return tl::unexpected<Error>(radiosity.error());
  const auto irradiance = session.read_irradiance();
  if (!irradiance) return tl::unexpected<Error>(irradiance.error());
  const auto expected = gather(reference_matrices(model).gather, lighting, *radiosity);
  const double error = compare("irradiance", *irradiance, expected).max_relative_error;
  if (error <= tolerance) return {};
  return fail(ErrorCode::check_failed,
              fmt::format("{} differs from the reference by {}; it was not timed.", name, error));
}

}  // namespace relume
