// SPDX-License-Identifier: MIT
#include "core/model_file.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "core/reference_solver.h"
#include "core/section_table.h"
#include "support/tiny_model.h"

namespace relume {
namespace {

TEST(ModelFile, ComesBackAsItWas) {
  const Model model = test::tiny_model();
  ASSERT_TRUE(check_model(model)) << check_model(model).error().message;
  const std::vector<std::byte> bytes = encode_model(model);
  const auto read = decode_model(bytes, "tiny");
  ASSERT_TRUE(read) << read.error().message;
  // All of it: what is read encodes to the same bytes.
  EXPECT_EQ(encode_model(*read), bytes);

  EXPECT_EQ(read->origin, model.origin);
  EXPECT_EQ(read->geometry_hash, model.geometry_hash);
  EXPECT_EQ(read->sky_cells, model.sky_cells);
  EXPECT_TRUE(read->materials[1].double_sided);
  EXPECT_FALSE(read->materials[0].possible_emitter);
  EXPECT_EQ(read->nodes[1].path, "room/lid");
  EXPECT_EQ(read->nodes[1].geometry_hash, 12u);
  EXPECT_EQ(read->sensor_names, model.sensor_names);
  EXPECT_EQ(read->lights[1].outer_cone_angle, 0.5);
  EXPECT_EQ(read->lights[0].name, "bulb");
  EXPECT_EQ(read->sky_radiance, model.sky_radiance);
  EXPECT_TRUE(read->lit_by_rig);
  ASSERT_TRUE(read->camera);
  EXPECT_EQ(read->provenance.options, model.provenance.options);
  EXPECT_EQ(read->occluders.triangles, model.occluders.triangles);
  EXPECT_EQ(read->occluders.back_uv, model.occluders.back_uv);
  ASSERT_EQ(read->occluders.opacity.triangles.size(), 2u);
  EXPECT_EQ(read->occluders.opacity.triangles[1].corners[2].z, 0.25f);
  EXPECT_EQ(read->occluders.opacity.maps[0].solid, 0.75f);
  EXPECT_EQ(read->occluders.opacity.texels, model.occluders.opacity.texels);
  EXPECT_EQ(read->occluders.texture, model.occluders.texture);
  ASSERT_EQ(read->systems.size(), 2u);
  EXPECT_EQ(read->systems[0].name, "floor");
  EXPECT_EQ(read->systems[0].sensors[0].position, model.systems[0].sensors[0].position);
  EXPECT_EQ(read->systems[0].gather.rows, 2u);
  EXPECT_EQ(read->systems[0].gather.columns, 2u);
  EXPECT_EQ(read->systems[0].gather.blocks[0].codec, ValueCodec::unorm16);
  EXPECT_EQ(read->systems[1].bounce.blocks[0].values, model.systems[1].bounce.blocks[0].values);
}

TEST(ModelFile, KeepsNodesOfTrees) {
  Model model = test::tiny_model();
  model.sky_cells = {8, 3};
  model.sky_tree = {{{0, 2, 0}}, {0.25f, 0.75f}};
  model.systems[0].imports = {{1, 0}, {kSkySystem, 2}};
  const auto read = decode_model(encode_model(model), "nodes");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->sky_tree.nodes, model.sky_tree.nodes);
  EXPECT_EQ(read->sky_tree.shares, model.sky_tree.shares);
  EXPECT_EQ(read->systems[0].imports, model.systems[0].imports);
  model.systems[0].imports[1].index = 3;
  EXPECT_FALSE(decode_model(encode_model(model), "nodes")) << "there is no such node";
}

TEST(ModelFile, AnEmptyModelIsAModel) {
  const auto read = decode_model(encode_model(Model{}), "empty");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->systems.empty());
  EXPECT_FALSE(read->camera);
  EXPECT_FALSE(read->sky_radiance);
}

