// The rounding of a mesh: for every solid its core E as a half-edge structure over sphere centres, the planes
// of its facets, and kd-trees of detection cylinders for facets with many edges. This is what the sidecar
// file holds and what the renderer reads; it is never changed once made.
//
// Method: Courtin et al., "Efficient Rendering of Rounded Corners and Edges for Convex Objects", CGI 2019.
// The rounded solid is R = E (+) ball(r) with E = {x : n_f.x <= d_f - r}. A vertex of E is the centre of a
// rounding sphere, an edge of E the axis of a rounding cylinder, a face of E moved out by r a flat.
//
// Frames: everything of a solid is relative to that solid's own origin (SolidRecord::origin, in mesh
// coordinates), so that float32 loses nothing for a solid far from the mesh's origin. Lengths are mesh units.
#pragma once

#include "common/vec.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace chamfer {

/// No index: the facet or solid of a triangle that stays sharp, among others.
inline constexpr std::uint32_t kNone = 0xffffffffu;

/// One rounded solid.
struct SolidRecord {
  double origin[3];          ///< mesh coordinates of the solid's frame
  float radius;              ///< rounding radius r
  float boundRadius;         ///< ball about the origin that holds the whole solid P
  std::uint32_t firstFacet;  ///< into facets; the solid's facets end where the next solid's begin
  std::uint32_t firstSphere; ///< into spheres
  std::uint32_t
      firstHalfEdge; ///< into wide when kWide is set, else into packed; see wide() and halfEdgeStart()
  std::uint32_t halfEdgeCount; ///< twice the number of rounded edges
  static constexpr std::uint32_t kWide = 0x80000000u;
  bool wide() const { return (firstHalfEdge & kWide) != 0; }
  std::uint32_t halfEdgeStart() const { return firstHalfEdge & ~kWide; }
};
static_assert(sizeof(SolidRecord) == 48);

/// Plane of a facet of P: n.x = d in the solid's frame, n unit and outward.
struct FacetRecord {
  Float3 normal;
  float offset;
  /// Local half-edge. With a flat: the first half-edge of the loop around E's face; the loop goes on with the
  /// following half-edges as long as they name this facet, counter-clockwise seen from outside.
  /// Without a flat (kVanished set): a half-edge whose start is the vertex of E that lies highest over the
  /// facet: a start for the walk to the nearest feature.
  std::uint32_t first;
  std::uint32_t solid; ///< index of its solid in the mesh
  static constexpr std::uint32_t kVanished = 0x80000000u;
  static constexpr std::uint32_t kHasTree = 0x40000000u; ///< treeRoots has an entry for this facet
  bool vanished() const { return (first & kVanished) != 0; }
  bool hasTree() const { return (first & kHasTree) != 0; }
  std::uint32_t firstHalfEdge() const { return first & ~(kVanished | kHasTree); }
};
static_assert(sizeof(FacetRecord) == 24);

/// Centre of a rounding sphere, a vertex of E: float32 and, for each coordinate, what float32 leaves off in
/// units of the solid's quantum. A split corner's centres lie within a fraction of r of each other, and r may
/// be a hundred-thousandth of the solid: float32 alone would not keep the directions between them.
struct SphereRecord {
  Float3 near;
  std::int16_t rest[3];
  std::int16_t unused = 0;
  bool operator==(const SphereRecord&) const = default;
};
static_assert(sizeof(SphereRecord) == 20);

/// Unit of SphereRecord::rest: half of the last place of a float32 as large as the solid, in 2^15 parts.
inline double sphereQuantum(const SolidRecord& solid) { return double(solid.boundRadius) * 0x1p-39; }
inline Vector3 decodeSphere(const SphereRecord& s, double quantum) {
  return {double(s.near.x) + double(s.rest[0]) * quantum, double(s.near.y) + double(s.rest[1]) * quantum,
          double(s.near.z) + double(s.rest[2]) * quantum};
}
/// Rounds to whole quanta.
SphereRecord encodeSphere(const Vector3& centre, double quantum);

/// One side of an edge of E; all indices are local to the solid. It runs along the boundary of its facet's
/// face from `sphere` to the twin's `sphere`.
struct HalfEdge {
  std::uint32_t sphere; ///< its start
  std::uint32_t twin;   ///< the same edge's other side
  std::uint32_t facet;  ///< the facet on this side
};

/// Storage of half-edges of solids with fewer than 65,536 of them.
struct PackedHalfEdge {
  std::uint16_t sphere, twin, facet;
  HalfEdge unpack() const { return {sphere, twin, facet}; }
};

/// Storage of half-edges of larger solids, 24 bits each, little-endian.
struct WideHalfEdge {
  std::uint8_t bytes[9];
  static constexpr std::uint32_t kLimit = 1u << 24; ///< all three numbers stay below it
  HalfEdge unpack() const { return {number(0), number(3), number(6)}; }

private:
  std::uint32_t number(int at) const {
    return bytes[at] | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16;
  }
};
static_assert(sizeof(PackedHalfEdge) == 6 && sizeof(WideHalfEdge) == 9);
PackedHalfEdge packHalfEdge(const HalfEdge& e);
WideHalfEdge packWideHalfEdge(const HalfEdge& e);

/// kd-tree node over a facet's detection cylinders; 8 bytes. An inner node splits the facet's points along
/// `axis` (0..2) at `split`; its children are the nodes `first` and `first + 1`. A leaf names a stretch of
/// the facet's loop, `count` half-edges from the solid's half-edge `first`, that holds every cylinder that
/// can be the deepest at some point of the leaf: in a convex outline those are neighbours.
struct TreeNode {
  union {
    float split;
    std::uint32_t count;
  };
  std::uint32_t bits; ///< low 2 bits: axis, or 3 for a leaf; the rest: first
  bool leaf() const { return (bits & 3u) == 3u; }
  std::uint32_t axis() const { return bits & 3u; }
  std::uint32_t first() const { return bits >> 2; }
};
static_assert(sizeof(TreeNode) == 8);

/// Root of the tree of one facet. A facet with few cylinders has none: its loop is its only leaf.
struct TreeRoot {
  std::uint32_t facet; ///< index in facets; roots are in ascending order of it
  std::uint32_t node;  ///< into treeNodes
};

/// Non-owning view of everything; spans point into a Rounding's storage or into a mapped file.
struct RoundingView {
  std::span<const SolidRecord> solids; ///< one more than there are solids: the last only ends the ranges
  std::span<const FacetRecord> facets;
  std::span<const SphereRecord> spheres;
  std::span<const PackedHalfEdge> packed; ///< half-edges of the small solids
  std::span<const WideHalfEdge> wide;     ///< half-edges of the others
  std::span<const TreeRoot> treeRoots;
  std::span<const TreeNode> treeNodes;
  std::span<const std::uint32_t> facetOfTriangle; ///< by the mesh's triangle index; kNone: stays sharp

  std::size_t solidCount() const { return solids.empty() ? 0 : solids.size() - 1; }
};

} // namespace chamfer
