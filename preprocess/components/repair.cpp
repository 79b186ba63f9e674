#include "preprocess/components/repair.h"

#include "preprocess/components/component_builder.h"
#include "preprocess/components/disjoint_sets.h"
#include "preprocess/components/doubled_patches.h"
#include "preprocess/components/dropped.h"
#include "preprocess/components/edge_vertices.h"
#include "preprocess/components/grouping.h"
#include "preprocess/components/weld.h"

#include <algorithm>
#include <tbb/enumerable_thread_specific.h>

namespace chamfer {
namespace {

class Repairer {
public:
  Repairer(const TriangleMesh& mesh, const InputTolerances& tolerances, const ForEach& forEach,
           Components& result)
      : mesh_(mesh), tolerances_(tolerances), forEach_(forEach), result_(result),
        standsFor_(mesh.positions.size()),
        builders_([this] { return ComponentBuilder(mesh_, tolerances_); }) {
    for (std::uint32_t v = 0; v < standsFor_.size(); ++v)
      standsFor_[v] = v;
  }

  void run(const std::vector<std::uint32_t>& crowded, const std::vector<std::uint32_t>& open) {
    const std::size_t first = result_.list.size();
    meshTriangle_ = crowded;
    closeWhatCloses();
    meshTriangle_.insert(meshTriangle_.end(), open.begin(), open.end());
    std::sort(meshTriangle_.begin(), meshTriangle_.end());
    if (!meshTriangle_.empty()) {
      takeCorners();
      weldExact(corners_, mesh_.positions, standsFor_);
      closeWhatCloses();
    }
    if (!meshTriangle_.empty()) {
      weldNear(corners_, mesh_.positions, openVertices(), tolerances_.weld, standsFor_);
      closeWhatCloses();
    }
    if (!meshTriangle_.empty() && dropDoubledPatches(false)) closePaired();
    if (!meshTriangle_.empty() && splitAtVertices()) {
      closePaired();
      if (!meshTriangle_.empty() && dropDoubledPatches(false)) closePaired();
    }
    if (!meshTriangle_.empty()) keepFaulty();
    assignDropped(mesh_, standsFor_, first, std::move(dropped_), result_);
    for (std::uint32_t v = 0; v < standsFor_.size(); ++v)
      result_.counts.weldedVertices += standsFor_[v] != v;
  }

private:
  /// corners_ from meshTriangle_, without triangles that name a vertex twice (and, once welded, these are
  /// dropped).
  void takeCorners() {
    corners_.clear();
    std::size_t kept = 0;
    for (const std::uint32_t m : meshTriangle_) {
      Triangle t = mesh_.triangles[m];
      for (std::uint32_t& v : t)
        v = standsFor_[v];
      if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) {
        dropped_.degenerate.push_back(m);
        continue;
      }
      corners_.push_back(t);
      meshTriangle_[kept++] = m;
    }
    meshTriangle_.resize(kept);
  }

  /// One stage: pairs what meshTriangle_ holds, moves closed surfaces to the result and leaves the rest.
  void closeWhatCloses() {
    takeCorners();
    if (!corners_.empty()) closePaired();
  }

  /// The same for corners_ as they are.
  void closePaired() {
    pairAll();
    DisjointSets sets(corners_.size());
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
      if (opposite_[h] != kNone) sets.join(h / 3, opposite_[h] / 3);
    std::vector<bool> open(corners_.size());
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
      if (opposite_[h] == kNone) open[sets.find(h / 3)] = true;
    const Lists surfaces =
        listsBy(corners_.size(), corners_.size(), [&](std::uint32_t i) { return sets.find(i); });
    std::vector<std::uint32_t> closed, rest;
    for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
      if (!open[sets.find(surfaces[s][0])])
        closed.push_back(s);
      else
        rest.insert(rest.end(), surfaces[s].begin(), surfaces[s].end());
    }
    const std::size_t first = result_.list.size();
    result_.list.resize(first + closed.size());
    std::vector<std::uint32_t> memberOf(corners_.size());
    forEach_(closed.size(), [&](std::size_t i) {
      result_.list[first + i] =
          builders_.local().buildPaired(surfaces[closed[i]], corners_, meshTriangle_, opposite_, memberOf);
    });
    std::sort(rest.begin(), rest.end());
    for (std::size_t i = 0; i < rest.size(); ++i) {
      corners_[i] = corners_[rest[i]];
      meshTriangle_[i] = meshTriangle_[rest[i]];
    }
    corners_.resize(rest.size());
    meshTriangle_.resize(rest.size());
  }

