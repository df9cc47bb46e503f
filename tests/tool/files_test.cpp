// SPDX-License-Identifier: MIT
//
// The whole program on small scenes whose answers are known, with the reference solver: exit statuses, JSON
// keys, columns and values.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene/generate_scene.h"
#include "scene/load_scene.h"
#include "scene/shapes.h"
#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

constexpr double kPiValue = 3.14159265358979323846;

double number(const std::map<std::string, std::string>& row, const std::string& column) {
  return std::stod(row.at(column));
}

TEST(Files, InfoHasTheKeysThatScriptsRelyOn) {
  const Precomputed box = precomputed("furnace_box", kCoarse, "id,px,py,pz,nx,ny,nz\na,0.5,0.5,0.5,0,1,0\n");
  const nlohmann::json info = relume_json({"info", box.file});
  EXPECT_EQ(info.at("systems"), 1);
  EXPECT_EQ(info.at("sensors"), 1);
  EXPECT_EQ(info.at("probes"), 0);
  EXPECT_EQ(info.at("sky_patches"), 0);                     // a closed room
  EXPECT_TRUE(info.at("errors").at("clusters").is_null());  // no target
  EXPECT_EQ(info.at("errors").at("precision"), 1e-4);       // 16 bits
  EXPECT_EQ(info.at("file_bytes"), std::filesystem::file_size(box.file));
  EXPECT_EQ(info.at("geometry_hash").get<std::string>().size(), 16u);
  EXPECT_NEAR(info.at("area").get<double>(), 6.0, 1e-5);
  const auto clusters = info.at("clusters").get<int>();
  const auto lumels = info.at("lumels").get<int>();
  EXPECT_GE(clusters, 6 * 16);  // six faces of 1 m2 in clusters of at most 0.25 m
  EXPECT_GE(lumels, 6 * 100);
  for (const char* name : {"bounce", "gather"}) {
    const nlohmann::json& matrix = info.at(name);
    EXPECT_EQ(matrix.at("columns"), clusters);
    EXPECT_GT(matrix.at("nonzeros").get<int>(), clusters);
    EXPECT_LE(matrix.at("max_row_sum").get<double>(), 1.0);
    EXPECT_GT(matrix.at("max_row_sum").get<double>(), 0.99);
  }
  EXPECT_EQ(info.at("bounce").at("rows"), clusters);
  EXPECT_EQ(info.at("gather").at("rows"), lumels + 1);
}

TEST(Files, CheckPassesAndRefusesAFlippedBit) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  EXPECT_EQ(relume_json({"check", box.file}).at("passed"), true);
  std::string bytes = read_text(box.file);
  bytes[bytes.size() / 2] ^= 1;
  write_text(box.file, bytes);
  const Finished refused = run_relume({"check", box.file});
  EXPECT_THAT(refused.status, testing::AnyOf(1, 3));
  EXPECT_THAT(refused.err, HasSubstr(box.file));
}

TEST(Files, CheckFindsNoWallsInsideABox) {
  const Precomputed box = precomputed("furnace_box", {"--texel-size", "0.1", "--budget", "16"});
  const nlohmann::json leaks = relume_json({"check", box.file, "--leaks"}).at("leaks");
  EXPECT_GE(leaks.at("lumels").at("rows").get<int>(), 6 * 100);
  EXPECT_GE(leaks.at("clusters").at("rows").get<int>(), 6);
  EXPECT_EQ(leaks.at("lumels").at("largest_walled"), 0.0);
  EXPECT_EQ(leaks.at("clusters").at("largest_walled"), 0.0);
  EXPECT_TRUE(leaks.at("worst_walled").empty());
}

