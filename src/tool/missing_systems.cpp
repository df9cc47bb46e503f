// SPDX-License-Identifier: MIT
#include "tool/missing_systems.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>

namespace relume {
namespace {

double largest_channel(const Rgb& value) {
  return std::max({value.x, value.y, value.z});
}

Rgb largest(const std::vector<Rgb>& values) {
  Rgb result(0.0);
  for (const Rgb& value : values) result = glm::max(result, value);
  return result;
}

void summarise_shares(const std::vector<double>& shares, MissingSystems& missing) {
  for (const double share : shares) {
    missing.largest_share = std::max(missing.largest_share, share);
    missing.mean_share += share / double(shares.size());
  }
}

}  // namespace

Result<std::optional<MissingSystems>> bound_missing_light(const Model& model, const Lighting& lighting,
                                                          const SolveOutcome& outcome,
                                                          const std::optional<double>& assumed_radiosity,
                                                          const StopRule& rule, const SolverChoice& choice,
                                                          Console& console) {
  MissingSystems missing;
  for (const System& system : model.systems) {
    if (!system.loaded) missing.names.push_back(system.name);
  }
  if (missing.names.empty()) return std::nullopt;
  const MissingShare share = missing_share(model);
  summarise_shares(share.gather, missing);
  missing.assumed_radiosity =
      assumed_radiosity ? Rgb(*assumed_radiosity) : largest(outcome.solution.radiosity);
  const auto solved =
      solve(model, missing_light(lighting, share, missing.assumed_radiosity), rule, choice, console);
  if (!solved) return tl::unexpected(solved.error());
  // Row sums are at most 1, so that an error of the radiosity is at least that of the irradiance.
  const Rgb open =
      (solved->solution.error_bound + solved->rounding_bound) * largest(solved->solution.radiosity);
  for (std::size_t row = 0; row < share.gather.size(); ++row) {
    const Rgb lacking = share.gather[row] * missing.assumed_radiosity + solved->gathered[row] + open;
    missing.largest_irradiance = glm::max(missing.largest_irradiance, lacking);
    missing.mean_irradiance += lacking / double(share.gather.size());
  }
  return missing;
}

std::string missing_sentence(const MissingSystems& missing, std::size_t systems, bool given) {
  return fmt::format(
      "{} of {} systems are not loaded: {:.3g} % of what a lumel sees, at most {:.3g} %. If none of their "
      "surfaces has more than {:.4g} lm/m2 ({}), lumels lack {:.3g} lux on average, and none more than "
      "{:.3g}.",
      missing.names.size(), systems, 100.0 * missing.mean_share, 100.0 * missing.largest_share,
      largest_channel(missing.assumed_radiosity),
      given ? "--missing-radiosity" : "the most of those loaded; --missing-radiosity sets it",
      largest_channel(missing.mean_irradiance), largest_channel(missing.largest_irradiance));
}

JsonValue missing_json(const std::optional<MissingSystems>& missing) {
  if (!missing) return {};
  return JsonObject{{"systems", json_array(missing->names)},
                    {"largest_share", missing->largest_share},
                    {"mean_share", missing->mean_share},
                    {"assumed_radiosity", missing->assumed_radiosity},
                    {"largest_irradiance", missing->largest_irradiance},
                    {"mean_irradiance", missing->mean_irradiance}};
}

}  // namespace relume
