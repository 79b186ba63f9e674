#include "common/core_view.h"

namespace chamfer {

bool CoreView::inCell(CoreFeature& feature, const Vector3& p) const {
  switch (feature.kind()) {
  case CoreFeature::Face:
    return inFaceCell(feature, p);
  case CoreFeature::Edge:
    return inEdgeCell(feature, p);
  default:
    return inVertexCell(feature, p);
  }
}

bool CoreView::inFaceCell(CoreFeature& feature, const Vector3& p) const {
  const std::uint32_t f = halfEdge(feature.halfEdge()).facet;
  const std::uint32_t first = facets_[f].firstHalfEdge();
  const Vector3 n = normal(f);
  double deepest = 0;
  std::uint32_t border = kNone;
  const auto consider = [&](std::uint32_t h, const Vector3& a, const Vector3& b) {
    if (const double depth = squaredBeyond(a, b, n, p); depth > deepest) {
      deepest = depth;
      border = h;
    }
  };
  // Each half-edge ends where the next one starts, the last where the first one does.
  const Vector3 begin = start(first);
  Vector3 a = begin;
  std::uint32_t h = first;
  for (; h + 1 < record_.halfEdgeCount; ++h) {
    const HalfEdge next = halfEdge(h + 1);
    if (next.facet != f) break;
    const Vector3 b = centre(next.sphere);
    consider(h, a, b);
    a = b;
  }
  consider(h, a, begin);
  if (border == kNone) return true;
  feature = {CoreFeature::Edge, border};
  return false;
}

bool CoreView::inEdgeCell(CoreFeature& feature, const Vector3& p) const {
  const HalfEdge h = halfEdge(feature.halfEdge()), twin = halfEdge(h.twin);
  const Vector3 a = centre(h.sphere), axis = centre(twin.sphere) - a, q = p - a;
  return inEdgeCell(feature, h, dot(q, axis), lengthSquared(axis), dot(q, cross(axis, normal(h.facet))),
                    dot(q, cross(axis, normal(twin.facet))));
}

bool CoreView::inVertexCell(CoreFeature& feature, const Vector3& p) const {
  const Vector3 q = p - start(feature.halfEdge());
  double deepest = 0;
  std::uint32_t border = kNone;
  std::uint32_t h = feature.halfEdge();
  do {
    const Vector3 axis = end(h) - start(h);
    const double along = dot(q, axis);
    if (along > 0) {
      const double depth = along * along / lengthSquared(axis);
      if (depth > deepest) {
        deepest = depth;
        border = h;
      }
    }
    h = nextOutgoing(h);
  } while (h != feature.halfEdge());
  if (border == kNone) return true;
  feature = {CoreFeature::Edge, border};
  return false;
}

} // namespace chamfer