TEST(Files, FurnaceRadiosityIsExitanceOverOneMinusAlbedo) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  const nlohmann::json solved = solve_json(box, {"--tolerance", "1e-6"});
  EXPECT_EQ(solved.at("device"), "reference");
  // ln 1e-6 / ln 0.5: bounces would take 20.
  EXPECT_EQ(solved.at("method"), "bicgstab");
  EXPECT_THAT(solved.at("method_reason").get<std::string>(), HasSubstr("bounces could take 20"));
  EXPECT_LT(solved.at("bounces").get<int>(), 20);
  EXPECT_LE(solved.at("error_bound").get<double>(), 1e-6);
  EXPECT_LE(solved.at("relative_residual").get<double>(), 1e-6);
  EXPECT_EQ(solved.at("lit_by_rig"), false);
  EXPECT_GT(solved.at("seconds").at("total").get<double>(), 0.0);

  std::string header;
  const auto rows = read_csv(box.folder / "result" / "clusters.csv", header);
  EXPECT_EQ(header,
            "id,system,px,py,pz,nx,ny,nz,area,albedo_r,albedo_g,albedo_b,exitance_r,exitance_g,exitance_b,"
            "direct_r,direct_g,direct_b,radiosity_r,radiosity_g,radiosity_b");
  double area = 0.0;
  for (const auto& row : rows) {
    EXPECT_NEAR(number(row, "albedo_r"), 0.5, 1e-6);
    EXPECT_NEAR(number(row, "exitance_g"), kPiValue, 1e-5);  // radiance 1 cd/m2
    EXPECT_EQ(number(row, "direct_b"), 0.0);
    EXPECT_NEAR(number(row, "radiosity_b"), 2.0 * kPiValue,
                2e-3 * kPiValue);  // pi / (1 - 0.5), the furnace's 0.1 %
    area += number(row, "area");
  }
  EXPECT_NEAR(area, 6.0, 1e-4);
}

TEST(Files, BouncesAreCounted) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  EXPECT_EQ(solve_json(box, {"--bounces", "2"}).at("bounces"), 2);
  std::string header;
  for (const auto& row : read_csv(box.folder / "result" / "clusters.csv", header)) {
    EXPECT_NEAR(number(row, "radiosity_r"), kPiValue * (1.0 + 0.5 + 0.25),
                1e-3 * kPiValue);  // B0 = M, twice M + 0.5 K B
  }
}

TEST(Files, LightmapsForEnginesAreWrittenWhenAskedFor) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  const nlohmann::json solved = solve_json(box, {"--ktx2", "rgb9e5"});
  EXPECT_EQ(solved.at("files").size(), 9u);
  const std::string system = relume_json({"info", box.file}).at("system_list")[0].at("name");
  for (const char* kind : {".direct.ktx2", ".indirect.ktx2"}) {
    const std::string bytes = read_text(box.folder / "result" / "lightmaps" / (system + kind));
    EXPECT_EQ(bytes.substr(1, 6), "KTX 20") << kind;
  }
  const Finished refused =
      run_relume({"solve", box.file, "-o", (box.folder / "other").string(), "--ktx2", "bc6h"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("rgba16f or r11g11b10f or rgb9e5"));
}

TEST(Files, SolveWritesWhatItPromises) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  const nlohmann::json info = relume_json({"info", box.file});
  const nlohmann::json solved = solve_json(box);
  const std::filesystem::path result = box.folder / "result";
  for (const auto& path : solved.at("files"))
    EXPECT_TRUE(std::filesystem::is_regular_file(path.get<std::string>())) << path;
  const std::string system = info.at("system_list")[0].at("name");
  for (const std::string& name :
       {"lightmaps/" + system + ".direct.exr", "lightmaps/" + system + ".indirect.exr",
        std::string("lightmaps.json"), std::string("clusters.csv"), std::string("sensors.csv"),
        std::string("result.glb"), std::string("preview.png")}) {
    EXPECT_TRUE(std::filesystem::is_regular_file(result / name)) << name;
  }
  EXPECT_EQ(solved.at("files").size(), 7u);

  const auto lightmaps = nlohmann::json::parse(read_text(result / "lightmaps.json"));
  const nlohmann::json& lightmap = lightmaps.at("lightmaps").at(0);
  EXPECT_EQ(lightmap.at("system"), system);
  EXPECT_EQ(lightmap.at("width"), info.at("system_list")[0].at("lightmap")[0]);
  EXPECT_EQ(lightmap.at("charts").at(0).at("node"), "wall");
  EXPECT_TRUE(lightmap.at("charts").at(0).at("uv_set").is_null());

  // Inward faces are drawn from inside only: the same 12 triangles come back.
  const Result<Scene> scene = load_scene(result / "result.glb");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->triangles.size(), 12u);
  EXPECT_TRUE(scene->materials[scene->surfaces[0].material].unlit);
  EXPECT_TRUE(scene->surfaces[0].has_uv1);
}

/// For a plane of 10 m.
const std::vector<std::string> kPlaneSizes{"--texel-size", "0.25", "--cluster-size", "1"};

