// SPDX-License-Identifier: MIT
#include "tool/export_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

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

/// The debug colours on the surfaces, from a camera that shows them well.
Result<ByteImage> debug_picture(const Model& model, const std::vector<ColorImage>& images) {
  const Result<RayCaster> caster =
      RayCaster::create(model.occluders.positions, model.occluders.triangles, model.occluders.opacity);
  if (!caster) return tl::unexpected(caster.error());
  const auto color = [&](const SeenPoint& point) {
    const std::optional<LightmapPlace> place = lightmap_place(model, point);
    if (!place || images[place->system].pixels.empty()) return Rgb(0.0);
    const ColorImage& image = images[place->system];
    const glm::vec2 last(image.width - 1, image.height - 1);
    const glm::uvec2 texel(glm::clamp(glm::floor(place->texel), glm::vec2(0.0f), last));
    return relief(model, point) * Rgb(image.at(texel.x, texel.y));
  };
  const Sky no_sky = Rgb(0.0);
  const ViewedScene scene{model, *caster, color, no_sky};
  return develop_flat(cast_picture(scene, choose_camera(scene)));
}

Result<void> add_debug_view(const Model& model, const std::string& view, const glm::dvec3& at,
                            OutputFolder& folder) {
  const std::vector<ColorImage> images = draw_debug_view(model, view, at);
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < images.size(); ++s) {
    if (images[s].pixels.empty()) continue;
    const auto added =
        folder.add(fmt::format("debug/{}.{}.png", view, names[s]), encode_png(srgb_image(images[s])));
    if (!added) return added;
  }
  const Result<ByteImage> picture = debug_picture(model, images);
  if (!picture) return tl::unexpected(picture.error());
  if (const auto added = folder.add(fmt::format("debug/{}.png", view), encode_png(*picture)); !added)
    return added;
  return folder.add(fmt::format("debug/{}.glb", view), encode_model_glb(model, srgb_images(images)));
}

Result<void> add_all(const Model& model, const ExportArguments& arguments, OutputFolder& folder) {
  if (!arguments.matrices.empty()) {
    if (const auto added = add_matrices(model, arguments.matrices, folder); !added) return added;
  }
  if (arguments.glb) {
    const auto added =
        folder.add("model.glb", encode_model_glb(model, srgb_images(draw_debug_view(model, "albedo"))));
    if (!added) return added;
  }
  for (const std::string& view : arguments.debug) {
    const auto added = add_debug_view(model, view, arguments.at.value_or(glm::dvec3(0.0)), folder);
    if (!added) return added;
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
  if (const auto added = add_all(*model, arguments, folder); !added) return tl::unexpected(added.error());
  if (const Result<void> written = folder.write(); !written) return tl::unexpected(written.error());
  for (const std::filesystem::path& path : folder.paths()) console.say(path.string());
  console.finish({{"files", json_array(folder.paths())}});
  return 0;
}

}  // namespace relume