TEST(ModelFile, EverySingleBitFlipIsRefused) {
  std::vector<std::byte> bytes = encode_model(test::tiny_model());
  for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
    const std::byte mask = std::byte{1} << (bit % 8);
    bytes[bit / 8] ^= mask;
    const auto read = decode_model(bytes, "flipped");
    ASSERT_FALSE(read) << "bit " << bit % 8 << " of byte " << bit / 8;
    EXPECT_EQ(read.error().code, ErrorCode::bad_input);
    bytes[bit / 8] ^= mask;
  }
}

TEST(ModelFile, EveryTruncationIsRefused) {
  std::vector<std::byte> bytes = encode_model(test::tiny_model());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const auto read = decode_model(std::span(bytes).first(length), "cut");
    ASSERT_FALSE(read) << length << " bytes";
    EXPECT_EQ(read.error().code, ErrorCode::bad_input);
  }
  bytes.push_back(std::byte{0});
  EXPECT_FALSE(decode_model(bytes, "longer"));
}

TEST(ModelFile, MessagesNameFilePlaceExpectedAndFound) {
  std::vector<std::byte> bytes = encode_model(test::tiny_model());
  const auto message = [&bytes] { return decode_model(bytes, "room.relume").error().message; };
  bytes[8] = std::byte{2};
  EXPECT_EQ(message(), "room.relume: byte 8: expected file version 1, found 2");
  bytes[8] = std::byte{1};
  const std::size_t end = bytes.size();
  bytes[end - 1] ^= std::byte{1};
  EXPECT_NE(message().find("room.relume: section 'GBLK' of system 1 at byte "), std::string::npos)
      << message();
  EXPECT_NE(message().find("expected checksum"), std::string::npos) << message();
}

/// Files whose checksums are right but whose content is not: sections of the tiny model, changed by `edit`
/// and laid out again.
template <class Edit>
Result<Model> rewritten(Edit&& edit) {
  const std::vector<std::byte> bytes = encode_model(test::tiny_model());
  SectionWriter file;
  const auto sections = read_sections(bytes, "tiny");
  for (const Section& section : sections.value()) {
    const std::string id(section.record.id.begin(), section.record.id.end());
    std::vector<std::byte> content(section.bytes.begin(), section.bytes.end());
    edit(file, id, section.record.owner, content);
  }
  return decode_model(std::move(file).finish(), "rewritten");
}

template <class T>
void patch(std::vector<std::byte>& content, std::size_t offset, T value) {
  std::memcpy(content.data() + offset, &value, sizeof value);
}

std::string message_of(const Result<Model>& read) {
  return read ? "accepted" : read.error().message;
}

TEST(ModelFile, WhatNeedsANewerReaderIsRefusedAndWhatMayBeSkippedIsSkipped) {
  const std::vector<std::byte> extra(5, std::byte{7});
  const auto with_extra = [&extra](std::uint32_t owner, std::uint32_t flags) {
    return rewritten([&](SectionWriter& file, const std::string& id, std::uint32_t section_owner,
                         const std::vector<std::byte>& content) {
      file.add(id, section_owner, content);
      if ((owner == kNone && id == "INFO") || (owner == section_owner && id == "IMPT")) {
        file.add("XTRA", owner, extra, flags);
      }
    });
  };
  const auto skipped = with_extra(kNone, kSectionOptional);
  ASSERT_TRUE(skipped) << skipped.error().message;
  EXPECT_EQ(encode_model(*skipped), encode_model(test::tiny_model()));
  EXPECT_TRUE(with_extra(1, kSectionOptional));
  EXPECT_NE(message_of(with_extra(kNone, 0)).find("'XTRA' of the model"), std::string::npos);
  EXPECT_NE(message_of(with_extra(1, 0)).find("'XTRA' of system 1"), std::string::npos);
  EXPECT_FALSE(with_extra(0, 2)) << "a flag that nobody knows";
}