// A lamp of 100 cd, 2 m above the middle of a plane: E = I cos / d2.
TEST(Files, SensorsUnderALamp) {
  const Precomputed plane = precomputed("light_plane", kPlaneSizes,
                                        "id,px,py,pz,nx,ny,nz\n"
                                        "under,0,0,0,0,1,0\n"
                                        "aside,1.5,0,0,0,2,0\n"
                                        "turned,0,0.5,0,1,0,0\n");
  write_text(plane.folder / "lights.json",
             R"({"lights":[{"type":"point","color":[1,0.5,0],"intensity":100,"position":[0,2,0]}]})");
  const nlohmann::json solved = solve_json(plane, {"--lights", plane.folder / "lights.json"});
  EXPECT_EQ(solved.at("lit_by_rig"), false);
  std::string header;
  const auto rows = read_csv(plane.folder / "result" / "sensors.csv", header);
  EXPECT_EQ(header, "id,px,py,pz,nx,ny,nz,direct_r,direct_g,direct_b,indirect_r,indirect_g,indirect_b");
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].at("id"), "under");
  EXPECT_EQ(rows[1].at("id"), "aside");
  EXPECT_EQ(rows[2].at("id"), "turned");
  EXPECT_NEAR(number(rows[0], "direct_r"), 25.0, 0.025);  // 100 / 4; sensors are lifted by micrometres
  EXPECT_NEAR(number(rows[0], "direct_g"), 12.5, 0.0125);
  EXPECT_EQ(number(rows[0], "direct_b"), 0.0);
  EXPECT_NEAR(number(rows[1], "direct_r"), 100.0 * 0.8 / 6.25, 0.0128);  // d2 = 4 + 2.25, cos = 2 / 2.5
  EXPECT_EQ(number(rows[2], "direct_r"), 0.0);    // the lamp is in the sensor's own plane
  EXPECT_EQ(number(rows[0], "indirect_r"), 0.0);  // a plane does not see itself
  EXPECT_NEAR(number(rows[1], "ny"), 1.0, 1e-6);
}

// Nothing hides the sky from a plane that looks up: I = pi L.
TEST(Files, SkyOverAPlane) {
  const Precomputed plane = precomputed("light_plane", kPlaneSizes, "id,px,py,pz,nx,ny,nz\nup,0,0,0,0,1,0\n");
  solve_json(plane, {"--sky", "1,2,0.5"});
  std::string header;
  const auto rows = read_csv(plane.folder / "result" / "sensors.csv", header);
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_NEAR(number(rows[0], "indirect_r"), kPiValue,
              1e-5);  // the form factors of one row sum to 1 within rounding
  EXPECT_NEAR(number(rows[0], "indirect_g"), 2.0 * kPiValue, 2e-5);
  EXPECT_NEAR(number(rows[0], "indirect_b"), 0.5 * kPiValue, 1e-5);
  EXPECT_EQ(number(rows[0], "direct_r"), 0.0);
}

TEST(Files, TheRigIsNamedAndGoesOutWhenSomethingElseShines) {
  const Precomputed plane = precomputed("light_plane", kPlaneSizes);
  const Finished lit =
      run_relume({"solve", plane.file, "-o", plane.folder / "result", "--device", "reference", "--json"});
  const auto json = nlohmann::json::parse(lit.out);
  EXPECT_EQ(json.at("lit_by_rig"), true);
  EXPECT_THAT(lit.err, HasSubstr("rig"));
  EXPECT_THAT(json.at("warnings").dump(), HasSubstr("rig"));
  EXPECT_EQ(solve_json(plane, {"--sky", "1,1,1"}).at("lit_by_rig"), false);
  std::string header;
  for (const auto& row : read_csv(plane.folder / "result" / "clusters.csv", header))
    EXPECT_EQ(number(row, "direct_r"), 0.0);
}

TEST(Files, MaterialsReplaceAlbedoAndEmission) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  write_text(box.folder / "materials.json",
             R"({"materials":{"wall":{"albedo":[0.25,0.5,0.75],"emission":[2,2,2]}}})");
  solve_json(box, {"--materials", box.folder / "materials.json", "--tolerance", "1e-6"});
  std::string header;
  for (const auto& row : read_csv(box.folder / "result" / "clusters.csv", header)) {
    EXPECT_NEAR(number(row, "radiosity_r"), 2.0 * kPiValue / 0.75, 1e-2);
    EXPECT_NEAR(number(row, "radiosity_g"), 2.0 * kPiValue / 0.5, 1.3e-2);
    EXPECT_NEAR(number(row, "radiosity_b"), 2.0 * kPiValue / 0.25, 2.6e-2);
  }
}

