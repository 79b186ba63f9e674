#include "preprocess/components/component_builder.h"

#include "common/text.h"

#include <algorithm>

namespace chamfer {
namespace {

/// The renderer holds lengths relative to the solid in float32 and squares them.
constexpr double kLeastDiagonal = 1e-15, kMostDiagonal = 1e15;

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

} // namespace

/// Replaces the mesh vertices of triangles_ by local numbers in order of appearance.
void ComponentBuilder::numberVertices(std::span<std::uint32_t> localOf) {
  meshVertex_.clear();
  for (Triangle& t : triangles_)
    for (std::uint32_t& v : t) {
      std::uint32_t& local = localOf[v];
      if (local == kNone) {
        local = std::uint32_t(meshVertex_.size());
        meshVertex_.push_back(v);
      }
      v = local;
    }
}

void ComponentBuilder::fillPositions(Component& component) const {
  component.positions.resize(meshVertex_.size());
  for (std::size_t i = 0; i < meshVertex_.size(); ++i) {
    component.positions[i] = mesh_.positions[meshVertex_[i]];
    component.bounds.extend(component.positions[i]);
  }
}

ByIndex ComponentBuilder::buildByIndex(std::span<const std::uint32_t> members,
                                       std::span<std::uint32_t> localOf, Component& out) {
  if (members.size() < 4) return ByIndex::Open;
  triangles_.clear();
  meshTriangle_.clear();
  degenerate_.clear();
  for (const std::uint32_t m : members) {
    const Triangle& t = mesh_.triangles[m];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
      degenerate_.push_back(m);
    } else {
      triangles_.push_back(t);
      meshTriangle_.push_back(m);
    }
  }
  numberVertices(localOf);
  const PairingCounts counts = pairer_.pair(triangles_, meshVertex_.size(), opposite_);
  if (counts.open > 0 || triangles_.size() < 4) return ByIndex::Open;
  if (counts.crowded > 0) return ByIndex::Crowded;
  const Consistency consistency = findConsistentTurns({triangles_, opposite_}, turn_, stack_);
  // A closed connected surface with Euler characteristic 2 is a sphere, and no vertex of it is used twice.
  const bool sphere = consistency.orientable && consistency.reached == triangles_.size() &&
                      2 * meshVertex_.size() == triangles_.size() + 4;
  if (!sphere) return ByIndex::Crowded;
  out.triangles = triangles_;
  out.meshTriangle = meshTriangle_;
  out.opposite = opposite_;
  out.degenerate = degenerate_;
  fillPositions(out);
  if (consistency.turned > 0) turnTriangles(turn_, out.triangles, out.opposite);
  finishClosed(out, consistency);
  return ByIndex::Closed;
}

Component ComponentBuilder::buildPaired(std::span<const std::uint32_t> members,
                                        std::span<const Triangle> corners,
                                        std::span<const std::uint32_t> meshTriangle,
                                        std::span<const std::uint32_t> opposite,
                                        std::span<std::uint32_t> memberOf) {
  Component out;
  for (std::uint32_t i = 0; i < members.size(); ++i) {
    memberOf[members[i]] = i;
    out.triangles.push_back(corners[members[i]]);
    out.meshTriangle.push_back(meshTriangle[members[i]]);
  }
  for (const std::uint32_t m : members)
    for (std::uint32_t h = 3 * m; h < 3 * m + 3; ++h)
      out.opposite.push_back(3 * memberOf[opposite[h] / 3] + opposite[h] % 3);
  const Consistency consistency = findConsistentTurns({out.triangles, out.opposite}, turn_, stack_);
  if (consistency.turned > 0) turnTriangles(turn_, out.triangles, out.opposite);
  // Each turn around a corner is a vertex, so that sheets which touch in one get one each.
  std::vector<std::uint32_t> vertexOf(out.opposite.size(), kNone);
  meshVertex_.clear();
  for (std::uint32_t h = 0; h < out.opposite.size(); ++h) {
    if (vertexOf[h] != kNone) continue;
    const auto vertex = std::uint32_t(meshVertex_.size());
    meshVertex_.push_back(out.triangles[h / 3][h % 3]);
    // Bounded also where a one-sided surface leads astray.
    for (std::uint32_t at = h; vertexOf[at] == kNone; at = nextHalfEdge(out.opposite[at]))
      vertexOf[at] = vertex;
  }
  for (std::uint32_t h = 0; h < out.opposite.size(); ++h)
    out.triangles[h / 3][h % 3] = vertexOf[h];
  fillPositions(out);
  const std::uint32_t first = out.meshTriangle.front();
  if (out.triangles.size() < 4) {
    out.fault = Fault{FaultKind::TooFew,
                      "it has " + counted(out.triangles.size(), "triangle", "triangles") +
                          " back to back; a solid has at least 4",
                      double(out.triangles.size()), out.positions.front(), first};
  } else if (!consistency.orientable) {
    out.fault =
        Fault{FaultKind::Misoriented, "it is a one-sided surface: no inside can be told from its outside",
              double(out.triangles.size()), out.positions.front(), first};
  } else if (2 * out.positions.size() != out.triangles.size() + 4) {
    const double genus = 1 - (double(out.positions.size()) - double(out.triangles.size()) / 2) / 2;
    out.fault = Fault{FaultKind::Genus,
                      "it has " + counted(std::size_t(genus), "handle", "handles") +
                          " (holes through it), so it is not convex",
                      genus, out.positions.front(), first};
  } else {
    finishClosed(out, consistency);
  }
  return out;
}