TEST(ModelFile, SectionsStandInOrderAndOnce) {
  const auto twice = rewritten([](SectionWriter& file, const std::string& id, std::uint32_t owner,
                                  const std::vector<std::byte>& content) {
    file.add(id, owner, content);
    if (id == "CLUS") file.add(id, owner, content);
  });
  EXPECT_NE(message_of(twice).find("expected it once"), std::string::npos) << message_of(twice);
  const auto headless = rewritten([](SectionWriter& file, const std::string& id, std::uint32_t owner,
                                     const std::vector<std::byte>& content) {
    if (id != "INFO") file.add(id, owner, content);
  });
  EXPECT_NE(message_of(headless).find("INFO"), std::string::npos) << message_of(headless);
  const auto nameless = rewritten([](SectionWriter& file, const std::string& id, std::uint32_t owner,
                                     const std::vector<std::byte>& content) {
    if (id != "SYST" || owner != 1) file.add(id, owner, content);
  });
  EXPECT_NE(message_of(nameless).find("SYST"), std::string::npos) << message_of(nameless);
}

TEST(ModelFile, SizesAreCheckedBeforeAnythingIsAllocated) {
  const auto with = [](const char* section, std::size_t offset, auto value) {
    return message_of(rewritten([&](SectionWriter& file, const std::string& id, std::uint32_t owner,
                                    std::vector<std::byte>& content) {
      if (id == section) patch(content, offset, value);
      file.add(id, owner, content);
    }));
  };
  // INFO: number of systems at byte 44. SYST: length of the name at 8. KBLK: rows, offsets and columns at 4,
  // 16 and 20.
  EXPECT_NE(with("INFO", 44, 0xffffffffu).find("expected 2 systems"), std::string::npos);
  EXPECT_NE(with("SYST", 8, 0xffffffffu).find("expected more bytes"), std::string::npos);
  EXPECT_NE(with("KBLK", 4, 0xffffffffu).find("expected more bytes"), std::string::npos);
  EXPECT_NE(with("KBLK", 16, 0xffffffffu).find("expected more bytes"), std::string::npos);
  EXPECT_NE(with("KBLK", 20, 0xffffffffu).find("expected more bytes"), std::string::npos);
  EXPECT_NE(with("KBLK", 8, 0x20000000u).find("tiles of 1 or 8"), std::string::npos);
  EXPECT_NE(with("KBLK", 12, 3u).find("value codec"), std::string::npos);
  EXPECT_NE(with("MATL", 0, 8u).find("known flags"), std::string::npos);
  EXPECT_NE(with("MATL", 4, 0xffffffffu).find("expected more bytes"), std::string::npos);
}

/// What a reader says of the tiny model's file with another `value` at byte `offset` of header or table,
/// under the checksum that it asks for.
template <class T>
std::string message_of_table(std::size_t offset, T value) {
  std::vector<std::byte> bytes = encode_model(test::tiny_model());
  patch(bytes, offset, value);
  const std::string asked = message_of(decode_model(bytes, "tiny"));
  const std::size_t found = asked.rfind("found ");
  if (asked.find("byte 24: expected checksum") == std::string::npos) return asked;
  patch(bytes, 24, std::uint64_t{std::stoull(asked.substr(found + 6), nullptr, 16)});
  return message_of(decode_model(bytes, "tiny"));
}

TEST(ModelFile, ATableThatLiesIsRefusedUnderTheRightChecksum) {
  // The second section: flags at byte 8 of its 40, zero at 12, place at 16, length at 24.
  const std::size_t second = 32 + 40;
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(message_of_table(12, 0xffffffffu), "byte 12: expected room for 4294967295 sections");
  expect(message_of_table(16, std::uint64_t{1} << 40), "byte 16: expected 1099511627776 bytes");
  expect(message_of_table(second + 8, 2u), "expected known flags, found 0x2");
  expect(message_of_table(second + 12, 1u), "expected known flags");
  expect(message_of_table(second + 16, std::uint64_t{1} << 40), "expected it at byte ");
  expect(message_of_table(second + 24, std::uint64_t{0}), "found 0");
  expect(message_of_table(second + 24, std::uint64_t{1} << 40), "found 1099511627776");
  expect(message_of_table(second, std::uint32_t{0x01010101u}), std::string(4, '?'));
}