TEST(Files, AnEditedSceneBringsColoursAndAMovedOneIsRefused) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  GlbScene edited = *generate_scene("furnace_box");
  edited.materials[0].base_color = Rgb(0.2);
  edited.materials[0].emission = Rgb(3.0);
  const std::string recoloured = box.folder / "recoloured.glb";
  ASSERT_TRUE(write_glb(edited, recoloured));
  solve_json(box, {"--scene", recoloured, "--tolerance", "1e-6"});
  std::string header;
  for (const auto& row : read_csv(box.folder / "result" / "clusters.csv", header)) {
    EXPECT_NEAR(number(row, "radiosity_r"), 3.0 * kPiValue / 0.8, 1.2e-2);
  }
  edited.meshes[0].primitives[0].positions[0].x += 0.125f;
  const std::string moved = box.folder / "moved.glb";
  ASSERT_TRUE(write_glb(edited, moved));
  const Finished refused =
      run_relume({"solve", box.file, "-o", box.folder / "moved", "--device", "reference", "--scene", moved});
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.err, HasSubstr("wall"));
  EXPECT_FALSE(std::filesystem::exists(box.folder / "moved"));
}

// Form factors of the unit cube (J. Howell, A Catalog of Radiation Heat Transfer Configuration Factors, C-11
// and C-14).
TEST(Files, FactorsOfAUnitCube) {
  const glm::dvec3 x(1, 0, 0), y(0, 1, 0), z(0, 0, 1), origin(0.0);
  GlbScene cube;
  const auto add = [&](const char* name, const glm::dvec3& corner, const glm::dvec3& u, const glm::dvec3& v) {
    GlbPrimitive mesh;
    append_quad(mesh, corner, u, v);
    add_surface(cube, name, Rgb(0.5), std::move(mesh));
  };
  add("left", origin, y, z);
  add("right", x, z, y);
  add("bottom", origin, z, x);
  add("top", y, x, z);
  add("back", origin, x, y);
  add("front", z, y, x);
  const std::string scene = fresh_folder() / "cube.glb";
  ASSERT_TRUE(write_glb(cube, scene));
  const nlohmann::json json = relume_json({"factors", scene, "--rays", "65536"});
  EXPECT_EQ(json.at("surfaces"), nlohmann::json({"left", "right", "bottom", "top", "back", "front"}));
  for (int i = 0; i < 6; ++i) {
    EXPECT_NEAR(json.at("areas")[i].get<double>(), 1.0, 1e-9);
    for (int j = 0; j < 6; ++j) {
      const double expected = i == j ? 0.0 : i / 2 == j / 2 ? 0.1998249 : 0.2000438;
      const double error = json.at("standard_error")[i][j].get<double>();
      EXPECT_NEAR(json.at("factors")[i][j].get<double>(), expected, std::max(5.0 * error, 1e-9))
          << i << " " << j;
      EXPECT_LT(error, 1e-3);
    }
  }
}

TEST(Files, ExportedMatrixHasTheRowsThatInfoCounts) {
  const Precomputed box = precomputed("furnace_box", kCoarse);
  const nlohmann::json info = relume_json({"info", box.file});
  const std::string folder = box.folder / "exported";
  const nlohmann::json exported = relume_json({"export", box.file, "--matrices", "mtx", "--glb", "--debug",
                                               "validity", "--debug", "clusters", "-o", folder});
  EXPECT_EQ(exported.at("files").size(), 2u + 1u + 2u * 3u);
  std::istringstream text(read_text(folder + "/bounce.mtx"));
  std::string line;
  std::getline(text, line);
  EXPECT_EQ(line, "%%MatrixMarket matrix coordinate real general");
  while (text.peek() == '%') std::getline(text, line);
  std::size_t rows = 0, columns = 0, entries = 0;
  text >> rows >> columns >> entries;
  EXPECT_EQ(rows, info.at("clusters").get<std::size_t>());
  EXPECT_EQ(columns, info.at("bounce").at("columns").get<std::size_t>());
  EXPECT_EQ(entries, info.at("bounce").at("nonzeros").get<std::size_t>());
  std::vector<double> sums(rows + 1, 0.0);
  std::size_t read = 0, row = 0, column = 0;
  for (double value = 0.0; text >> row >> column >> value; ++read) {
    ASSERT_TRUE(row >= 1 && row <= rows && column >= 1 && column <= columns);
    sums[row] += value;
  }
  EXPECT_EQ(read, entries);
  EXPECT_NEAR(*std::max_element(sums.begin(), sums.end()), info.at("bounce").at("max_row_sum").get<double>(),
              1e-12);
}

