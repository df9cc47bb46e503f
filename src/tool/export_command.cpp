// SPDX-License-Identifier: MIT
#include "tool/export_command.h"

#include <fmt/format.h>

#include "core/model_file.h"
#include "core/reference_solver.h"
#include "tool/debug_view.h"
#include "tool/matrix_export.h"
#include "tool/model_glb.h"
#include "tool/output_folder.h"
#include "tool/result_tables.h"

namespace relume {
namespace {

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
  auto added =
      add_matrix("bounce", "bounce matrix K; rows: clusters; " + columns, matrices.bounce.rows, format, folder);
  if (!added) return added;
  added = add_matrix("gather", "gather matrix G; rows: lumels, then sensors, system by system; " + columns,
                     matrices.gather.rows, format, folder);
  if (!added || matrices.bounce.nodes.rows == 0) return added;
  return add_matrix("nodes", "node matrix P; rows: nodes of the cluster trees; " + leaves, matrices.bounce.nodes,
                    format, folder);
}

Result<void> add_debug_view(const Model& model, const std::string& view, OutputFolder& folder) {
  const std::vector<ByteImage> images = draw_debug_view(model, view);
  const std::vector<std::string> names = system_file_names(model);
  for (std::size_t s = 0; s < images.size(); ++s) {
    if (images[s].pixels.empty()) continue;
    const auto added = folder.add(fmt::format("debug/{}.{}.png", view, names[s]), encode_png(images[s]));
    if (!added) return added;
  }
  return folder.add(fmt::format("debug/{}.glb", view), encode_model_glb(model, images));
}

Result<void> add_all(const Model& model, const ExportArguments& arguments, OutputFolder& folder) {
  if (!arguments.matrices.empty()) {
    if (const auto added = add_matrices(model, arguments.matrices, folder); !added) return added;
  }
  if (arguments.glb) {
    const auto added = folder.add("model.glb", encode_model_glb(model, draw_debug_view(model, "albedo")));
    if (!added) return added;
  }
  for (const std::string& view : arguments.debug) {
    if (const auto added = add_debug_view(model, view, folder); !added) return added;
  }
  return {};
}

}  // namespace

Result<int> run(const ExportArguments& arguments, Console& console) {
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
