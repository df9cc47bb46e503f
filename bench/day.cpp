// SPDX-License-Identifier: MIT
//
// relume-day ROOM.relume -o DIR: the demo room from morning to night. Three lights come and go (the window,
// the panel under the ceiling, a warm lamp) and a wall is painted, in frames on the device of two bounces
// each from the frame before, which leave their lightmap in an image. At four hours that image is drawn, and
// beside it the converged answer of the reference for the lighting of the same frame.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>

#include "compute/standalone/frame_session.h"
#include "compute/standalone/solve_on_device.h"
#include "core/model_file.h"
#include "core/reference_solver.h"
#include "precompute/direct_irradiance.h"
#include "tool/auto_camera.h"
#include "tool/output_folder.h"
#include "tool/preview.h"
#include "tool/surface_shading.h"

namespace relume::bench {
namespace {

constexpr double kFirstHour = 5.0;
constexpr double kFramesPerHour = 12.0;
constexpr std::array<double, 4> kPictures = {7.0, 13.0, 18.5, 23.0};  ///< hours
constexpr PictureSize kPictureSize{400, 225};
constexpr const char* kWindow = "window";
constexpr const char* kPanel = "lamp_panel";
constexpr const char* kWall = "wall_back";
const Rgb kPaint(0.16, 0.30, 0.55);
constexpr double kPaintedAt = 15.0;

/// What the room looks like at an hour; lights as shares of what they are at most.
struct Hour {
  Rgb window{0.0};
  double panel = 0.0;
  double lamp = 0.0;
  bool painted = false;
};

/// From 0 to 1 between two hours.
double rise(double hour, double from, double to) {
  return std::clamp((hour - from) / (to - from), 0.0, 1.0);
}

Hour at(double hour) {
  const double height = std::max(0.0, std::sin(kPi * (hour - 5.5) / 14.0));  // of the sun
  const Rgb low(1.0, 0.55, 0.25), high(1.0, 1.0, 1.0), night(0.0007, 0.0009, 0.0015);
  Hour out;
  out.window = height * glm::mix(low, high, std::sqrt(height)) + night;
  out.panel = rise(hour, 17.5, 17.75) * (1.0 - rise(hour, 21.5, 21.75));
  out.lamp = rise(hour, 20.0, 20.1);
  out.painted = hour >= kPaintedAt;
  return out;
}

struct Room {
  Model model;
  std::uint32_t window, panel, wall;  ///< materials
};

Result<Room> read_room(const std::filesystem::path& file) {
  auto model = read_model(file);
  if (!model) return tl::unexpected(model.error());
  std::array<std::uint32_t, 3> found{};
  const std::array<const char*, 3> wanted = {kWindow, kPanel, kWall};
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const auto at = std::find_if(model->materials.begin(), model->materials.end(),
                                 [&](const MaterialRecord& m) { return m.name == wanted[i]; });
    if (at == model->materials.end())
      return fail(ErrorCode::bad_input,
                  fmt::format("{}: expected the demo room, found no material {}", file.string(), wanted[i]));
    found[i] = std::uint32_t(at - model->materials.begin());
  }
  return Room{std::move(*model), found[0], found[1], found[2]};
}

std::vector<kernels::MaterialState> states_of(const Room& room, const Hour& hour) {
  std::vector<kernels::MaterialState> states(room.model.materials.size(),
                                             scaled_material(Rgb(1.0), Rgb(1.0)));
  states[room.window] = scaled_material(Rgb(1.0), hour.window);
  states[room.panel] = scaled_material(Rgb(1.0), Rgb(hour.panel));
  if (hour.painted) states[room.wall] = replaced_material(kPaint, std::nullopt);
  return states;
}

/// The warm lamp.
Light lamp_at(const Hour& hour) {
  Light lamp;
  lamp.position = glm::dvec3(1.6, 1.9, 2.6);
  lamp.intensity = 120.0 * hour.lamp * Rgb(1.0, 0.72, 0.42);
  return lamp;
}

/// The same for the processor, with direct light of its own.
struct ProcessorLighting {
  Lighting lighting;
  std::vector<Rgb> gather_direct;
};

Result<ProcessorLighting> lighting_of(const Room& room, const Hour& hour) {
  ProcessorLighting out{stored_lighting(room.model), {}};
  std::size_t next = 0;
  for (const System& system : room.model.systems) {
    for (const Cluster& cluster : system.clusters) {
      const std::size_t i = next++;
      if (cluster.material == room.window) out.lighting.exitance[i] *= hour.window;
      if (cluster.material == room.panel) out.lighting.exitance[i] *= hour.panel;
      if (cluster.material == room.wall && hour.painted) out.lighting.albedo[i] = kPaint;
    }
  }
  const Light lamp = lamp_at(hour);
  auto direct = direct_irradiance(room.model, {&lamp, 1});
  if (!direct) return tl::unexpected(direct.error());
  out.lighting.direct = std::move(direct->clusters);
  out.gather_direct = std::move(direct->gather);
  return out;
}

/// Irradiance of gather rows, direct and indirect, converged.
Result<std::vector<Rgb>> converged(const Room& room, const ProcessorLighting& lit) {
  const ReferenceMatrices matrices = reference_matrices(room.model);
  const auto solution = solve_reference(matrices.bounce, lit.lighting, {10000, 1e-6});
  if (!solution) return tl::unexpected(solution.error());
  std::vector<Rgb> irradiance = gather(matrices.gather, lit.lighting, solution->radiosity);
  for (std::size_t i = 0; i < irradiance.size(); ++i) irradiance[i] += lit.gather_direct[i];
  return irradiance;
}

/// What the lightmap images (RGBA16F) show for gather rows; sensors have none.
Result<std::vector<Rgb>> in_images(FrameSession& session, const Model& model) {
  std::vector<Rgb> irradiance;
  for (std::uint32_t s = 0; s < model.systems.size(); ++s) {
    const System& system = model.systems[s];
    const auto bytes = session.read_lightmap(s);
    if (!bytes) return tl::unexpected(bytes.error());
    for (const Lumel& lumel : system.lumels) {
      std::uint64_t texel = 0;
      std::memcpy(&texel, &(*bytes)[8 * (std::size_t{system.lightmap_width} * lumel.y + lumel.x)], 8);
      irradiance.emplace_back(glm::unpackHalf4x16(texel));
    }
    irradiance.resize(irradiance.size() + system.sensors.size(), Rgb(0.0));
  }
  return irradiance;
}

/// |a - b| / |b| over valid lumels.
double difference(const Model& model, std::span<const Rgb> a, std::span<const Rgb> b) {
  double off = 0.0, total = 0.0;
  std::size_t row = 0;
  for (const System& system : model.systems) {
    for (const Lumel& lumel : system.lumels) {
      const std::size_t i = row++;
      if ((lumel.flags & kLumelInvalid) != 0) continue;
      off += glm::dot(a[i] - b[i], a[i] - b[i]);
      total += glm::dot(b[i], b[i]);
    }
    row += system.sensors.size();
  }
  return std::sqrt(off / total);
}

/// Both with the exposure of the reference, from where the first picture is best seen.
class Painter {
 public:
  static Result<Painter> create(const Model& model) {
    const Occluders& o = model.occluders;
    auto caster = RayCaster::create(o.positions, o.triangles, o.opacity);
    if (!caster) return tl::unexpected(caster.error());
    return Painter(model, std::move(*caster));
  }

