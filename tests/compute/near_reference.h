// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "compute/standalone/solve_on_device.h"
#include "core/compare.h"
#include "core/directional_irradiance.h"
#include "core/probe_coefficients.h"
#include "core/reference_solver.h"

namespace relume::test {

/// The promise of 32-bit solves against the reference of the same decoded matrices and number of bounces:
/// rows of a few dozen terms round by some 2^-24 each, amplified by 1 / (1 - q) with q up to 0.99.
inline constexpr double kDeviceTolerance = 1e-5;

inline testing::AssertionResult near_reference(const char* what, const std::vector<Rgb>& values,
                                               const std::vector<Rgb>& reference,
                                               const std::vector<Rgb>& magnitudes = {}) {
  if (values.size() != reference.size()) {
    return testing::AssertionFailure()
           << what << ": " << values.size() << " values, expected " << reference.size();
  }
  const Comparison result = compare(what, values, reference, magnitudes);
  if (result.max_relative_error <= kDeviceTolerance) return testing::AssertionSuccess();
  return testing::AssertionFailure() << what << ": relative error " << result.max_relative_error << " at "
                                     << result.worst_index << ", channel " << result.worst_channel << ": "
                                     << result.worst_value << ", expected " << result.worst_reference;
}

/// Device against reference after the device's number of bounces.
inline testing::AssertionResult agrees_with_reference(const DeviceSolution& device, const Model& model,
                                                      const Lighting& lighting) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const auto reference = solve_reference(matrices.bounce, lighting, {device.solution.bounces, 0.0});
  if (!reference) return testing::AssertionFailure() << reference.error().message;
  if (auto result = near_reference("radiosity", device.solution.radiosity, reference->radiosity); !result) {
    return result;
  }
  if (auto result = near_reference("irradiance", device.irradiance,
                                   gather(matrices.gather, lighting, reference->radiosity));
      !result) {
    return result;
  }
  const FlatMoments moments = flat_moments(directional_irradiance(model, lighting, reference->radiosity),
                                           gather(matrices.gather, lighting, reference->radiosity));
  if (auto result =
          near_reference("moments of irradiance", flat_moments(device.moments, device.irradiance).values,
                         moments.values, moments.magnitudes);
      !result) {
    return result;
  }
  const FlatCoefficients probes =
      flat_coefficients(probe_coefficients(model, lighting, reference->radiosity));
  return near_reference("coefficients of probes", flat_coefficients(device.probes).values, probes.values,
                        probes.magnitudes);
}

}  // namespace relume::test
