// Solids as polygons that need not agree with each other: for meshes with the faults that exporters leave.
#pragma once

#include "tests/oracle/convex_solid.h"
#include "tests/oracle/random.h"

namespace chamfer {

struct PolygonSolid {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<std::vector<std::uint32_t>> faces; ///< any loops over the vertices

  explicit PolygonSolid(const oracle::ConvexSolid& solid) : vertices(solid.vertices), faces(solid.faces) {}

  /// Puts up to three new vertices on each edge that `chance` takes, into the loop of one of its faces or
  /// both, each with its own.
  void insertEdgeVertices(double chance, oracle::Random& random);
  /// Gives faces (one of them, or all) a second time, with the corners in the order of the other side or not,
  /// begun at another corner, with vertices of their own or not.
  void repeatFaces(bool all, bool otherSide, bool ownVertices, oracle::Random& random);
  /// Joins neighbours into polygons of up to `most` corners where the loop is convex as seen along its own
  /// normal: warped ones, with the hull as their one convex triangulation.
  void joinFaces(std::size_t most, oracle::Random& random);
  void beginFacesAnywhere(oracle::Random& random);

  std::string obj() const;
  std::string off() const;
  std::string ply() const;
  std::string stl() const; ///< ASCII, fans
  /// One of the four texts by the extension without dot.
  std::string text(const std::string& format) const;
};

} // namespace chamfer
