// SPDX-License-Identifier: MIT
//
// Files that people write: what they mean, and the sentence for each mistake.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/tiny_model.h"
#include "tool/lighting_setup.h"
#include "tool/lights_json.h"
#include "tool/materials_json.h"
#include "tool/program.h"
#include "tool/sensors_csv.h"

namespace relume::test {
namespace {

using testing::HasSubstr;

struct Mistake {
  std::string text;
  std::string sentence;  ///< part of it
};

/// Expects bad_input with the file's name and the sentence for each mistake.
template <class Read>
void expect_refused(const std::vector<Mistake>& mistakes, Read read) {
  const std::filesystem::path file = fresh_folder() / "input.txt";
  for (const Mistake& mistake : mistakes) {
    write_text(file, mistake.text);
    const auto result = read(file);
    ASSERT_FALSE(result) << mistake.text;
    EXPECT_EQ(result.error().code, ErrorCode::bad_input);
    EXPECT_THAT(result.error().message, HasSubstr(file.string()));
    EXPECT_EQ(result.error().message.find('\n'), std::string::npos) << result.error().message;
    EXPECT_THAT(result.error().message, HasSubstr(mistake.sentence)) << mistake.text;
  }
}

TEST(LightsFile, MeansWhatKhrLightsPunctualMeans) {
  const std::filesystem::path file = fresh_folder() / "lights.json";
  write_text(file, R"({"lights":[
    {"type":"point","color":[1,0.5,0.25],"intensity":100,"position":[1,2,3],"range":8},
    {"type":"spot","position":[0,1,0],"direction":[0,-2,0],"innerConeAngle":0.1,"outerConeAngle":0.5,"name":"desk"},
    {"type":"directional","intensity":50000,"direction":[3,0,4]}]})");
  const Result<std::vector<Light>> lights = read_lights(file);
  ASSERT_TRUE(lights) << lights.error().message;
  ASSERT_EQ(lights->size(), 3u);
  EXPECT_EQ((*lights)[0].type, LightType::point);
  EXPECT_EQ((*lights)[0].intensity, Rgb(100, 50, 25));
  EXPECT_EQ((*lights)[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ((*lights)[0].range, 8.0);
  EXPECT_EQ((*lights)[1].type, LightType::spot);
  EXPECT_EQ((*lights)[1].name, "desk");
  EXPECT_EQ((*lights)[1].intensity, Rgb(1.0));
  EXPECT_EQ((*lights)[1].direction, glm::dvec3(0, -1, 0));
  EXPECT_EQ((*lights)[1].inner_cone_angle, 0.1);
  EXPECT_EQ((*lights)[1].outer_cone_angle, 0.5);
  EXPECT_EQ((*lights)[2].type, LightType::directional);
  EXPECT_NEAR((*lights)[2].direction.x, 0.6, 1e-15);
  EXPECT_NEAR((*lights)[2].direction.z, 0.8, 1e-15);
}

TEST(LightsFile, MistakesAreNamedByTheirPath) {
  const std::vector<Mistake> mistakes{
      {"", "expected JSON"},
      {"{\"lights\":[", "expected JSON"},
      {"[]", ": /: expected an object, found []"},
      {"{}", "/lights: expected a value, found none"},
      {R"({"lights":{}})", "/lights: expected an array"},
      {R"({"lights":[],"sky":1})", "/sky: expected one of lights, found an unknown member"},
      {R"({"lights":[1]})", "/lights/0: expected an object, found 1"},
      {R"({"lights":[{}]})", "/lights/0/type: expected one of point, spot, directional, found none"},
      {R"({"lights":[{"type":"area"}]})", "found \"area\""},
      {R"({"lights":[{"type":"point"}]})", "/lights/0/position: expected a value, found none"},
      {R"({"lights":[{"type":"spot","position":[0,0,0]}]})", "/lights/0/direction: expected a value"},
      {R"({"lights":[{"type":"point","position":[0,0]}]})", "/lights/0/position: expected three numbers"},
      {R"({"lights":[{"type":"point","position":[0,0,"x"]}]})", "/lights/0/position: expected three numbers"},
      {R"({"lights":[{"type":"point","position":[0,0,0],"intensity":-1}]})",
       "/lights/0/intensity: expected a number"},
      {R"({"lights":[{"type":"point","position":[0,0,0],"color":[1,1,-1]}]})",
       "/lights/0/color: expected three numbers"},
      {R"({"lights":[{"type":"directional","direction":[0,0,0]}]})", "expected a vector longer than 0"},
      {R"({"lights":[{"type":"point","position":[0,0,0],"colour":[1,1,1]}]})",
       "/lights/0/colour: expected one of"},
      {R"({"lights":[{"type":"spot","position":[0,0,0],"direction":[0,0,1],"innerConeAngle":0.8}]})",
       "/lights/0/innerConeAngle: expected an angle below outerConeAngle"},
      {std::string(100000, '['), "expected JSON"},
  };
  expect_refused(mistakes, read_lights);
}

TEST(MaterialsFile, ReplacesOnlyWhatItNames) {
  const Model model = tiny_model();
  Lighting lighting = stored_lighting(model);
  const Lighting before = lighting;
  const std::string name = model.materials[model.systems[0].clusters[0].material].name;
  const std::filesystem::path file = fresh_folder() / "materials.json";
  write_text(file, R"({"materials":{")" + name + R"(":{"emission":[1,2,3]}}})");
  const auto overrides = read_material_overrides(file, model);
  ASSERT_TRUE(overrides) << overrides.error().message;
  EXPECT_EQ(apply_material_overrides(model, *overrides, 0.95, lighting), 0u);
  EXPECT_NEAR(lighting.exitance[0].y, 2.0 * kPi, 1e-12);
  EXPECT_EQ(lighting.albedo[0], before.albedo[0]);

  write_text(file, R"({"materials":{")" + name + R"(":{"albedo":[0.99,0.5,0]}}})");
  const auto bright = read_material_overrides(file, model);
  ASSERT_TRUE(bright);
  EXPECT_EQ(apply_material_overrides(model, *bright, 0.95, lighting), 1u);
  EXPECT_EQ(lighting.albedo[0], Rgb(0.95, 0.5, 0.0));
}

TEST(MaterialsFile, MistakesAreNamedByTheirPath) {
  const Model model = tiny_model();
  const std::string name = model.materials[0].name;
  const std::vector<Mistake> mistakes{
      {"{}", "/materials: expected a value, found none"},
      {R"({"materials":[]})", "/materials: expected an object"},
      {R"({"materials":{"unobtainium":{}}})",
       "/materials/unobtainium: expected a material of the model (" + name},
      {R"({"materials":{"a\nb":{}}})", R"(/materials/a\nb: expected a material of the model)"},
      {R"({"mater\nials":{}})", "/materials: expected a value"},
      {R"({"materials":{")" + name + R"(":{"albedo":[2,0,0]}}})",
       "/materials/" + name + "/albedo: expected three numbers from 0 to 1, found [2,0,0]"},
      {R"({"materials":{")" + name + R"(":{"emission":7}}})",
       "/emission: expected three numbers of at least 0, found 7"},
      {R"({"materials":{")" + name + R"(":{"roughness":1}}})",
       "/roughness: expected one of albedo, emission"},
  };
  expect_refused(mistakes,
                 [&](const std::filesystem::path& file) { return read_material_overrides(file, model); });
}

TEST(SensorsFile, ColumnsMayStandInAnyOrder) {
  const std::filesystem::path file = fresh_folder() / "sensors.csv";
  write_text(file,
             "\xef\xbb\xbfnote, pz,py,px,nx,ny,nz,id\r\n"
             "x,3,2,1,0,0,-2,first\r\n"
             "\r\n"
             "y, 6 ,5e0,-4,1,0,0,7\r\n");
  const Result<std::vector<SensorPoint>> sensors = read_sensors(file);
  ASSERT_TRUE(sensors) << sensors.error().message;
  ASSERT_EQ(sensors->size(), 2u);
  EXPECT_EQ((*sensors)[0].name, "first");
  EXPECT_EQ((*sensors)[0].position, glm::dvec3(1, 2, 3));
  EXPECT_EQ((*sensors)[0].normal, glm::dvec3(0, 0, -2));
  EXPECT_EQ((*sensors)[1].name, "7");
  EXPECT_EQ((*sensors)[1].position, glm::dvec3(-4, 5, 6));
}

TEST(SensorsFile, MistakesAreNamedByTheirLine) {
  const std::string header = "id,px,py,pz,nx,ny,nz\n";
  const std::vector<Mistake> mistakes{
      {"", "line 1: expected the header id,px,py,pz,nx,ny,nz"},
      {"1,2,3,4,5,6,7\n", "line 1: expected the header"},
      {"id,px,py,pz\n", "line 1: expected the header"},
      {header + "a,1,2,3,0,1\n", "line 2: expected 7 cells, found '6'"},
      {header + "a,1,2,3,0,1,0\nb,1,2,x,0,1,0\n", "line 3: expected a number, found 'x'"},
      {header + "a,1,2,nan,0,1,0\n", "line 2: expected a number, found 'nan'"},
      {header + "a,1,2,1e300,0,1,0\n", "line 2: expected a number, found '1e300'"},
      {header + "a,1,2,3,0,0,0\n", "line 2: expected a normal that is not zero"},
      {header + "a,1,2,3,0,1,0\n\na,1,2,3,0,1,0\n",
       "line 4: expected an id that no other sensor has, found 'a'"},
      {header + ",1,2,3,0,1,0\n", "line 2: expected an id without quotes, found 'none'"},
  };
  expect_refused(mistakes, read_sensors);
}

TEST(ProbesFile, NeedsNoNormals) {
  const std::filesystem::path file = fresh_folder() / "probes.csv";
  write_text(file, "id,px,py,pz\nfirst,1,2,3\n7,-4,5,6\n");
  const Result<std::vector<ProbePoint>> probes = read_probes(file);
  ASSERT_TRUE(probes) << probes.error().message;
  ASSERT_EQ(probes->size(), 2u);
  EXPECT_EQ((*probes)[0].name, "first");
  EXPECT_EQ((*probes)[1].position, glm::dvec3(-4, 5, 6));
}

TEST(ProbesFile, MistakesAreNamedByTheirLine) {
  const std::string header = "id,px,py,pz\n";
  const std::vector<Mistake> mistakes{
      {"", "line 1: expected the header id,px,py,pz"},
      {"a,1,2,3\n", "line 1: expected the header id,px,py,pz"},
      {header + "a,1,2\n", "line 2: expected 4 cells, found '3'"},
      {header + "a,1,2,3\nb,1,2,x\n", "line 3: expected a number, found 'x'"},
      {header + "a,1,2,3\na,1,2,3\n", "line 3: expected an id that no other probe has, found 'a'"},
  };
  expect_refused(mistakes, read_probes);
}

TEST(SkyOption, IsATripleOrAFile) {
  EXPECT_EQ(parse_triple("1,2.5,0"), Rgb(1, 2.5, 0));
  EXPECT_EQ(parse_triple("1e3,0,0"), Rgb(1000, 0, 0));
  for (const char* text :
       {"", "1", "1,2", "1,2,3,4", "1,2,-3", "1,2,x", "1,2,nan", "1, 2,3", "1,2,3 ", "sky.hdr"}) {
    EXPECT_FALSE(parse_triple(text)) << text;
  }
}

}  // namespace
}  // namespace relume::test
