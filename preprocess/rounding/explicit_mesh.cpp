#include "preprocess/rounding/explicit_mesh.h"

#include "common/core_view.h"
#include "common/error.h"

#include <algorithm>

namespace chamfer {
namespace {

/// Great-circle interpolation between unit vectors less than half a turn apart.
Vector3 slerp(const Vector3& a, const Vector3& b, double share) {
  const double angle = std::atan2(length(cross(a, b)), dot(a, b));
  if (!(angle > 1e-12)) return a;
  return normalize(a * std::sin((1 - share) * angle) + b * std::sin(share * angle));
}

class SolidMesher {
public:
  SolidMesher(const RoundingView& view, std::uint32_t solid, unsigned segments,
              std::span<const std::uint32_t> triangleOfFacet, const std::function<bool()>& cancelled,
              ExplicitMesh& out)
      : core_(view, solid), record_(view.solids[solid]), segments_(segments),
        triangleOfFacet_(triangleOfFacet), cancelled_(cancelled), out_(out) {}

  void run() {
    const std::uint32_t n = core_.halfEdgeCount();
    corner_.resize(n);
    arc_.resize(n);
    for (std::uint32_t h = 0; h < n; ++h)
      corner_[h] = vertex(core_.halfEdge(h).sphere, core_.normal(core_.halfEdge(h).facet));
    for (std::uint32_t h = 0; h < n; ++h)
      arc_[h] = arc(h);
    std::vector<bool> done(n, false);
    for (std::uint32_t h = 0; h < n; ++h) {
      const HalfEdge e = core_.halfEdge(h);
      if (h < e.twin) strip(h, e);
      if (cancelled_ && cancelled_())
        throw Error(ErrorKind::Cancelled, "cancelled while an explicit mesh was made");
      if (!done[h]) sphere(h, done);
      if (core_.facet(e.facet).firstHalfEdge() == h) flat(h, e.facet);
    }
  }

private:
  using Arc = std::vector<std::uint32_t>; ///< segments + 1 vertices

  std::uint32_t vertex(std::uint32_t sphere, const Vector3& normal) {
    const Vector3 p = core_.centre(sphere) + normal * core_.radius();
    out_.positions.push_back(Point3(p + Vector3(record_.origin[0], record_.origin[1], record_.origin[2])));
    out_.normals.push_back(normal);
    return std::uint32_t(out_.positions.size() - 1);
  }
  void triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t facet, Feature feature) {
    out_.triangles.push_back({a, b, c});
    out_.meshTriangle.push_back(triangleOfFacet_[facet]);
    out_.features.push_back(feature);
  }
  /// Of `facets` the one that a triangle is turned to most.
  std::uint32_t turnedTo(const std::array<std::uint32_t, 3>& t, std::span<const std::uint32_t> facets) const {
    const Vector3 normal = out_.normals[t[0]] + out_.normals[t[1]] + out_.normals[t[2]];
    return *std::max_element(facets.begin(), facets.end(), [&](std::uint32_t a, std::uint32_t b) {
      return dot(core_.normal(a), normal) < dot(core_.normal(b), normal);
    });
  }
  /// The corner of half-edge h's own facet at the end of h.
  std::uint32_t cornerAtEnd(std::uint32_t h) const { return corner_[core_.next(h)]; }

  /// At the start of h, from the normal of h's facet to the normal of its twin's.
  Arc arc(std::uint32_t h) {
    const HalfEdge e = core_.halfEdge(h), twin = core_.halfEdge(e.twin);
    const Vector3 a = core_.normal(e.facet), b = core_.normal(twin.facet);
    Arc arc{corner_[h]};
    for (unsigned j = 1; j < segments_; ++j)
      arc.push_back(vertex(e.sphere, slerp(a, b, double(j) / segments_)));
    arc.push_back(cornerAtEnd(e.twin));
    return arc;
  }

  void strip(std::uint32_t h, const HalfEdge& e) {
    const Arc& start = arc_[h];
    const Arc& end = arc_[e.twin]; // runs from the twin's facet to h's
    const std::uint32_t twinFacet = core_.halfEdge(e.twin).facet;
    for (unsigned j = 0; j < segments_; ++j) {
      const std::uint32_t a = start[j], b = start[j + 1], c = end[segments_ - j - 1], d = end[segments_ - j];
      const std::uint32_t facet = 2 * j < segments_ ? e.facet : twinFacet;
      triangle(a, b, c, facet, Feature::Cylinder);
      triangle(a, c, d, facet, Feature::Cylinder);
    }
  }

