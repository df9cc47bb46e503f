// SPDX-License-Identifier: MIT
//
// What `solve` says of its own answer: errors by cause, bounds, and the certificate against full rows.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tool/program.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

const std::vector<std::string> kCheckedSizes{"--texel-size", "0.1", "--cluster-size", "0.25"};

std::string precompute_into(const std::filesystem::path& file, const std::string& scene,
                            const std::vector<std::string>& options) {
  std::vector<std::string> command{"precompute", scene, "-o", file.string()};
  command.insert(command.end(), kCheckedSizes.begin(), kCheckedSizes.end());
  command.insert(command.end(), options.begin(), options.end());
  relume_json(command);
  return file.string();
}

TEST(Assurance, NamesEachErrorAndHoldsTheAnswerAgainstFullRows) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  const std::string cut = precompute_into(folder / "cut.relume", scene, {"--error", "10%", "--rows"});
  const std::string full = precompute_into(folder / "full.relume", scene,
                                           {"--error", "10%", "--budget", "65535", "--values", "f32"});
  const auto stored = relume_json({"info", cut}).at("errors");
  EXPECT_GT(stored.at("clusters").get<double>(), 0.0);
  EXPECT_EQ(stored.at("precision"), 0.006);  // sqrt8
  EXPECT_EQ(stored.at("bounds_bytes"), 0);
  const std::string lamp = (folder / "lamp.json").string();
  write_text(lamp, R"({"lights":[{"type":"point","intensity":100,"position":[0.5,0.7,0.4]}]})");

  const auto solved = relume_json({"solve", cut, "-o", (folder / "out").string(), "--lights", lamp,
                                   "--bounds", "--certify", full, "--device", "reference"});
  const auto& errors = solved.at("errors");
  for (const char* cause : {"clusters", "rays", "cut", "precision", "light", "iteration"}) {
    EXPECT_GE(errors.at(cause).get<double>(), 0.0) << cause;
    EXPECT_LT(errors.at(cause).get<double>(), 0.1) << cause;
  }
  EXPECT_GT(errors.at("light").get<double>(), 0.0);
  // The certificate lies inside of what the bracket allows.
  const double certified = solved.at("certificate").at("relative");
  EXPECT_GT(certified, 0.0);
  EXPECT_LT(certified, solved.at("bounds").at("width_of_95_percent").get<double>());

  // The rays that were kept are those of the full rows.
  const auto by_rays = relume_json({"solve", cut, "-o", (folder / "out").string(), "--lights", lamp,
                                    "--certify", cut + ".rows", "--device", "reference"});
  EXPECT_EQ(by_rays.at("certificate").at("relative").get<double>(), certified);

  const auto against_itself = relume_json({"solve", full, "-o", (folder / "out").string(), "--lights", lamp,
                                           "--certify", full, "--device", "reference"});
  EXPECT_LT(against_itself.at("certificate").at("worst").get<double>(), 1e-4);
}

/// Points on the floor and on a wall of the unit box.
std::string grid_of_sensors() {
  std::string csv = "id,px,py,pz,nx,ny,nz\n";
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      const std::string a = std::to_string((i + 0.5) / 6), b = std::to_string((j + 0.5) / 6);
      const std::string name = std::to_string(i) + std::to_string(j);
      csv += "floor" + name + "," + a + ",0," + b + ",0,1,0\n";
      csv += "wall" + name + "," + a + "," + b + ",0,0,0,1\n";
    }
  }
  return csv;
}

std::vector<double> indirect_of(const std::filesystem::path& result) {
  std::string header;
  std::vector<double> values;
  for (auto& row : read_csv(result / "sensors.csv", header)) values.push_back(std::stod(row["indirect_g"]));
  return values;
}

// Of the same lights, with clusters of 50 and of 10 cm.
TEST(Assurance, ClusterSizeIsWhatSmallerClustersChange) {
  const auto solved = [](const std::string& cluster_size) {
    const Precomputed box = precomputed(
        "furnace_box", {"--texel-size", "0.05", "--cluster-size", cluster_size}, grid_of_sensors());
    const std::string lamp = (box.folder / "lamp.json").string();
    write_text(lamp, R"({"lights":[{"type":"point","intensity":1000,"position":[0.5,0.85,0.3]}]})");
    const auto object = solve_json(box, {"--lights", lamp, "--bounds"});
    return std::pair(object.at("errors").at("clusters").get<double>(), indirect_of(box.folder / "result"));
  };
  const auto [coarse_error, coarse] = solved("0.5");
  const auto [fine_error, fine] = solved("0.1");
  double off = 0.0, all = 0.0;
  for (std::size_t i = 0; i < fine.size(); ++i)
    off += std::pow(coarse[i] - fine[i], 2.0), all += std::pow(fine[i], 2.0);
  const double changed = std::sqrt(off / all);
  EXPECT_GT(coarse_error, 0.6 * changed);
  EXPECT_LT(coarse_error, 1.6 * changed);
  EXPECT_LT(fine_error, 0.3 * coarse_error);
}

TEST(Assurance, RaysAreOfNoUseWithoutTheirScene) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  const std::string file = precompute_into(folder / "box.relume", scene, {"--budget", "64", "--rows"});
  std::filesystem::rename(scene, folder / "moved.glb");
  const std::vector<std::string> certify{"solve",    file,        "-o",        (folder / "out").string(),
                                         "--device", "reference", "--certify", file + ".rows"};
  const auto finished = run_relume(certify);
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.err, HasSubstr("expected the scene that its rays were traced in, furnace_box.glb"));
  std::vector<std::string> with_scene = certify;
  with_scene.insert(with_scene.end(), {"--scene", (folder / "moved.glb").string()});
  EXPECT_GE(relume_json(with_scene).at("certificate").at("relative").get<double>(), 0.0);
}

TEST(Assurance, AnswersOfOtherSurfacesAreNotCompared) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = make_scene("furnace_box", folder);
  const std::string one = precompute_into(folder / "one.relume", scene, {});
  const std::string other = (folder / "other.relume").string();
  relume_json({"precompute", scene, "-o", other, "--texel-size", "0.1", "--cluster-size", "0.5"});
  const auto finished = run_relume({"solve", one, "-o", (folder / "out").string(), "--certify", other});
  EXPECT_EQ(finished.status, 3);
  EXPECT_THAT(finished.err, HasSubstr("other.relume: the files have other surfaces"));
  EXPECT_THAT(finished.err, HasSubstr("expected the same scene, texel size and cluster size"));
}

}  // namespace
}  // namespace relume::test
