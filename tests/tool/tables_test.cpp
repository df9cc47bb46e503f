// SPDX-License-Identifier: MIT
//
// Text and numbers that other programs read.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <map>
#include <nlohmann/json.hpp>

#include "support/tiny_model.h"
#include "tool/json_value.h"
#include "tool/leak_report.h"
#include "tool/matrix_export.h"
#include "tool/result_tables.h"

namespace relume::test {
namespace {

//   [ 0.5  0    0.25 ]
//   [ 0    0    0    ]
//   [ 0    0.1  0    ]
CsrMatrix drawn_matrix() {
  return {3, 3, {0, 2, 2, 3}, {0, 2, 1}, {0.5, 0.25, 0.1}};
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(MatrixExport, MatrixMarketCountsFromOne) {
  EXPECT_EQ(text_of(encode_mtx(drawn_matrix(), "drawn")),
            "%%MatrixMarket matrix coordinate real general\n% drawn\n3 3 3\n1 1 0.5\n1 3 0.25\n3 2 0.1\n");
}

template <class Number>
Number read_number(const std::string& bytes, std::size_t offset) {
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

/// Entries of a zip of stored files, by its central directory, checksums verified.
std::map<std::string, std::string> unzip(const std::string& zip) {
  std::map<std::string, std::string> files;
  const std::size_t end = zip.size() - 22;
  EXPECT_EQ(zip.substr(end, 4), "PK\x05\x06");
  std::size_t place = read_number<std::uint32_t>(zip, end + 16);
  for (int i = read_number<std::uint16_t>(zip, end + 10); i > 0; --i) {
    EXPECT_EQ(zip.substr(place, 4), "PK\x01\x02");
    const auto checksum = read_number<std::uint32_t>(zip, place + 16);
    const auto size = read_number<std::uint32_t>(zip, place + 20);
    const auto name_size = read_number<std::uint16_t>(zip, place + 28);
    const auto local = read_number<std::uint32_t>(zip, place + 42);
    const std::string name = zip.substr(place + 46, name_size);
    EXPECT_EQ(zip.substr(local, 4), "PK\x03\x04");
    EXPECT_EQ(zip.substr(local + 30, name_size), name);
    files[name] = zip.substr(local + 30 + name_size, size);
    EXPECT_EQ(crc32(0, reinterpret_cast<const unsigned char*>(files[name].data()), size), checksum);
    place += 46 + name_size;
  }
  return files;
}

/// Data of a .npy file behind its header, whose dictionary must be `dictionary`.
std::string npy_data(const std::string& npy, const std::string& dictionary) {
  EXPECT_EQ(npy.substr(0, 8), std::string("\x93NUMPY\x01\x00", 8));
  const auto header_size = read_number<std::uint16_t>(npy, 8);
  EXPECT_EQ((10 + header_size) % 64, 0);
  EXPECT_THAT(npy.substr(10, header_size), testing::StartsWith(dictionary));
  return npy.substr(10 + header_size);
}

TEST(MatrixExport, NpzHoldsWhatScipyAsksFor) {
  const Result<std::vector<std::byte>> bytes = encode_npz(drawn_matrix());
  ASSERT_TRUE(bytes);
  auto files = unzip(text_of(*bytes));
  ASSERT_EQ(files.size(), 5u);
  const std::string data =
      npy_data(files["data.npy"], "{'descr': '<f8', 'fortran_order': False, 'shape': (3,), }");
  ASSERT_EQ(data.size(), 24u);
  EXPECT_EQ(read_number<double>(data, 0), 0.5);
  EXPECT_EQ(read_number<double>(data, 16), 0.1);
  const std::string indices =
      npy_data(files["indices.npy"], "{'descr': '<i4', 'fortran_order': False, 'shape': (3,), }");
  EXPECT_EQ(read_number<std::int32_t>(indices, 4), 2);
  const std::string indptr =
      npy_data(files["indptr.npy"], "{'descr': '<i8', 'fortran_order': False, 'shape': (4,), }");
  EXPECT_EQ(read_number<std::int64_t>(indptr, 24), 3);
  EXPECT_EQ(npy_data(files["format.npy"], "{'descr': '|S3', 'fortran_order': False, 'shape': (), }"), "csr");
  const std::string shape =
      npy_data(files["shape.npy"], "{'descr': '<i8', 'fortran_order': False, 'shape': (2,), }");
  EXPECT_EQ(read_number<std::int64_t>(shape, 8), 3);
}

TEST(JsonValue, KeepsTypesAndOrder) {
  const std::string text = to_json_text(
      {{"z", 1.5}, {"a", std::uint64_t{18446744073709551615u}}, {"list", JsonArray{true, "x", JsonValue()}}});
  EXPECT_EQ(nlohmann::ordered_json::parse(text).dump(),
            R"({"z":1.5,"a":18446744073709551615,"list":[true,"x",null]})");
}

TEST(JsonValue, NumbersThatAreNotFiniteBecomeNull) {
  const std::string text = to_json_text({{"nan", std::nan("")}, {"bytes", std::string("a\xff")}});
  EXPECT_TRUE(nlohmann::json::parse(text).at("nan").is_null());
}

TEST(ResultTables, SensorsComeInTheOrderOfTheirFile) {
  Model model = tiny_model();
  model.sensor_names = {"later", "first"};
  Sensor sensor = model.systems[0].sensors.at(0);
  model.systems[0].sensors = {sensor, sensor};
  model.systems[0].sensors[0].name = 1;
  model.systems[0].sensors[1].name = 0;
  const std::size_t rows = gather_offsets(model).back();
  std::vector<Rgb> direct(rows, Rgb(1.0)), indirect(rows, Rgb(2.0));
  const std::size_t lumels = model.systems[0].lumels.size();
  direct[lumels] = Rgb(10.0);      // of the sensor whose name is "first"
  direct[lumels + 1] = Rgb(20.0);  // of "later"
  const std::string text = sensors_csv(model, direct, indirect, nullptr);
  EXPECT_THAT(text, testing::HasSubstr("\nlater,"));
  EXPECT_LT(text.find("\nlater,"), text.find("\nfirst,"));
  EXPECT_THAT(text, testing::HasSubstr(",20,20,20,2,2,2\nfirst,"));
  EXPECT_THAT(text, testing::EndsWith(",10,10,10,2,2,2\n"));
}

TEST(ResultTables, BoundsAreSixMoreColumnsAndNoiseIsThree) {
  const Model model = tiny_model();
  const Lighting lighting = stored_lighting(model);
  const Bracket clusters{{Rgb(1.0), Rgb(2.0)}, {Rgb(3.0), Rgb(4.0)}};
  const std::string text = clusters_csv(model, lighting, std::vector<Rgb>(2, Rgb(2.5)), &clusters, nullptr);
  EXPECT_THAT(text, testing::HasSubstr("radiosity_b,radiosity_low_r,radiosity_low_g,radiosity_low_b,"
                                       "radiosity_high_r,radiosity_high_g,radiosity_high_b\n0,"));
  EXPECT_THAT(text, testing::HasSubstr(",2.5,2.5,2.5,1,1,1,3,3,3\n1,"));
  EXPECT_THAT(text, testing::EndsWith(",2.5,2.5,2.5,2,2,2,4,4,4\n"));
  const std::vector<Rgb> noise{Rgb(0.5), Rgb(0.25)};
  const std::string with_noise =
      clusters_csv(model, lighting, std::vector<Rgb>(2, Rgb(2.5)), nullptr, &noise);
  EXPECT_THAT(with_noise,
              testing::HasSubstr("radiosity_b,radiosity_noise_r,radiosity_noise_g,radiosity_noise_b\n0,"));
  EXPECT_THAT(with_noise, testing::EndsWith(",2.5,2.5,2.5,0.25,0.25,0.25\n"));
}

TEST(ResultTables, FileNamesOfSystemsAreSafeAndUnique) {
  Model model;
  model.systems.resize(4);
  model.systems[0].name = "hall/east wing";
  model.systems[1].name = "hall_east wing";
  model.systems[2].name = "../up";
  model.systems[3].name = "";
  EXPECT_THAT(system_file_names(model),
              testing::ElementsAre("hall_east_wing", "hall_east_wing_2", "_._up", "system"));
}

TEST(LeakReport, NamesTheWorstRowsAndTheirSenders) {
  LeakReport report;
  report.lumels = {2, 0.0625, 0.125, 0.03125, 0.0625};
  report.rows = {
      {LeakReceiver::lumel, 0, 0, 0, {1, 2, 3.5}, 0.125, 0.0625, {1, 0}, 1, {4, 5, 6}},
      {LeakReceiver::lumel, 1, 0, 1, {0, 0, 0}, 0.0, 0.0},
  };
  const Model model = tiny_model();
  const std::vector<std::string> lines = leak_lines(model, report);
  ASSERT_EQ(lines.size(), 7u);
  EXPECT_EQ(lines[1], "  2 lumels: walled 0.031 mean, 0.062 worst; hidden 0.062 mean, 0.12 worst");
  EXPECT_EQ(lines[2], "  0 clusters: walled 0 mean, 0 worst; hidden 0 mean, 0 worst");
  EXPECT_EQ(lines[3], "worst walled:");
  EXPECT_EQ(lines[4],
            "  0.062 at (1.000, 2.000, 3.500) on room/floor (lumel 0 of floor), most from (4.000, 5.000, "
            "6.000) on room/lid");
  EXPECT_EQ(lines[5], "worst hidden:");
  EXPECT_THAT(lines[6], testing::StartsWith("  0.12 at (1.000"));

  const nlohmann::json json = nlohmann::json::parse(to_json_text(leaks_json(model, report)));
  EXPECT_EQ(json["lumels"]["largest_hidden"], 0.125);
  ASSERT_EQ(json["worst_walled"].size(), 1u);
  EXPECT_EQ(json["worst_walled"][0]["walled"], 0.0625);
  EXPECT_EQ(json["worst_walled"][0]["sender_system"], "lid");
  EXPECT_EQ(json["worst_walled"][0]["sender_place"], nlohmann::json({4.0, 5.0, 6.0}));
}

}  // namespace
}  // namespace relume::test