Component ComponentBuilder::buildFaulty(std::span<const std::uint32_t> members,
                                        std::span<const Triangle> corners,
                                        std::span<const std::uint32_t> meshTriangle,
                                        std::span<std::uint32_t> localOf) {
  Component out;
  triangles_.clear();
  for (const std::uint32_t m : members) {
    triangles_.push_back(corners[m]);
    out.meshTriangle.push_back(meshTriangle[m]);
  }
  numberVertices(localOf);
  const PairingCounts counts = pairer_.pair(triangles_, meshVertex_.size(), out.opposite);
  out.triangles = triangles_;
  fillPositions(out);
  out.fault = notClosed(out, counts);
  return out;
}

/// Everything that needs no more than the closed, consistent surface: scale, outside, thickness.
void ComponentBuilder::finishClosed(Component& component, const Consistency& consistency) {
  const double diagonal = component.bounds.diagonal();
  const std::uint32_t first = component.meshTriangle.front();
  if (!(diagonal >= kLeastDiagonal && diagonal <= kMostDiagonal)) {
    component.fault =
        Fault{FaultKind::NotFinite,
              "its diagonal is " + numberText(diagonal) + ", outside " + numberText(kLeastDiagonal) + " to " +
                  numberText(kMostDiagonal) + ", where single precision can square lengths; scale the mesh",
              diagonal, component.positions.front(), first};
    return;
  }
  const Extent extent = measure(component.triangles, component.positions, component.bounds);
  std::size_t turned = consistency.turned;
  if (extent.volume < 0) {
    turnAll(component.triangles, component.opposite);
    turned = component.triangles.size() - turned;
  }
  component.turnedTriangles = std::uint32_t(turned);
  component.turned = turned == component.triangles.size();
  // A plate of thickness t has volume t * area / 2.
  const double thickness = extent.area > 0 ? 2 * std::abs(extent.volume) / extent.area : 0;
  if (!(thickness > tolerances_.planarity))
    component.fault = Fault{FaultKind::Flat,
                            "it is flat: twice its volume over its area is " + numberText(thickness) +
                                " of its diagonal; at most the planarity tolerance of " +
                                numberText(tolerances_.planarity) + " counts as no thickness",
                            thickness, component.positions.front(), first};
}

Fault ComponentBuilder::notClosed(const Component& component, const PairingCounts& counts) const {
  const std::size_t count = component.triangles.size();
  const bool open = counts.open > 0;
  // The first edge of the kind that is reported; crowded edges have no partners either.
  std::uint32_t at = open ? kNone : pairer_.crowdedHalfEdges().front();
  if (open) {
    std::vector<bool> crowded(component.opposite.size());
    for (const std::uint32_t h : pairer_.crowdedHalfEdges())
      crowded[h] = true;
    for (at = 0; component.opposite[at] != kNone || crowded[at];)
      ++at;
  }
  const HalfEdges surface{component.triangles, component.opposite};
  const Point3 a = component.positions[surface.start(at)], b = component.positions[surface.end(at)];
  const std::uint32_t triangle = component.meshTriangle[at / 3];
  const std::string where = "from " + pointText(a.x, a.y, a.z) + " to " + pointText(b.x, b.y, b.z) + " of " +
                            placeOfTriangle(mesh_, triangle);
  const Point3 middle = a + (b - a) * 0.5;
  if (count < 4)
    return Fault{FaultKind::TooFew,
                 "it has " + counted(count, "triangle", "triangles") +
                     ", a solid has at least 4; open edge " + where,
                 double(count), middle, triangle};
  if (open) {
    std::string message =
        "it is open: " + counted(counts.open, "edge has a triangle", "edges have a triangle") +
        " on one side only, the first " + where;
    if (counts.crowded > 0)
      message += "; " + counted(counts.crowded, "edge is shared", "edges are shared") + " by more than two";
    return Fault{FaultKind::Open,
                 message + ". Close it; --weld joins vertices that nearly meet each other or an edge",
                 double(counts.open), middle, triangle};
  }
  return Fault{FaultKind::NonManifold,
               "it is not manifold: at " + counted(counts.crowded, "edge", "edges") +
                   " more than two triangles meet, " + std::to_string(pairer_.crowdedEnds().front()) +
                   " at the first, " + where + ". Solids that touch need vertices of their own",
               double(counts.crowded), middle, triangle};
}

} // namespace chamfer
