// SPDX-License-Identifier: MIT
//
// What a solve says in numbers: clusters.csv, sensors.csv, probes.csv, probes.exr, lightmaps.json.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "core/bracket.h"
#include "core/model.h"
#include "core/probe_coefficients.h"
#include "core/result.h"
#include "core/solve.h"

namespace relume {

/// Header id,system,px,py,pz,nx,ny,nz,area, then albedo_, exitance_, direct_ and radiosity_ each with r, g,
/// b. One line per cluster, numbered through; world space, m2, lm/m2. With `bracket` (null: without) also
/// radiosity_low_ and radiosity_high_; with `noise`, its standard error by rays, radiosity_noise_.
std::string clusters_csv(const Model& model, const Lighting& lighting, std::span<const Rgb> radiosity,
                         const Bracket* bracket, const std::vector<Rgb>* noise);

/// Header id,px,py,pz,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b: lux, in the order
/// of the sensors' own file. Direct is what arrives from punctual lights unreflected, indirect all that
/// arrives through form factors. With `bracket` (null: without) also indirect_low_ and indirect_high_.
std::string sensors_csv(const Model& model, std::span<const Rgb> gather_direct,
                        std::span<const Rgb> gather_indirect, const Bracket* bracket);

/// Header id,px,py,pz,valid (1 or 0), then c0_r,c0_g,c0_b ... c8_r,c8_g,c8_b: the coefficients of incident
/// radiance in the order of Harmonics; in the order of the probes' own file.
std::string probes_csv(const Model& model, std::span<const ProbeCoefficients> coefficients);

/// The same for a renderer to load: a row of nine texels for each probe, by Probe::name, in the order of
/// Harmonics, so that row by row it is what GpuSolver::probe_coefficients() holds and ProbeCell::probes
/// count. Alpha is 1 of a valid probe, 0 of one that is invalid or not loaded.
Result<std::vector<std::byte>> probes_exr(const Model& model,
                                          std::span<const ProbeCoefficients> coefficients);

/// Names of files are unique and hold only letters, digits, '.', '_' and '-'; one per system.
std::vector<std::string> system_file_names(const Model& model);

/// Where each node's surface lies in the lightmaps: lightmap coordinates (0..1, origin top left) = uv * scale
/// + offset, uv taken from the node's UV set, or from TEXCOORD_1 of result.glb where `uv_set` is null.
std::string lightmaps_json(const Model& model);

}  // namespace relume
