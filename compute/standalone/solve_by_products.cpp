// SPDX-License-Identifier: MIT
#include "compute/standalone/solve_by_products.h"

#include <functional>
#include <optional>
#include <utility>

namespace relume {
namespace {

/// What goes wrong in a product ends the solve.
class DeviceProducts {
 public:
  DeviceProducts(SolverSession& session, const BounceObserver& observer)
      : session_(session), observer_(observer) {}

  std::vector<Rgb> multiply(const std::vector<Rgb>& x) {
    auto product = session_.multiply(x);
    if (product) return std::move(*product);
    error_ = product.error();
    return std::vector<Rgb>(x.size(), Rgb(0.0));
  }

  bool go_on(std::uint32_t bounces, double error_bound) const {
    return !error_ && (!observer_ || observer_(bounces, error_bound));
  }

  const std::optional<Error>& error() const { return error_; }

 private:
  SolverSession& session_;
  const BounceObserver& observer_;
  std::optional<Error> error_;
};

/// S = M + rho (H + K_s b_sky): the bounce of darkness. Then the device is left with K alone.
Result<std::vector<Rgb>> source_and_products(SolverSession& session, const Lighting& lighting) {
  const std::vector<Rgb> black(lighting.albedo.size(), Rgb(0.0)), white(black.size(), Rgb(1.0));
  const std::vector<Rgb> black_sky(lighting.sky_radiosity.size(), Rgb(0.0));
  if (auto lit = session.light(lighting, {}); !lit) return tl::unexpected<Error>(lit.error());
  auto source = session.multiply(black);
  if (!source) return source;
  if (auto lit = session.light(Lighting{white, black, black, black_sky}, {}); !lit)
    return tl::unexpected<Error>(lit.error());
  return source;
}

}  // namespace

Result<Solution> solve_by_products(SolverSession& session, const Model& model, const Lighting& lighting,
                                   const ContractionBound& contraction, double rounding,
                                   const NearAndFar* levels, const StopRule& rule,
                                   const BounceObserver& observer) {
  auto source = source_and_products(session, lighting);
  if (!source) return tl::unexpected<Error>(source.error());
  DeviceProducts products(session, observer);
  BounceProblem problem{nullptr, lighting.albedo, std::move(*source), cluster_areas(model), contraction};
  problem.product = [&products](const std::vector<Rgb>& x) { return products.multiply(x); };
  problem.product_rounding = rounding;
  const BounceObserver go_on = [&products](std::uint32_t count, double bound) {
    return products.go_on(count, bound);
  };
  auto solved = levels == nullptr ? solve_by_bicgstab(problem, rule, go_on)
                                  : solve_by_gmres(problem, *levels, rule, go_on);
  if (products.error()) return tl::unexpected<Error>(*products.error());
  if (!solved) return solved;
  if (auto lit = session.light(lighting, {}); !lit) return tl::unexpected<Error>(lit.error());
  if (auto set = session.set_radiosity(solved->radiosity); !set) return tl::unexpected<Error>(set.error());
  return solved;
}

}  // namespace relume
