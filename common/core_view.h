// One solid's core E, read from a RoundingView: the half-edges, their neighbours, and the Voronoi cell of
// each feature. Internal to common/; the interface for others is ray_query.h.
#pragma once

#include "common/rounding.h"

#include <cstdint>

namespace chamfer {

/// A face, an edge or a vertex of E, named by one of its half-edges (local to the solid): the face on its
/// side, itself, its start. One word, so that copying never waits for parts just written.
class CoreFeature {
public:
  enum Kind : std::uint32_t { Face, Edge, Vertex };
  CoreFeature() = default;
  CoreFeature(Kind kind, std::uint32_t halfEdge) : bits_(kind << 30 | halfEdge) {}
  Kind kind() const { return Kind(bits_ >> 30); }
  std::uint32_t halfEdge() const { return bits_ & 0x3fffffffu; }

private:
  std::uint32_t bits_ = 0;
};

class CoreView {
public:
  CoreView(const RoundingView& view, std::uint32_t solid)
      : record_(view.solids[solid]), facets_(view.facets.data() + record_.firstFacet),
        spheres_(view.spheres.data() + record_.firstSphere), quantum_(sphereQuantum(record_)),
        packed_(record_.wide() ? nullptr : view.packed.data() + record_.halfEdgeStart()),
        wide_(record_.wide() ? view.wide.data() + record_.halfEdgeStart() : nullptr) {}

  double radius() const { return record_.radius; }
  double boundRadius() const { return record_.boundRadius; }
  std::uint32_t halfEdgeCount() const { return record_.halfEdgeCount; }

  HalfEdge halfEdge(std::uint32_t h) const { return wide_ ? wide_[h].unpack() : packed_[h].unpack(); }
  const FacetRecord& facet(std::uint32_t local) const { return facets_[local]; }
  Vector3 normal(std::uint32_t facetLocal) const { return Vector3(facets_[facetLocal].normal); }
  Vector3 centre(std::uint32_t sphere) const { return decodeSphere(spheres_[sphere], quantum_); }
  Vector3 start(std::uint32_t h) const { return centre(halfEdge(h).sphere); }
  Vector3 end(std::uint32_t h) const { return centre(halfEdge(halfEdge(h).twin).sphere); }

  /// Next half-edge around the same face.
  std::uint32_t next(std::uint32_t h) const {
    const std::uint32_t f = halfEdge(h).facet;
    if (h + 1 < record_.halfEdgeCount && halfEdge(h + 1).facet == f) return h + 1;
    return facets_[f].firstHalfEdge();
  }
  /// Next half-edge with the same start.
  std::uint32_t nextOutgoing(std::uint32_t h) const { return next(halfEdge(h).twin); }

  /// Is `p` in the Voronoi cell of `feature`? If not, the neighbour across the border that `p` is farthest
  /// beyond. The borders of all three kinds are the same planes, computed from the same numbers. \return
  /// true: inside; false: `feature` is replaced by the neighbour.
  bool inCell(CoreFeature& feature, const Vector3& p) const;

  /// The same for an edge, whose half-edge `feature` names and `h` is: the point is `along` (times the edge's
  /// length) beyond its start, `squared` is the edge's squared length; `outFace`, `outTwin`: the point's
  /// offset from the axis, times the cross product of the axis and the normal of the facet on `h`'s side and
  /// on the twin's.
  bool inEdgeCell(CoreFeature& feature, const HalfEdge& h, double along, double squared, double outFace,
                  double outTwin) const {
    // Four borders, each as (how far beyond it) * length.
    double deepest = 0;
    CoreFeature next = feature;
    const auto consider = [&](double beyond, CoreFeature::Kind kind, std::uint32_t halfEdgeIndex) {
      if (beyond > deepest) {
        deepest = beyond;
        next = {kind, halfEdgeIndex};
      }
    };
    consider(-along, CoreFeature::Vertex, feature.halfEdge());
    consider(along - squared, CoreFeature::Vertex, h.twin);
    consider(-outFace, CoreFeature::Face, feature.halfEdge());
    consider(outTwin, CoreFeature::Face, h.twin);
    feature = next;
    return !(deepest > 0);
  }

  /// Squared distance by which `p` is beyond the border between the face of `h`, of normal `n`, and the edge
  /// `h`; 0 on the face's side. Nothing is normalised for the common answer 0.
  double squaredBeyond(std::uint32_t h, const Vector3& n, const Vector3& p) const {
    return squaredBeyond(start(h), end(h), n, p);
  }

private:
  /// `a`, `b`: the half-edge's start and end.
  static double squaredBeyond(const Vector3& a, const Vector3& b, const Vector3& n, const Vector3& p) {
    const Vector3 axis = b - a;
    const double beyond = dot(p - a, cross(axis, n));
    return beyond <= 0 ? 0 : beyond * beyond / lengthSquared(axis);
  }
  bool inFaceCell(CoreFeature& feature, const Vector3& p) const;
  bool inEdgeCell(CoreFeature& feature, const Vector3& p) const;
  bool inVertexCell(CoreFeature& feature, const Vector3& p) const;

  const SolidRecord& record_;
  const FacetRecord* facets_;
  const SphereRecord* spheres_;
  double quantum_;
  const PackedHalfEdge* packed_;
  const WideHalfEdge* wide_;
};

} // namespace chamfer
