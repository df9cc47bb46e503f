// SPDX-License-Identifier: MIT
#include <compute/standalone/solve_on_device.h>
#include <precompute/precompute.h>
#include <scene/load_scene.h>

bool bakes() {
  relume::PrecomputeReport report;
  const auto missing = relume::load_scene("/nowhere/scene.glb");
  const auto device =
      relume::StandaloneDevice::create({.validation = false, .device_name = "no such device"});
  return !missing && !device && report.rays == 0;
}
