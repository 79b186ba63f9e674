// Families of convex solids, each by its closed form or from a seed. Sizes are about 1; all hold the origin
// inside.
#pragma once

#include "tests/oracle/convex_solid.h"

namespace chamfer::oracle {

ConvexSolid box(double x, double y, double z); ///< edge lengths; centred
ConvexSolid cube();                            ///< edge length 1
ConvexSolid tetrahedron();
ConvexSolid octahedron();
ConvexSolid dodecahedron();
ConvexSolid icosahedron();
/// `sides` >= 3, circumradius 1, over the regular polygon.
ConvexSolid prism(unsigned sides, double height);
ConvexSolid antiprism(unsigned sides, double height);
ConvexSolid pyramid(unsigned sides, double height);
ConvexSolid bipyramid(unsigned sides, double height); ///< `height` of each half
/// Top circumradius `top` in (0, 1).
ConvexSolid frustum(unsigned sides, double top, double height);
/// Triangular prism of length 1 whose sharpest (or, above 60 degrees, bluntest) edge has this interior
/// dihedral angle.
ConvexSolid wedge(double angleDegrees);

ConvexSolid hullOnSphere(unsigned points, std::uint64_t seed); ///< all points are corners
ConvexSolid hullInBall(unsigned points, std::uint64_t seed);
/// Voronoi cell of the origin among `sites` random neighbours.
ConvexSolid voronoiCell(unsigned sites, std::uint64_t seed);

/// Every corner cut off, `depth` of the diagonal deep.
ConvexSolid cutCorners(const ConvexSolid& solid, double depth);
/// Every facet moved by up to `amount` of the diagonal: corners of degree above three fall into short edges.
ConvexSolid jitteredFacets(const ConvexSolid& solid, double amount, std::uint64_t seed);

/// All families, in sizes that suit a test of seconds.
std::vector<ConvexSolid> familyCatalogue();
/// The largest members: prisms and antiprisms of 200 sides, hulls of 1,000 points.
std::vector<ConvexSolid> largeFamilies();

} // namespace chamfer::oracle
