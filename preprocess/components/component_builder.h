// Builds one Component out of mesh triangles that belong together: compact vertices, partners, orientation,
// and the checks that say whether it is a closed surface of the topology of a ball.
#pragma once

#include "preprocess/components/half_edges.h"
#include "preprocess/components/orient.h"
#include "preprocess/components/solids.h"

namespace chamfer {

enum class ByIndex : std::uint8_t {
  Closed,  ///< a closed surface without handles: the component is complete
  Crowded, ///< no open edge, but edges or vertices that more than one sheet shares, or handles
  Open,
};

/// Not thread safe: one for each thread. Keeps its memory from call to call.
class ComponentBuilder {
public:
  ComponentBuilder(const TriangleMesh& mesh, const InputTolerances& tolerances)
      : mesh_(mesh), tolerances_(tolerances) {}

  /// From the file's indices alone. `members`: mesh triangles, ascending. `localOf` (one entry a mesh vertex,
  /// kNone) is scratch whose entries of these triangles are used; sets of triangles without common vertices
  /// may share it over threads. `out` is filled only when the answer is Closed.
  ByIndex buildByIndex(std::span<const std::uint32_t> members, std::span<std::uint32_t> localOf,
                       Component& out);

  /// From triangles whose half-edges are all paired with each other. `members` are indices into `corners`,
  /// whose triangles name welded mesh vertices, and `meshTriangle`; `opposite` is theirs. `memberOf` (one
  /// entry a triangle) is scratch as above. Sheets that touch in a vertex get a vertex each.
  Component buildPaired(std::span<const std::uint32_t> members, std::span<const Triangle> corners,
                        std::span<const std::uint32_t> meshTriangle, std::span<const std::uint32_t> opposite,
                        std::span<std::uint32_t> memberOf);

  /// From what could not be closed: the component carries the fault.
  Component buildFaulty(std::span<const std::uint32_t> members, std::span<const Triangle> corners,
                        std::span<const std::uint32_t> meshTriangle, std::span<std::uint32_t> localOf);

private:
  void numberVertices(std::span<std::uint32_t> localOf);
  void fillPositions(Component& component) const;
  void finishClosed(Component& component, const Consistency& consistency);
  Fault notClosed(const Component& component, const PairingCounts& counts) const;

  const TriangleMesh& mesh_;
  const InputTolerances& tolerances_;
  HalfEdgePairer pairer_;
  std::vector<Triangle> triangles_;
  std::vector<std::uint32_t> meshTriangle_, degenerate_, opposite_, meshVertex_, stack_;
  std::vector<std::uint8_t> turn_;
};

} // namespace chamfer