  void flat(std::uint32_t first, std::uint32_t facet) {
    for (std::uint32_t h = core_.next(core_.next(first)), previous = core_.next(first); h != first;
         previous = h, h = core_.next(h))
      triangle(corner_[first], corner_[previous], corner_[h], facet, Feature::Flat);
  }

  /// The spherical polygon at the start of `first`: its sides are the arcs of the half-edges that leave the
  /// vertex.
  void sphere(std::uint32_t first, std::vector<bool>& done) {
    // nextOutgoing turns clockwise seen from outside, and arc_ with it: from the facet of around[i] to the
    // facet of around[i + 1]. Sides are taken backwards to go counter-clockwise.
    std::vector<std::uint32_t> around;
    std::uint32_t h = first;
    do {
      around.push_back(h);
      done[h] = true;
      h = core_.nextOutgoing(h);
    } while (h != first);
    const std::uint32_t centre = core_.halfEdge(first).sphere;
    if (around.size() == 3) {
      // The shortest side is the base: between sides that nearly meet again at its far end, rows stay short.
      const auto cosine = [&](std::size_t side) {
        const HalfEdge e = core_.halfEdge(around[side]);
        return dot(core_.normal(e.facet), core_.normal(core_.halfEdge(e.twin).facet));
      };
      std::size_t base = 0;
      for (std::size_t side = 1; side < 3; ++side)
        if (cosine(side) > cosine(base)) base = side;
      const std::uint32_t before = around[(base + 2) % 3], after = around[(base + 1) % 3];
      const std::array facets{facetOf(around[0]), facetOf(around[1]), facetOf(around[2])};
      grid(centre, reversed(arc_[after]), arc_[before], reversed(arc_[around[base]]), facets);
      return;
    }
    // The middle of the outline, not of the corners: those may crowd at one end of a long outline.
    Vector3 sum{0, 0, 0};
    for (const std::uint32_t g : around) {
      const HalfEdge e = core_.halfEdge(g);
      const Vector3 a = core_.normal(e.facet), b = core_.normal(core_.halfEdge(e.twin).facet);
      sum += slerp(a, b, 0.5) * std::atan2(length(cross(a, b)), dot(a, b));
    }
    const Vector3 middle = normalize(sum);
    const std::uint32_t apex = vertex(centre, middle);
    std::vector<Arc> spokes;
    for (const std::uint32_t g : around) {
      const Vector3 n = core_.normal(core_.halfEdge(g).facet);
      Arc spoke{apex};
      for (unsigned j = 1; j < segments_; ++j)
        spoke.push_back(vertex(centre, slerp(middle, n, double(j) / segments_)));
      spoke.push_back(corner_[g]);
      spokes.push_back(std::move(spoke));
    }
    for (std::size_t i = 0; i < around.size(); ++i) {
      const std::size_t next = (i + 1) % around.size();
      const std::array facets{facetOf(around[i]), facetOf(around[next])};
      grid(centre, spokes[next], spokes[i], reversed(arc_[around[i]]), facets);
    }
  }

  static Arc reversed(Arc arc) {
    std::reverse(arc.begin(), arc.end());
    return arc;
  }

  std::uint32_t facetOf(std::uint32_t halfEdge) const { return core_.halfEdge(halfEdge).facet; }