  Result<void> add(const std::string& name, const Lighting& lighting, std::span<const Rgb> shown,
                   std::span<const Rgb> reference, OutputFolder& folder) {
    const std::vector<Rgb> right = samples(lighting, reference), found = samples(lighting, shown);
    const ToneCurve curve = fit_tone_curve(right);
    auto added = folder.add(name + ".device.png", encode_png(develop(found, curve, kPictureSize)));
    if (!added) return added;
    return folder.add(name + ".reference.png", encode_png(develop(right, curve, kPictureSize)));
  }

 private:
  Painter(const Model& model, RayCaster caster) : model_(model), caster_(std::move(caster)) {}

  std::vector<Rgb> samples(const Lighting& lighting, std::span<const Rgb> irradiance) {
    const SurfaceShading shading(model_, lighting, irradiance);
    const ViewedScene scene{model_, caster_, [&](const SeenPoint& p) { return shading.radiance(p); }, sky_};
    if (!camera_) camera_ = choose_camera(scene);
    return cast_picture(scene, *camera_, kPictureSize);
  }

  const Model& model_;
  RayCaster caster_;
  Sky sky_ = Rgb(0.0);
  std::optional<Camera> camera_;
};

/// The picture of the frame that was shown last, and of the answer that it runs after.
Result<void> draw(const Room& room, FrameSession& session, double hour, Painter& painter,
                  OutputFolder& folder) {
  const auto lit = lighting_of(room, at(hour));
  if (!lit) return tl::unexpected(lit.error());
  const auto reference = converged(room, *lit);
  if (!reference) return tl::unexpected(reference.error());
  const auto shown = in_images(session, room.model);
  if (!shown) return tl::unexpected(shown.error());
  const std::string name =
      fmt::format("{:02}{:02}", int(hour), int(std::lround(60.0 * (hour - std::floor(hour)))));
  fmt::print("{}: lumels differ from the converged reference by {:.2g} %\n", name,
             100.0 * difference(room.model, *shown, *reference));
  return painter.add(name, lit->lighting, *shown, *reference, folder);
}

Result<void> run(const std::filesystem::path& file, const std::filesystem::path& output) {
  const auto room = read_room(file);
  if (!room) return tl::unexpected(room.error());
  auto painter = Painter::create(room->model);
  if (!painter) return tl::unexpected(painter.error());
  auto device = StandaloneDevice::create({});
  if (!device) return tl::unexpected(device.error());
  FrameSessionOptions options;
  options.solver.kernel = default_row_kernel(*device, room->model);
  auto session = FrameSession::create(*device, room->model, options);
  if (!session) return tl::unexpected(session.error());
  OutputFolder folder(output);
  std::size_t picture = 0;
  for (int frame = 0; picture < kPictures.size(); ++frame) {
    const double hour = kFirstHour + frame / kFramesPerHour;
    const Hour now = at(hour);
    const Light lamp = lamp_at(now);
    const auto states = states_of(*room, now);
    const auto shown = session->frame({.lights = {&lamp, 1}, .materials = states, .bounces = 2});
    if (!shown) return tl::unexpected(shown.error());
    if (hour < kPictures[picture]) continue;
    if (auto drawn = draw(*room, *session, hour, *painter, folder); !drawn) return drawn;
    ++picture;
  }
  return folder.write();
}

}  // namespace
}  // namespace relume::bench

int main(int argc, char** argv) {
  std::filesystem::path file, output;
  CLI::App app("The demo room from morning to night, in frames on the device.", "relume-day");
  app.add_option("FILE", file, "The precomputed demo room")->required()->check(CLI::ExistingFile);
  app.add_option("-o", output, "Folder of the pictures")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(relume::ErrorCode::usage);
  }
  const auto done = relume::bench::run(file, output);
  if (done) return 0;
  fmt::print(stderr, "relume-day: {}\n", done.error().message);
  return static_cast<int>(done.error().code);
}