  /// opposite_ from corners_, after dropping what repeats.
  void pairAll() {
    if (pairer_.pair(corners_, mesh_.positions.size(), opposite_).crowded == 0) return;
    dropDoubledPatches(true);
    pairer_.pair(corners_, mesh_.positions.size(), opposite_);
    pairCrowdedEdges();
  }

  /// Splits triangles at vertices on their edges. Says whether there were any. Triangles without height,
  /// which polygons with such vertices were cut into, are then of no use.
  bool splitAtVertices() {
    if (pairer_.pair(corners_, mesh_.positions.size(), opposite_).open == 0) return false;
    const std::vector<bool> flat = findFlatTriangles(mesh_.positions, corners_, tolerances_.weld);
    std::vector<Triangle> corners;
    std::vector<std::uint32_t> meshTriangle, dropped;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (flat[i]) {
        dropped.push_back(meshTriangle_[i]);
        continue;
      }
      corners.push_back(corners_[i]);
      meshTriangle.push_back(meshTriangle_[i]);
    }
    corners.swap(corners_);
    meshTriangle.swap(meshTriangle_);
    pairAll();
    const std::size_t split =
        splitAtEdgeVertices(mesh_.positions, opposite_, tolerances_.weld, corners_, meshTriangle_);
    dropped_.degenerate.insert(dropped_.degenerate.end(), dropped.begin(), dropped.end());
    result_.counts.splitEdges += split;
    return split > 0 || !dropped.empty();
  }

  /// Faces that are there twice: those that face the same way, or all. Says whether there were any.
  bool dropDoubledPatches(bool sameWay) {
    if (pairer_.pair(corners_, mesh_.positions.size(), opposite_).crowded == 0) return false;
    forCrowdedEdges([&](std::vector<std::uint32_t>& edge) { pairWithinFaces(edge); });
    return dropRepeated(findDoubledPatches(corners_, mesh_.positions, opposite_, pairer_.crowdedHalfEdges(),
                                           tolerances_.planarity, sameWay));
  }

  /// Drops the triangles that have an entry in `repeated`: the triangle that stays for them. Says whether
  /// there were any.
  bool dropRepeated(const std::vector<std::uint32_t>& repeated) {
    for (std::size_t i = 0; i < corners_.size(); ++i)
      if (repeated[i] != kNone) dropped_.duplicates.push_back({meshTriangle_[i], meshTriangle_[repeated[i]]});
    std::size_t kept = 0;
    for (std::size_t i = 0; i < corners_.size(); ++i) {
      if (repeated[i] != kNone) continue;
      corners_[kept] = corners_[i];
      meshTriangle_[kept++] = meshTriangle_[i];
    }
    const bool any = kept < corners_.size();
    corners_.resize(kept);
    meshTriangle_.resize(kept);
    return any;
  }

  void pairCrowdedEdges() {
    DisjointSets pieces(mesh_.positions.size()), patches(corners_.size());
    const std::vector<double> volume = volumeOfPieces(pieces);
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
      if (opposite_[h] != kNone) patches.join(h / 3, opposite_[h] / 3);
    const auto rank = [&](std::uint32_t h) { return patches.find(h / 3); };
    forCrowdedEdges([&](std::vector<std::uint32_t>& edge) {
      pairWithinFaces(edge);
      if (edge.size() == 2) {
        opposite_[edge[0]] = edge[1];
        opposite_[edge[1]] = edge[0];
      } else if (!edge.empty()) {
        const bool insideOut = volume[pieces.find(corners_[edge[0] / 3][0])] < 0;
        std::stable_sort(edge.begin(), edge.end(),
                         [&](std::uint32_t g, std::uint32_t h) { return rank(g) < rank(h); });
        // A file that shares vertices says what hangs together; but a solid may be there more than once.
        pairCrowdedEdge(edge, corners_, mesh_.positions, insideOut, !mesh_.soup, opposite_);
      }
    });
  }

  /// Calls each(half-edges) for each crowded edge.
  template <class Each>
  void forCrowdedEdges(const Each& each) {
    std::size_t begin = 0;
    for (const std::uint32_t end : pairer_.crowdedEnds()) {
      std::vector<std::uint32_t> edge(pairer_.crowdedHalfEdges().begin() + std::ptrdiff_t(begin),
                                      pairer_.crowdedHalfEdges().begin() + std::ptrdiff_t(end));
      begin = end;
      each(edge);
    }
  }

  /// Pairs the two sides of diagonals that triangulation drew inside a polygon, and takes them out of `edge`:
  /// where a polygon's corner lies on the line between two others, the diagonals of both its faces join the
  /// same vertices.
  void pairWithinFaces(std::vector<std::uint32_t>& edge) {
    if (mesh_.faceOfTriangle.empty()) return;
    const auto face = [&](std::uint32_t h) { return mesh_.faceOfTriangle[meshTriangle_[h / 3]]; };
    std::stable_sort(edge.begin(), edge.end(),
                     [&](std::uint32_t g, std::uint32_t h) { return face(g) < face(h); });
    std::vector<std::uint32_t> rest;
    for (std::size_t i = 0; i < edge.size(); ++i) {
      if (i + 1 < edge.size() && face(edge[i]) == face(edge[i + 1])) {
        opposite_[edge[i]] = edge[i + 1];
        opposite_[edge[i + 1]] = edge[i];
        ++i;
      } else {
        rest.push_back(edge[i]);
      }
    }
    edge.swap(rest);
  }

  /// By piece that hangs together in vertices (in `pieces`, at its representative): its sign says which side
  /// of the triangles is the inside before anything is known to be closed.
  std::vector<double> volumeOfPieces(DisjointSets& pieces) const {
    for (const Triangle& t : corners_) {
      pieces.join(t[0], t[1]);
      pieces.join(t[0], t[2]);
    }
    std::vector<double> volume(mesh_.positions.size());
    for (const Triangle& t : corners_) {
      const std::uint32_t piece = pieces.find(t[0]);
      const Point3 origin = mesh_.positions[piece];
      volume[piece] += dot(mesh_.positions[t[0]] - origin,
                           cross(mesh_.positions[t[1]] - origin, mesh_.positions[t[2]] - origin));
    }
    return volume;
  }

  /// Ends of edges without partner, each once, ascending.
  std::vector<std::uint32_t> openVertices() {
    pairer_.pair(corners_, mesh_.positions.size(), opposite_);
    std::vector<std::uint32_t> vertices;
    const HalfEdges surface{corners_, opposite_};
    for (std::uint32_t h = 0; h < opposite_.size(); ++h)
      if (opposite_[h] == kNone) vertices.insert(vertices.end(), {surface.start(h), surface.end(h)});
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  /// What is left, one component for all that hangs together in vertices.
  void keepFaulty() {
    DisjointSets pieces(mesh_.positions.size());
    for (const Triangle& t : corners_) {
      pieces.join(t[0], t[1]);
      pieces.join(t[0], t[2]);
    }
    const Lists sets = listsBy(corners_.size(), mesh_.positions.size(),
                               [&](std::uint32_t i) { return pieces.find(corners_[i][0]); });
    const std::size_t first = result_.list.size();
    result_.list.resize(first + sets.size());
    std::vector<std::uint32_t> localOf(mesh_.positions.size(), kNone);
    forEach_(sets.size(), [&](std::size_t i) {
      result_.list[first + i] = builders_.local().buildFaulty(sets[i], corners_, meshTriangle_, localOf);
    });
  }

  const TriangleMesh& mesh_;
  const InputTolerances& tolerances_;
  const ForEach& forEach_;
  Components& result_;
  std::vector<std::uint32_t> standsFor_;    ///< by mesh vertex
  std::vector<std::uint32_t> meshTriangle_; ///< not closed yet
  std::vector<Triangle> corners_;           ///< of these, as welded
  std::vector<std::uint32_t> opposite_;
  Dropped dropped_;
  HalfEdgePairer pairer_;
  tbb::enumerable_thread_specific<ComponentBuilder> builders_;
};

} // namespace

void repairComponents(const TriangleMesh& mesh, const InputTolerances& tolerances,
                      const std::vector<std::uint32_t>& crowded, const std::vector<std::uint32_t>& open,
                      const ForEach& forEach, Components& result) {
  if (!crowded.empty() || !open.empty()) Repairer(mesh, tolerances, forEach, result).run(crowded, open);
}

} // namespace chamfer
