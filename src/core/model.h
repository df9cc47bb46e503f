// SPDX-License-Identifier: MIT
//
// The model: everything that a precompute leaves behind, and all that a solve needs. It is what a .relume
// file holds (src/FILE_FORMAT.md) and is immutable once built. Structs marked "stored" are written to the
// file as they are in memory.
//
// Positions are metres relative to Model::origin (world = origin + position).
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/block_matrix.h"
#include "core/light.h"
#include "core/occluder_bvh.h"
#include "core/opacity.h"
#include "core/probe_volume.h"
#include "core/quantities.h"

namespace relume {

inline constexpr std::uint32_t kNone = 0xffffffffu;

enum class Side : std::uint32_t { front = 0, back = 1 };  ///< front: triangle corners run counter-clockwise

/// A leaf of the cluster tree: a patch of surface, nearly flat or small, of one material, one node and one
/// side. Stored.
struct Cluster {
  glm::vec3 centroid{0.0f};
  float area = 0.0f;       ///< m2, of the solid part (core/opacity.h): so A_i F_ij = A_j F_ji
  glm::vec3 normal{0.0f};  ///< unit, area-weighted mean
  std::uint32_t material = 0;
  std::array<float, 3>
      albedo{};  ///< of the scene that was precomputed, textures averaged, clamped to Model::max_albedo
  std::array<float, 3> exitance{};  ///< lm/m2, of the scene that was precomputed
  std::uint32_t node = 0;
  Side side = Side::front;
  std::uint32_t first_element = 0;  ///< its elements are [first_element, first_element + element_count)
  std::uint32_t element_count = 0;
};
static_assert(sizeof(Cluster) == 72);

/// The part of one lumel that lies on one side of all walls: the smallest piece of surface that is told
/// apart. A lumel that a wall splits has several elements, of which the largest is its own. Stored.
struct SurfaceElement {
  glm::vec3 position{0.0f};  ///< a point on the surface, near the middle
  float area = 0.0f;         ///< m2, sum over its pieces
  glm::vec3 normal{0.0f};    ///< unit, geometric, towards the side that receives
  std::uint32_t cluster = 0;
  std::uint32_t first_piece = 0;
  std::uint32_t piece_count = 0;
};
static_assert(sizeof(SurfaceElement) == 40);

/// A triangle cut out of an occluder triangle: the geometry of an element, exactly. Corners are barycentric:
/// point = (1 - u - v) p0 + u p1 + v p2. Stored.
struct SurfacePiece {
  std::uint32_t triangle = 0;  ///< index into Model::occluders.triangles
  std::array<glm::vec2, 3> corners{};
};
static_assert(sizeof(SurfacePiece) == 28);

enum LumelFlags : std::uint32_t {
  kLumelInvalid =
      1u << 0,  ///< most of its rays met back faces: its value is not to be shown, neighbours fill it
  kLumelSplit = 1u << 1,  ///< a wall runs through it; the larger part was kept
};

/// One texel of the system's lightmap that carries a value; lumel i is row i of the system's gather matrix.
/// Stored.
struct Lumel {
  std::uint16_t x = 0;
  std::uint16_t y = 0;
  std::uint32_t element = 0;
  std::uint32_t flags = 0;
};
static_assert(sizeof(Lumel) == 12);

/// A point and normal that the user named. Stored.
struct Sensor {
  glm::dvec3 position{0.0};  ///< world space, as given (before it is lifted)
  glm::vec3 normal{0.0f};
  std::uint32_t name = 0;  ///< index into Model::sensor_names
};
static_assert(sizeof(Sensor) == 40);

enum ProbeFlags : std::uint32_t {
  kProbeInvalid = 1u << 0,  ///< many of its rays met back faces: it lies inside or behind geometry
};

/// A point whose incident light is known from all sides (core/probe_coefficients.h). Stored.
struct Probe {
  glm::dvec3 position{0.0};  ///< world space
  std::uint32_t name = 0;    ///< index into Model::probe_names
  std::uint32_t flags = 0;
  std::uint32_t first_sender =
      0;  ///< its list is [first_sender, first_sender + sender_count) of System::probe_senders
  std::uint32_t sender_count = 0;
};
static_assert(sizeof(Probe) == 40);

/// What a probe sees of a sender, or of a part of one that reaches far around it. Stored.
struct ProbeSender {
  std::uint32_t column = 0;  ///< index into System::imports
  float solid_angle = 0.0f;  ///< sr, above 0; those of a probe add up to 4 pi at most
  glm::vec3 direction{
      0.0f};  ///< the mean of the directions towards it: shorter than 1 by how far they spread
};
static_assert(sizeof(ProbeSender) == 20);

/// Where one node's surface lies in the lightmap of a system: texel = uv * scale + offset, in lumels. Stored.
struct LightmapChart {
  std::uint32_t node = 0;
  Side side = Side::front;
  std::uint32_t uv_set =
      kNone;  ///< 1: the scene's TEXCOORD_1; kNone: made by Relume, (0,0)-(1,1) is the whole lightmap
  glm::vec2 scale{1.0f};
  glm::vec2 offset{0.0f};
};
static_assert(sizeof(LightmapChart) == 28);

/// `system` of a SenderRef that names a sky patch.
inline constexpr std::uint32_t kSkySystem = kNone;

/// An inner node of a cluster tree: the leaves [first, first + count), which are clusters of one system, or
/// sky patches. Its radiosity is their mean by the shares [first_share, first_share + count) of the tree,
/// which add up to 1. Leaves are numbered so that every node is such a range. Stored.
struct TreeNode {
  std::uint32_t first = 0;
  std::uint32_t count = 0;        ///< at least 2
  std::uint32_t first_share = 0;  ///< the sum of the counts of all nodes before
  friend bool operator==(const TreeNode&, const TreeNode&) = default;
};
static_assert(sizeof(TreeNode) == 12);

/// Nodes over the clusters of a system, or over sky patches.
struct ClusterTreeNodes {
  std::vector<TreeNode> nodes;
  std::vector<float> shares;  ///< of each leaf of each node, in the order of the nodes
};

/// `system` of a SenderRef that names a node above the systems.
inline constexpr std::uint32_t kSpanningNodes = 0xfffffffeu;

/// A sender: cluster `index` of system `system`, or sky patch `index`. With n the number of clusters (of sky
/// patches), an index of n or more is the node tree[index - n] of that system (sky_tree[index - n] of the
/// model). With kSpanningNodes, it is the node top_tree[index] of the model. Stored.
struct SenderRef {
  std::uint32_t system = 0;
  std::uint32_t index = 0;
  friend bool operator==(const SenderRef&, const SenderRef&) = default;
};
static_assert(sizeof(SenderRef) == 8);

/// A node above the systems: the parts [first_part, first_part + part_count) of Model::top_parts, each in
/// another system. Its radiosity is the mean of theirs by their shares. Stored.
struct SpanningNode {
  std::uint32_t first_part = 0;
  std::uint32_t part_count = 0;  ///< at least 2
  friend bool operator==(const SpanningNode&, const SpanningNode&) = default;
};
static_assert(sizeof(SpanningNode) == 8);

/// What a node above the systems spans in one of them. Stored.
struct SpannedPart {
  SenderRef sender;    ///< a cluster or a tree node of a system
  float share = 0.0f;  ///< those of a node add up to 1
  friend bool operator==(const SpannedPart&, const SpannedPart&) = default;
};
static_assert(sizeof(SpannedPart) == 12);

/// Variance of the irradiance of a row, in that of as many independent rays: below 1 where rays avoid each
/// other, or senders are also sampled over their area. 1 where nobody measured it.
struct VarianceShares {
  float surfaces = 1.0f;  ///< of light from the sky and from surfaces that are no possible emitters
  float emitters = 1.0f;
  friend bool operator==(const VarianceShares&, const VarianceShares&) = default;
};

/// How the rows of a cluster and its lumels came to be. Stored.
struct ClusterRays {
  std::uint32_t count = 0;  ///< of each lumel
  float noise = 0.0f;       ///< estimate: of a lumel's irradiance, relative to its room's root mean square,
                            ///< whatever the lights; 0 where nobody asked
  VarianceShares variance{};
  friend bool operator==(const ClusterRays&, const ClusterRays&) = default;
};
static_assert(sizeof(ClusterRays) == 16);

/// A group of geometry that is precomputed, stored, loaded and updated as one.
struct System {
  std::string name;
  bool loaded = true;                ///< false: all but the name is empty (read_systems)
  std::uint32_t lightmap_width = 0;  ///< lumels
  std::uint32_t lightmap_height = 0;
  std::vector<Cluster> clusters;         ///< rows of `bounce`
  std::vector<SurfaceElement> elements;  ///< grouped by cluster
  std::vector<SurfacePiece> pieces;      ///< grouped by element
  /// A bit for each light patch (core/light_patches.h), element by element, lowest first: whether it belongs
  /// to its element; empty: all do.
  std::vector<std::uint32_t> own_patches;
  std::vector<Lumel> lumels;              ///< rows [0, lumels) of `gather`
  std::vector<Sensor> sensors;            ///< rows [lumels, lumels + sensors) of `gather`
  std::vector<glm::vec3> lifted_sensors;  ///< per sensor: where it measures, off the surface that it lies on
  std::vector<Probe> probes;              ///< those that see more of this system than of others
  std::vector<ProbeSender>
      probe_senders;  ///< grouped by probe, in their order; columns ascend inside a probe
  std::vector<LightmapChart> charts;
  ClusterTreeNodes
      tree;  ///< over `clusters`: the nodes that some system imports, or a node above the systems spans
  std::vector<SenderRef> imports;  ///< what the columns of both matrices, and of probes, mean
  std::vector<ClusterRays> rays;   ///< per cluster; empty: not told
  /// Per lumel: estimate of what the nodes that its row keeps hide, relative to its room's root mean square
  /// irradiance; empty: rows are full, or it is not told.
  std::vector<float> cut_errors;
  /// How rows share out what they see of nodes (core/halvings.h); empty: not told.
  std::vector<std::uint8_t> bounce_halvings, gather_halvings;
  BlockMatrix bounce;  ///< K: clusters x imports
  BlockMatrix gather;  ///< G: (lumels, sensors) x imports
};

/// Material of the scene as far as a solve needs it.
struct MaterialRecord {
  std::string name;  ///< unique
  bool double_sided = false;
  bool possible_emitter = false;  ///< its clusters were sampled as emitters
};

/// A node of the scene that carries surfaces.
struct NodeRecord {
  std::string path;                 ///< unique: "a/b#2"
  std::uint64_t geometry_hash = 0;  ///< of what the precompute depends on
};

/// Where a triangle lies in the images of its material: texture coordinates of its corners (1 = the whole
/// image), after any transform; of its emission texture, or else its base colour texture, or else TEXCOORD_0.
/// Stored.
struct TextureTriangle {
  std::uint32_t triangle = 0;  ///< index into the triangles of the scene
  std::array<glm::vec2, 3> corners{};
  friend bool operator==(const TextureTriangle&, const TextureTriangle&) = default;
};
static_assert(sizeof(TextureTriangle) == 28);

/// The triangles that block light: all of the static scene, for shadows at run time, textures and pictures.
struct Occluders {
  std::vector<glm::vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> material;  ///< per triangle
  std::vector<std::uint32_t> node;      ///< per triangle
  std::vector<std::uint32_t>
      system;  ///< per triangle; kNone: has no lightmap and no clusters (it only blocks)
  /// Lightmap coordinates in lumels of corner k of triangle t at [3 t + k], per side. `back_uv` is empty when
  /// nothing is double-sided.
  std::vector<glm::vec2> front_uv;
  std::vector<glm::vec2> back_uv;
  Opacity opacity;  ///< of the triangles that let light through
  /// Ascending by triangle: those that have texture coordinates and a material with a texture, or one that
  /// may emit.
  std::vector<TextureTriangle> texture;
  OccluderBvh bvh;  ///< over those that stop any
};

/// A perspective camera for previews.
struct Camera {
  glm::dvec3 position{0.0};  ///< world space
  glm::dvec3 forward{0.0, 0.0, -1.0};
  glm::dvec3 up{0.0, 1.0, 0.0};
  double vertical_field_of_view = 1.0;  ///< radians
};

/// How the model came to be. Never times or thread counts: the same input gives the same bytes.
struct Provenance {
  std::string scene_file;  ///< file name without its folder
  std::string tool;        ///< "relume 0.1.0"
  std::string ray_tracer;  ///< library, version and instruction set
  std::string options;     ///< JSON object of all that was asked and chosen
};

struct Model {
  glm::dvec3 origin{0.0};
  double max_albedo = 0.95;
  std::uint64_t geometry_hash = 0;
  std::uint32_t sky_resolution = 0;      ///< n of core/sky.h
  std::vector<std::uint32_t> sky_cells;  ///< sky patch p is cell sky_cells[p]; empty when no ray escaped
  ClusterTreeNodes sky_tree;             ///< over `sky_cells`: the nodes that some system imports
  std::vector<System> systems;
  std::vector<SpanningNode> top_tree;  ///< above the systems: the nodes that some system imports
  std::vector<SpannedPart> top_parts;  ///< grouped by node of top_tree; systems ascend inside a node
  std::vector<MaterialRecord> materials;
  std::vector<NodeRecord> nodes;
  std::vector<std::string> sensor_names;
  std::vector<std::string> probe_names;  ///< of all systems, loaded or not
  ProbeVolume probe_volume;              ///< empty where probes are only points
  Occluders occluders;
  std::vector<Light> lights;        ///< of the scene, or of the stated rig
  std::optional<Rgb> sky_radiance;  ///< cd/m2: the stated rig of an open scene that shines with nothing
  bool lit_by_rig = false;          ///< the scene had no light and no emission
  std::optional<Camera> camera;     ///< of the scene
  Provenance provenance;
};

/// Clusters of all systems are numbered through, system by system: index of the first cluster of each system,
/// and the total at the end.
std::vector<std::uint32_t> cluster_offsets(const Model& model);

/// The same for gather rows (lumels, then sensors, of each system).
std::vector<std::uint32_t> gather_offsets(const Model& model);

/// Every promise of the model: index ranges, areas, finite numbers, imports, both matrices of each system.
/// The error names the first broken one.
Result<void> check_model(const Model& model);

}  // namespace relume
