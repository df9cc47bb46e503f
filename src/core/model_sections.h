// SPDX-License-Identifier: MIT
//
// Which section of a .relume file holds what (src/FILE_FORMAT.md).
#pragma once

#include <cstdint>
#include <string_view>

namespace relume::sections {

inline constexpr std::string_view kInfo = "INFO";
inline constexpr std::string_view kSkyCells = "SKYC";
inline constexpr std::string_view kSkyTree = "SKYT";
inline constexpr std::string_view kSkyTreeShares = "SKYW";
inline constexpr std::string_view kTopTree = "TOPN";
inline constexpr std::string_view kTopParts = "TOPP";
inline constexpr std::string_view kMaterials = "MATL";
inline constexpr std::string_view kNodes = "NODE";
inline constexpr std::string_view kSensorNames = "SNAM";
inline constexpr std::string_view kProbeNames = "PNAM";
inline constexpr std::string_view kProbeVolume = "PVOL";
inline constexpr std::string_view kProbeVolumeNodes = "PVND";
inline constexpr std::string_view kProbeVolumeCells = "PVCL";
inline constexpr std::string_view kProbeVolumePlanes = "PVPL";
inline constexpr std::string_view kLights = "LITE";
inline constexpr std::string_view kOccluderPositions = "OPOS";
inline constexpr std::string_view kOccluderTriangles = "OTRI";
inline constexpr std::string_view kOccluderMaterials = "OMAT";
inline constexpr std::string_view kOccluderNodes = "ONOD";
inline constexpr std::string_view kOccluderSystems = "OSYS";
inline constexpr std::string_view kOccluderFrontUv = "OFUV";
inline constexpr std::string_view kOccluderBackUv = "OBUV";
inline constexpr std::string_view kOpacityMaps = "OAMP";
inline constexpr std::string_view kOpacityTexels = "OATX";
inline constexpr std::string_view kOpacityTriangles = "OATR";
inline constexpr std::string_view kTextureTriangles = "OTEX";
inline constexpr std::string_view kBvhNodes = "OBVN";
inline constexpr std::string_view kBvhTriangles = "OBVT";

inline constexpr std::string_view kSystem = "SYST";
inline constexpr std::string_view kClusters = "CLUS";
inline constexpr std::string_view kElements = "ELEM";
inline constexpr std::string_view kPieces = "PIEC";
inline constexpr std::string_view kLumels = "LUML";
inline constexpr std::string_view kSensors = "SENS";
inline constexpr std::string_view kOwnPatches = "OWNP";
inline constexpr std::string_view kLiftedSensors = "SLFT";
inline constexpr std::string_view kProbes = "PROB";
inline constexpr std::string_view kProbeSenders = "PSND";
inline constexpr std::string_view kCharts = "CHRT";
inline constexpr std::string_view kTree = "TREE";
inline constexpr std::string_view kTreeShares = "TREW";
inline constexpr std::string_view kImports = "IMPT";
inline constexpr std::string_view kClusterRays = "CRAY";
inline constexpr std::string_view kCutErrors = "LCUT";
inline constexpr std::string_view kBounceHalvings = "KHLV";
inline constexpr std::string_view kGatherHalvings = "GHLV";
inline constexpr std::string_view kBounceBlock = "KBLK";
inline constexpr std::string_view kGatherBlock = "GBLK";
inline constexpr std::string_view kGatherDirections = "GDIR";

/// Bits of `flags` in INFO and in the records of MATL.
inline constexpr std::uint32_t kInfoLitByRig = 1u << 0;
inline constexpr std::uint32_t kInfoHasSky = 1u << 1;
inline constexpr std::uint32_t kInfoHasCamera = 1u << 2;
inline constexpr std::uint32_t kMaterialDoubleSided = 1u << 0;
inline constexpr std::uint32_t kMaterialPossibleEmitter = 1u << 1;

/// In front of the four arrays of a block, each padded with zeros to a multiple of 4 bytes.
struct BlockHeader {
  std::uint32_t first_row = 0;
  std::uint32_t row_count = 0;
  std::uint32_t tile_rows = 0;
  std::uint32_t codec = 0;
  std::uint32_t tile_offset_count = 0;
  std::uint32_t column_count = 0;
};
static_assert(sizeof(BlockHeader) == 24);

}  // namespace relume::sections
