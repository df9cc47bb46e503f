// SPDX-License-Identifier: MIT
#include "tool/export_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <utility>

#include "core/model_file.h"
#include "core/reference_solver.h"
#include "tool/auto_camera.h"
#include "tool/debug_view.h"
#include "tool/matrix_export.h"
#include "tool/model_glb.h"
#include "tool/output_folder.h"
#include "tool/preview.h"
#include "tool/result_tables.h"

namespace relume {
namespace {

std::vector<ByteImage> srgb_images(const std::vector<ColorImage>& images) {
  std::vector<ByteImage> coded;
  for (const ColorImage& image : images) coded.push_back(srgb_image(image));
  return coded;
}

Result<void> add_matrix(const std::string& name, const std::string& title, const CsrMatrix& matrix,
                        const std::string& format, OutputFolder& folder) {
  if (format == "npz") return folder.add(name + ".npz", encode_npz(matrix));
  folder.add(name + ".mtx", encode_mtx(matrix, title));
  return {};
}

Result<void> add_matrices(const Model& model, const std::string& format, OutputFolder& folder) {
  const ReferenceMatrices matrices = reference_matrices(model);
  const std::string leaves = "columns: clusters of all systems, then sky patches";
  const std::string columns = leaves + ", then nodes of the cluster trees";
  auto added = add_matrix("bounce", "bounce matrix K; rows: clusters; " + columns, matrices.bounce.rows,
                          format, folder);
  if (!added) return added;
  added = add_matrix("gather", "gather matrix G; rows: lumels, then sensors, system by system; " + columns,
                     matrices.gather.rows, format, folder);
  if (!added || matrices.bounce.nodes.rows == 0) return added;
  return add_matrix("nodes", "node matrix P; rows: nodes of the cluster trees; " + leaves,
                    matrices.bounce.nodes, format, folder);
}

/// Makes shapes readable in a picture of flat colours: brighter towards one fixed direction.
double relief(const Model& model, const SeenPoint& point) {
  const glm::vec3& a = occluder_corner(model.occluders, point.triangle, 0);
  const glm::vec3 normal = glm::cross(occluder_corner(model.occluders, point.triangle, 1) - a,
                                      occluder_corner(model.occluders, point.triangle, 2) - a);
  const float facing = glm::dot(glm::normalize(normal), glm::normalize(glm::vec3(0.5f, 0.8f, 0.3f)));
  return 0.7 + 0.3 * double(point.side == Side::front ? facing : -facing);
}

using SurfaceColor = std::function<Rgb(const SeenPoint&)>;

/// Pictures of a model from one camera, that shows it well: so that views can be laid side by side.
class Photographer {
 public:
  static Result<Photographer> create(const Model& model) {
    Result<RayCaster> caster =
        RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
    if (!caster) return tl::unexpected(caster.error());
    Photographer photographer(model, std::move(*caster));
    const auto grey = [&](const SeenPoint& point) { return Rgb(relief(model, point)); };
    photographer.camera_ = choose_camera({model, photographer.caster_, grey, photographer.no_sky_});
    return photographer;
  }

  /// The colours of a debug view on the surfaces.
  ByteImage picture(const std::vector<ColorImage>& images) const {
    const SurfaceColor color = [&](const SeenPoint& point) {
      const std::optional<LightmapPlace> place = lightmap_place(model_, point);
      if (!place || images[place->system].pixels.empty()) return Rgb(0.0);
      const ColorImage& image = images[place->system];
      const glm::vec2 last(image.width - 1, image.height - 1);
      const glm::uvec2 texel(glm::clamp(glm::floor(place->texel), glm::vec2(0.0f), last));
      return relief(model_, point) * Rgb(image.at(texel.x, texel.y));
    };
    return develop_flat(cast_picture({model_, caster_, color, no_sky_}, camera_));
  }

 private:
  Photographer(const Model& model, RayCaster caster) : model_(model), caster_(std::move(caster)) {}

  const Model& model_;
  RayCaster caster_;
  Sky no_sky_ = Rgb(0.0);
  Camera camera_;
};

Result<DebugView> add_debug_view(const Model& model, const std::string& view, const glm::dvec3& at,
                                 const Photographer& photographer, OutputFolder& folder) {
  Result<DebugView> drawn = draw_debug_view(model, view, at);
  if (!drawn) return drawn;
  const std::vector<ColorImage>& images = drawn->images;
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < images.size(); ++s) {
    if (images[s].pixels.empty()) continue;
    const auto added =
        folder.add(fmt::format("debug/{}.{}.png", view, names[s]), encode_png(srgb_image(images[s])));
    if (!added) return tl::unexpected(added.error());
  }
  const auto pictured =
      folder.add(fmt::format("debug/{}.png", view), encode_png(photographer.picture(images)));
  if (!pictured) return tl::unexpected(pictured.error());
  const auto added =
      folder.add(fmt::format("debug/{}.glb", view), encode_model_glb(model, srgb_images(images)));
  if (!added) return tl::unexpected(added.error());
  return drawn;
}

/// `scales` gets those of the debug views.
Result<void> add_all(const Model& model, const ExportArguments& arguments, OutputFolder& folder,
                     Console& console, JsonArray& scales) {
  if (!arguments.matrices.empty()) {
    if (const auto added = add_matrices(model, arguments.matrices, folder); !added) return added;
  }
  if (arguments.glb) {
    const auto albedo = draw_debug_view(model, "albedo");
    if (!albedo) return tl::unexpected(albedo.error());
    const auto added = folder.add("model.glb", encode_model_glb(model, srgb_images(albedo->images)));
    if (!added) return added;
  }
  if (arguments.debug.empty()) return {};
  const auto photographer = Photographer::create(model);
  if (!photographer) return tl::unexpected(photographer.error());
  for (const std::string& view : arguments.debug) {
    auto added = add_debug_view(model, view, arguments.at.value_or(glm::dvec3(0.0)), *photographer, folder);
    if (!added) return tl::unexpected(added.error());
    console.say(added->legend);
    scales.emplace_back(std::move(added->scale));
  }
  return {};
}

}  // namespace

Result<int> run(const ExportArguments& arguments, Console& console) {
  const bool needs_place = std::count(arguments.debug.begin(), arguments.debug.end(), "form_factors") > 0;
  if (needs_place && !arguments.at) {
    return fail(ErrorCode::usage,
                "--debug form_factors: expected --at X,Y,Z (world space, m), the receiver to draw them of, "
                "found none");
  }
  const Result<Model> model = read_model(arguments.file);
  if (!model) return tl::unexpected(model.error());
  OutputFolder folder(arguments.output);
  JsonArray scales;
  if (const auto added = add_all(*model, arguments, folder, console, scales); !added)
    return tl::unexpected(added.error());
  if (const Result<void> written = folder.write(); !written) return tl::unexpected(written.error());
  for (const std::filesystem::path& path : folder.paths()) console.say(path.string());
  console.finish({{"files", json_array(folder.paths())}, {"views", std::move(scales)}});
  return 0;
}

}  // namespace relume
