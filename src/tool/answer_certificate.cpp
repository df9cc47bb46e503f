// SPDX-License-Identifier: MIT
#include "tool/answer_certificate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "core/model_file.h"
#include "core/row_certificate.h"
#include "core/same_surfaces.h"
#include "tool/full_rows.h"
#include "tool/interrupt.h"

namespace relume {
namespace {

/// Values of one model in the order of the other: value i goes to place `at[i]`.
std::vector<Rgb> moved(const std::vector<Rgb>& values, const std::vector<std::uint32_t>& at,
                       std::size_t count) {
  std::vector<Rgb> out(count, Rgb(0.0));
  for (std::size_t i = 0; i < values.size(); ++i) out[at[i]] = values[i];
  return out;
}

void rate(const Model& model, const std::vector<Rgb>& answer, AnswerCertificate& certificate) {
  const auto first_row = gather_offsets(model);
  double off = 0.0, total = 0.0, worst = 0.0;
  std::size_t count = 0;
  for (std::size_t s = 0; s < model.systems.size(); ++s) {
    const std::vector<Lumel>& lumels = model.systems[s].lumels;
    for (std::size_t l = 0; l < lumels.size(); ++l) {
      if ((lumels[l].flags & kLumelInvalid) != 0) continue;
      const Rgb &bound = certificate.irradiance[first_row[s] + l], &value = answer[first_row[s] + l];
      off += glm::dot(bound, bound);
      total += glm::dot(value, value);
      worst = std::max(worst, glm::length(bound));
      ++count;
    }
  }
  if (total <= 0.0) return;
  certificate.relative = std::sqrt(off / total);
  certificate.worst = worst / std::sqrt(total / double(count));
}

}  // namespace

Result<AnswerCertificate> certify_answer(const Model& model, const SolveOutcome& outcome,
                                         const std::filesystem::path& full, const LightingOptions& options,
                                         Console& console) {
  const Result<Model> other =
      full.extension() == ".rows" ? full_rows(full, model, options.scene, console) : read_model(full);
  if (!other) return tl::unexpected(other.error());
  const Result<SameSurfaces> same = same_surfaces(*other, model);
  if (!same) return fail(same.error().code, full.string() + ": " + same.error().message);
  const Result<LightingSetup> setup = set_up_lighting(*other, options, console);
  if (!setup) return tl::unexpected(setup.error());
  const Result<RowCertificate> found =
      certify_against(reference_matrices(*other), setup->lighting,
                      moved(outcome.solution.radiosity, same->clusters, cluster_offsets(*other).back()),
                      moved(outcome.gathered, same->gather_rows, gather_offsets(*other).back()), [&console] {
                        console.progress("certificate", 0.0);
                        return !interrupted();
                      });
  console.end_progress();
  if (!found) return tl::unexpected(found.error());
  AnswerCertificate certificate;
  for (const std::uint32_t row : same->gather_rows) certificate.irradiance.push_back(found->irradiance[row]);
  certificate.products = found->products;
  rate(model, outcome.gathered, certificate);
  return certificate;
}

std::string certificate_sentence(const AnswerCertificate& certificate, const std::filesystem::path& full) {
  return fmt::format(
      "certificate: within {:.3g} % of what the rows of {} give for these lights (root mean square over "
      "lumels; {:.3g} % at the worst of them)",
      100.0 * certificate.relative, full.string(), 100.0 * certificate.worst);
}

JsonValue certificate_json(const AnswerCertificate& certificate) {
  return JsonObject{
      {"relative", certificate.relative}, {"worst", certificate.worst}, {"products", certificate.products}};
}

}  // namespace relume
