// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/light.h"
#include "core/light_patches.h"
#include "core/model.h"
#include "core/quantities.h"
#include "core/result.h"

namespace relume {

/// Irradiance from punctual lights, unreflected, with shadows. lm/m2.
struct DirectIrradiance {
  std::vector<Rgb> clusters;  ///< per cluster of all systems: H of the solve
  std::vector<Rgb> gather;    ///< per gather row (lumels, sensors)
};

/// H of an element is the flux that reaches it over its area: for point lights the solid angles of its
/// patches (core/light_patches.h; A. van Oosterom, J. Strackee, The Solid Angle of a Plane Triangle, 1983),
/// so that the sum of A H over a closed room is the lamp's flux, however near the lamp is; a shadow ray for
/// each patch. What is not opaque passes on the share that it does not stop (RayCaster::transmittance),
/// without noise: of a ray that meets several sheets, the product. Where alpha cuts holes into a lumel, H is
/// the mean over all of it, and counts for the solid part. H of a cluster is the area mean of its elements;
/// sensors are points, lifted as the precompute lifts them. Double precision but for rays;
/// compute/direct_light.h does the same on a device. The same for any number of threads (0 = all).
/// `patches_per_element`: at most kPatchesPerElement, a ray each. Fails when memory runs out.
Result<DirectIrradiance> direct_irradiance(const Model& model, std::span<const Light> lights,
                                           std::uint32_t threads = 0,
                                           double patches_per_element = kPatchesPerElement);

}  // namespace relume