  /// Fills a spherical triangle. `left` and `right` run from the same apex, `base` from left's end to right's
  /// end. `facets`: those that meet there.
  void grid(std::uint32_t centre, const Arc& left, const Arc& right, const Arc& base,
            std::span<const std::uint32_t> facets) {
    const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
      triangle(a, b, c, turnedTo({a, b, c}, facets), Feature::Sphere);
    };
    Arc above{left[0]};
    for (unsigned i = 1; i <= segments_; ++i) {
      Arc row{left[i]};
      for (unsigned j = 1; j < i; ++j)
        row.push_back(i == segments_ ? base[j]
                                     : vertex(centre, slerp(out_.normals[left[i]], out_.normals[right[i]],
                                                            double(j) / double(i))));
      row.push_back(right[i]);
      for (unsigned j = 0; j < i; ++j) {
        add(above[j], row[j], row[j + 1]);
        if (j + 1 < i) add(above[j], row[j + 1], above[j + 1]);
      }
      above = std::move(row);
    }
  }
  CoreView core_;
  const SolidRecord& record_;
  unsigned segments_;
  std::span<const std::uint32_t> triangleOfFacet_; ///< by the solid's local facet
  const std::function<bool()>& cancelled_;
  ExplicitMesh& out_;
  std::vector<std::uint32_t> corner_; ///< vertex at the start of a half-edge on its facet
  std::vector<Arc> arc_;
};

} // namespace

ExplicitMesh explicitMesh(const RoundingView& view, const TriangleMesh& mesh, unsigned segments,
                          const std::function<bool()>& cancelled) {
  ExplicitMesh out;
  // In one piece each: grown by doubling they would keep, and for a while need, far more than they hold. A
  // closed surface has half as many vertices as triangles, and two.
  const std::size_t triangles = ExplicitMeshSize(view).triangles(std::max(1u, segments));
  out.triangles.reserve(triangles);
  out.meshTriangle.reserve(triangles);
  out.features.reserve(triangles);
  out.positions.reserve(triangles / 2 + 2 * view.solidCount());
  out.normals.reserve(triangles / 2 + 2 * view.solidCount());
  std::vector<std::uint32_t> triangleOfFacet(view.facets.size(), 0);
  for (std::size_t t = view.facetOfTriangle.size(); t-- > 0;)
    if (view.facetOfTriangle[t] != kNone) triangleOfFacet[view.facetOfTriangle[t]] = std::uint32_t(t);
  for (std::uint32_t s = 0; s < view.solidCount(); ++s) {
    const std::uint32_t first = view.solids[s].firstFacet;
    SolidMesher(view, s, std::max(1u, segments),
                std::span(triangleOfFacet).subspan(first, view.solids[s + 1].firstFacet - first), cancelled,
                out)
        .run();
  }
  for (std::size_t t = 0; t < view.facetOfTriangle.size(); ++t) {
    if (view.facetOfTriangle[t] != kNone) continue;
    const auto& v = mesh.triangles[t];
    const Point3 p[3] = {mesh.positions[v[0]], mesh.positions[v[1]], mesh.positions[v[2]]};
    const Vector3 area = cross(p[1] - p[0], p[2] - p[0]);
    const double twice = length(area);
    const auto base = std::uint32_t(out.positions.size());
    for (const Point3& q : p) {
      out.positions.push_back(q);
      out.normals.push_back(twice > 0 ? area / twice : Vector3(0, 0, 1));
    }
    out.triangles.push_back({base, base + 1, base + 2});
    out.meshTriangle.push_back(std::uint32_t(t));
    out.features.push_back(Feature::Flat);
  }
  return out;
}

ExplicitMeshSize::ExplicitMeshSize(const RoundingView& view) {
  std::vector<std::uint32_t> degree;
  for (std::uint32_t s = 0; s < view.solidCount(); ++s) {
    const CoreView core(view, s);
    edges_ += core.halfEdgeCount() / 2;
    degree.assign(view.solids[s + 1].firstSphere - view.solids[s].firstSphere, 0);
    for (std::uint32_t h = 0; h < core.halfEdgeCount(); ++h)
      ++degree[core.halfEdge(h).sphere];
    for (const std::uint32_t d : degree)
      grids_ += d == 3 ? 1 : d;
    for (std::uint32_t f = view.solids[s].firstFacet; f < view.solids[s + 1].firstFacet; ++f)
      if (!view.facets[f].vanished()) fixed_ -= 2; // a polygon of n sides takes n - 2 triangles
    fixed_ += core.halfEdgeCount();
  }
  fixed_ += std::uint64_t(std::count(view.facetOfTriangle.begin(), view.facetOfTriangle.end(), kNone));
}

ExplicitMeshSize& ExplicitMeshSize::operator+=(const ExplicitMeshSize& o) {
  grids_ += o.grids_;
  edges_ += o.edges_;
  fixed_ += o.fixed_;
  return *this;
}

} // namespace chamfer
