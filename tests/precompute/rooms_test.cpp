// SPDX-License-Identifier: MIT
//
// Rooms of matrices made by hand.
#include "precompute/rooms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace relume::test {
namespace {

/// `count` rooms in a row of so many clusters of 1 m2 each, a metre apart; each cluster sees all of its room
/// alike, and through the door to the next room so much.
struct Corridor {
  std::vector<FormFactorRow> rows;
  std::vector<glm::vec3> centroids;
  std::vector<float> areas;

  Corridor(std::uint32_t rooms, std::uint32_t clusters, float through_door) {
    for (std::uint32_t c = 0; c < rooms * clusters; ++c) {
      const std::uint32_t room = c / clusters;
      centroids.push_back({float(c), 0.0f, 0.0f});
      areas.push_back(1.0f);
      FormFactorRow row;
      for (std::uint32_t j = 0; j < rooms * clusters; ++j) {
        const std::uint32_t other = j / clusters;
        const bool next = other + 1 == room || other == room + 1;
        const float share = other == room ? 1.0f - 2.0f * through_door : next ? through_door : 0.0f;
        if (share <= 0.0f) continue;
        row.senders.push_back(j);
        row.values.push_back(share / float(clusters));
      }
      rows.push_back(row);
    }
  }
  std::size_t found() const {
    const auto rooms = find_rooms(rows, centroids, areas);
    return std::set<std::uint32_t>(rooms.begin(), rooms.end()).size();
  }
};

TEST(Rooms, AreWhatDoorsPart) {
  const Corridor corridor(8, 20, 0.01f);
  const auto rooms = find_rooms(corridor.rows, corridor.centroids, corridor.areas);
  for (std::uint32_t c = 0; c < rooms.size(); ++c) EXPECT_EQ(rooms[c], c / 20) << c;
}

TEST(Rooms, ArePartedBySealedWalls) {
  EXPECT_EQ(Corridor(3, 10, 0.0f).found(), 3u);
}

TEST(Rooms, AreOneWhereHalfOfTheLightPasses) {
  EXPECT_EQ(Corridor(2, 30, 0.25f).found(), 1u);
}

/// The rooms found of a hall and others that only it is joined to, of so many clusters of 1 m2 each. What
/// lies in one of the others gives the hall this share of its light; the hall gives as much back as is
/// reciprocal.
std::set<std::uint32_t> rooms_around(std::uint32_t hall, const std::vector<std::uint32_t>& others,
                                     float share) {
  std::vector<std::uint32_t> sizes{hall}, room(hall, 0);
  for (const std::uint32_t size : others) {
    room.insert(room.end(), size, std::uint32_t(sizes.size()));
    sizes.push_back(size);
  }
  const float pair = share / float(hall);
  std::vector<FormFactorRow> rows(room.size());
  for (std::uint32_t c = 0; c < room.size(); ++c) {
    const auto away = float(room[c] == 0 ? room.size() - hall : hall);
    const float own = (1.0f - pair * away) / float(sizes[room[c]]);
    for (std::uint32_t j = 0; j < room.size(); ++j) {
      if (room[c] != room[j] && room[c] != 0 && room[j] != 0) continue;
      rows[c].senders.push_back(j);
      rows[c].values.push_back(room[c] == room[j] ? own : pair);
    }
  }
  std::vector<glm::vec3> centroids;
  for (std::uint32_t c = 0; c < room.size(); ++c) centroids.push_back({float(c), 0.0f, 0.0f});
  const auto found = find_rooms(rows, centroids, std::vector<float>(room.size(), 1.0f));
  return {found.begin(), found.end()};
}

TEST(Rooms, ADoorPartsTwoOfOneSize) {
  // x = (1 - 2 e)^40 is 0.19 at 2 % and 0.015 at 5 %: they are alike by 0.68, and by 0.97.
  EXPECT_EQ(Corridor(2, 60, 0.02f).found(), 2u);
  EXPECT_EQ(Corridor(2, 60, 0.05f).found(), 1u);
}

TEST(Rooms, AClosetIsOneBesideAHall) {
  // It gives the hall 3 % of its light: x = (1 - 0.03 / 0.9)^40 = 0.26, alike by 0.74 / sqrt(3.3 * 1.03).
  EXPECT_EQ(rooms_around(90, {10}, 0.03f).size(), 2u);
}

TEST(Rooms, NooksArePartOfTheRoomAroundThem) {
  EXPECT_EQ(rooms_around(100, {1, 1, 1, 1, 1, 1, 1, 1, 1, 1}, 0.03f).size(), 1u);
}

TEST(Rooms, ACavityAroundARoomIsAnother) {
  // Clusters of both lie among each other all along, as the two sides of a wall: only light tells them apart.
  Corridor both(2, 40, 0.01f);
  for (std::uint32_t c = 0; c < 80; ++c) both.centroids[c] = {float(c % 40), 0.0f, 0.0f};
  const auto rooms = find_rooms(both.rows, both.centroids, both.areas);
  for (std::uint32_t c = 0; c < 80; ++c) EXPECT_EQ(rooms[c], c / 40) << c;
}

/// Two rooms, and behind the first of them pockets of two clusters that see next to nothing but each other.
/// Returns how many of these are found in the second room.
std::size_t pockets_astray(std::uint32_t pockets, float first_place) {
  Corridor corridor(2, 60, 0.01f);
  for (std::uint32_t p = 0; p < 2 * pockets; ++p) {
    const std::uint32_t own = 120 + p;
    corridor.rows.push_back({});
    corridor.rows.back().senders = {0u, own ^ 1u};
    corridor.rows.back().values = {0.005f, 0.995f};
    corridor.centroids.push_back({first_place + float(p), 1.0f, 0.0f});
    corridor.areas.push_back(1e-4f);
  }
  const auto rooms = find_rooms(corridor.rows, corridor.centroids, corridor.areas);
  return std::size_t(std::count(rooms.begin() + 120, rooms.end(), rooms[60]));
}

// What shares with few is like any room now and then, by chance: one of 2000 pockets in these places.
TEST(Rooms, APocketIsPartOfTheRoomThatLightsIt) {
  EXPECT_EQ(pockets_astray(2000, 31000.0f), 0u);
}

TEST(Rooms, AHallIsOneRoom) {
  EXPECT_EQ(Corridor(1, 200, 0.0f).found(), 1u);
}

}  // namespace
}  // namespace relume::test