TEST(Files, DebugViewsTellTheirScales) {
  const Precomputed box = precomputed("furnace_box", {"--error", "30%", "--texel-size", "0.1"});
  const std::vector<std::string> views{"cut",     "error",      "form_factors", "leaks",     "rays",
                                       "row_sum", "row_length", "tree_level",   "uv_overlap"};
  std::vector<std::string> command{"export", box.file, "-o", box.folder / "views", "--at", "0.5,0,0.5"};
  for (const std::string& view : views) command.insert(command.end(), {"--debug", view});
  const nlohmann::json exported = relume_json(command);
  ASSERT_EQ(exported.at("views").size(), views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const nlohmann::json& scale = exported.at("views")[i];
    EXPECT_EQ(scale.at("view"), views[i]);
    EXPECT_LT(scale.at("black").get<double>(), scale.at("white").get<double>());
    EXPECT_LE(scale.at("least").get<double>(), scale.at("most").get<double>());
    EXPECT_FALSE(scale.at("unit").get<std::string>().empty());
  }
  EXPECT_NEAR(exported.at("views")[5].at("mean").get<double>(), 1.0, 1e-6);  // a closed box
  EXPECT_LT(exported.at("views")[3].at("most").get<double>(), 1e-6);         // without a wall inside
  const Precomputed full = precomputed("furnace_box", kCoarse);
  const Finished refused = run_relume({"export", full.file, "-o", full.folder, "--debug", "error"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("--error or --budget"));
}

// A furnace: whatever is loaded, each surface would have M / (1 - albedo) if all of it were.
TEST(Files, SystemsAloneSayWhatTheyLack) {
  std::vector<std::string> options = kCoarse;
  options.insert(options.end(), {"--system-lumels", "250"});
  const Precomputed box = precomputed("furnace_box", options, "id,px,py,pz,nx,ny,nz\na,0.4,0.5,0.5,0,1,0\n");
  const nlohmann::json info = relume_json({"info", box.file});
  ASSERT_EQ(info.at("systems"), 3);
  EXPECT_THAT(run_relume({"info", box.file}).out, HasSubstr("\n  system1: "));
  EXPECT_TRUE(solve_json(box).at("missing_systems").is_null());
  std::string header;
  const double full =
      std::stod(read_csv(box.folder / "result" / "clusters.csv", header).at(0).at("radiosity_r"));

  std::string holder;
  for (const nlohmann::json& system : info.at("system_list")) {
    if (system.at("sensors") == 1) holder = system.at("name");
  }
  const nlohmann::json solved = solve_json(
      box, {"--systems", holder, "--missing-radiosity", std::to_string(full), "--tolerance", "1e-6"});
  const nlohmann::json& missing = solved.at("missing_systems");
  EXPECT_EQ(missing.at("systems").size(), 2u);
  EXPECT_NEAR(missing.at("assumed_radiosity").at(0).get<double>(), full, 1e-5);
  // Of a wall that is loaded with one other or more, at most what is not loaded; of a cube's faces, 4 at
  // least.
  EXPECT_GT(missing.at("mean_share").get<double>(), 0.2);
  EXPECT_LE(missing.at("largest_share").get<double>(), 1.0);
  const auto sensor = read_csv(box.folder / "result" / "sensors.csv", header).at(0);
  const double found = std::stod(sensor.at("indirect_r"));
  const double lacking = missing.at("largest_irradiance").at(0);
  EXPECT_LT(found, full);
  EXPECT_GE(found + lacking, full * (1.0 - 1e-5));
  EXPECT_LE(lacking, full * (1.0 + 1e-5));

  const Finished warned = run_relume(
      {"solve", box.file, "-o", box.folder / "part", "--device", "reference", "--systems", "system1"});
  EXPECT_EQ(warned.status, 0);
  EXPECT_THAT(warned.err, HasSubstr("2 of 3 systems are not loaded: "));
  EXPECT_THAT(warned.err, HasSubstr("the most of those loaded"));
  const Finished refused = run_relume(
      {"solve", box.file, "-o", box.folder / "part", "--device", "reference", "--systems", "system1,hall"});
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("expected one of the systems system0, system1, system2, found 'hall'"));
}

TEST(Files, TheSameInputGivesTheSameFileForAnyNumberOfThreads) {
  const Precomputed one =
      precomputed("two_rooms", {"--threads", "1", "--texel-size", "0.3", "--cluster-size", "0.6"});
  const Precomputed many =
      precomputed("two_rooms", {"--threads", "4", "--texel-size", "0.3", "--cluster-size", "0.6"});
  EXPECT_TRUE(read_text(one.file) == read_text(many.file));
}

}  // namespace
}  // namespace relume::test