TEST(ModelFile, AFileThatIsShorterThanItSaysIsRefused) {
  // Files of this kind tell the size of a page, whatever they hold.
  const std::filesystem::path file = "/sys/kernel/mm/transparent_hugepage/enabled";
  std::error_code ignored;
  if (std::filesystem::file_size(file, ignored) != 4096 || ignored) GTEST_SKIP() << "no such file here";
  const std::string message = message_of(read_model(file));
  EXPECT_NE(message.find("expected 4096 bytes, found "), std::string::npos) << message;
}

TEST(ModelFile, SectionsOfOddLengthAreRefused) {
  const std::string message = message_of(rewritten(
      [](SectionWriter& file, const std::string& id, std::uint32_t owner, std::vector<std::byte>& content) {
        if (id == "CLUS") content.pop_back();
        file.add(id, owner, content);
      }));
  EXPECT_NE(message.find("'CLUS' of system 0"), std::string::npos) << message;
  EXPECT_NE(message.find("expected a multiple of 72 bytes, found 71"), std::string::npos) << message;
}

TEST(ModelFile, WellFormedFilesThatBreakAPromiseAreAFailedCheck) {
  const auto read = rewritten(
      [](SectionWriter& file, const std::string& id, std::uint32_t owner, std::vector<std::byte>& content) {
        if (id == "CLUS") patch(content, 12, std::nanf(""));
        file.add(id, owner, content);
      });
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::check_failed);
  EXPECT_EQ(read.error().message,
            "rewritten: model: system 0, cluster 0: expected an area above 0, found nan");
}

TEST(ModelFile, WhateverPassesTheChecksIsSafeToUse) {
  // Numbers of random sections replaced by extremes, under right checksums: refused, or a model that can be
  // solved.
  std::mt19937_64 random(17);
  const std::array<std::uint32_t, 8> extremes{0u,          1u,          2u,          0x7fffffffu,
                                              0xffffffffu, 0x7f800000u, 0x3f800000u, 0x80000000u};
  int accepted = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    std::uint64_t target = random() % 40;
    const auto read = rewritten([&](SectionWriter& file, const std::string& id, std::uint32_t owner,
                                    std::vector<std::byte>& content) {
      if (target-- == 0 && content.size() >= 4) {
        patch(content, random() % (content.size() / 4) * 4, extremes[random() % extremes.size()]);
      }
      file.add(id, owner, content);
    });
    if (!read) continue;
    ++accepted;
    const ReferenceMatrices matrices = reference_matrices(*read);
    const auto solution = solve_reference(matrices.bounce, stored_lighting(*read), {3, 0.0});
    ASSERT_TRUE(solution) << solution.error().message;
    for (const Rgb& b : solution->radiosity) ASSERT_TRUE(std::isfinite(b.x + b.y + b.z));
  }
  EXPECT_GT(accepted, 50) << "some replacements are harmless";
  EXPECT_LT(accepted, 4750) << "most are not, and sections are met";
}

TEST(ModelFile, ReadsWhatWasWritten) {
  const std::filesystem::path file =
      std::filesystem::path(testing::TempDir()) / "relume_model_file_test.relume";
  ASSERT_TRUE(write_model(test::tiny_model(), file));
  const auto read = read_model(file);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(encode_model(*read), encode_model(test::tiny_model()));
  std::filesystem::remove(file);
  const auto gone = read_model(file);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::bad_input);
  EXPECT_NE(gone.error().message.find("relume_model_file_test.relume"), std::string::npos);
  EXPECT_FALSE(read_model(testing::TempDir())) << "a folder is not a file";
}

}  // namespace
}  // namespace relume
