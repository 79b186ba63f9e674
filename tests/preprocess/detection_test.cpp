// detect() through a kd-tree says what the facet's whole loop says.
#include "common/ray_query.h"
#include "preprocess/preprocess.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/rounded_oracle.h"
#include "tests/support/mesh_of.h"

#include <gtest/gtest.h>
#include <random>

namespace chamfer {
namespace {

/// Half-edges and centres of solid 0, without the code under test.
struct Loop {
  explicit Loop(const RoundingView& view_) : view(view_), quantum(sphereQuantum(view_.solids[0])) {}
  HalfEdge halfEdge(std::uint32_t h) const {
    return view.packed[view.solids[0].halfEdgeStart() + h].unpack();
  }
  Vector3 start(std::uint32_t h) const {
    return decodeSphere(view.spheres[view.solids[0].firstSphere + halfEdge(h).sphere], quantum);
  }
  Vector3 end(std::uint32_t h) const { return start(halfEdge(h).twin); }
  /// Distance of `p` beyond the tangent line of `h`, along the facet; above 0: in the chamfer zone.
  double depth(const FacetRecord& facet, std::uint32_t h, const Vector3& p) const {
    const Vector3 along = end(h) - start(h);
    return dot(p - start(h), cross(along, Vector3(facet.normal))) / length(along);
  }
  const RoundingView& view;
  double quantum;
};

TEST(Detection, TreeOfAPrismsCapAgreesWithItsWholeLoop) {
  constexpr unsigned kSides = 200;
  for (const double share : {0.02, 0.6}) {
    PreprocessOptions options;
    options.radius.value = share * double(oracle::inball(oracle::prism(kSides, 1)).radius);
    const auto result = preprocess(meshOf(oracle::prism(kSides, 1)), options);
    const RoundingView& view = result.rounding->view();
    const Loop loop(view);
    const double scale = view.solids[0].boundRadius;
    std::size_t caps = 0, inZone = 0, onFlat = 0, border = 0;
    for (std::uint32_t f = 0; f < view.facets.size(); ++f) {
      const FacetRecord& facet = view.facets[f];
      if (!facet.hasTree()) continue;
      ++caps;
      std::mt19937 random(f);
      std::uniform_real_distribution<double> unit(0, 1);
      const Vector3 n(facet.normal);
      const Vector3 u = normalize(cross(n, std::abs(n.x) < 0.5 ? Vector3(1, 0, 0) : Vector3(0, 1, 0)));
      const Vector3 v = cross(n, u);
      // The prism's axis goes through the mesh's origin, not through the solid's.
      const double* origin = view.solids[0].origin;
      const Vector3 axis(-origin[0], -origin[1], -origin[2]);
      const Vector3 centre = axis + n * (double(facet.offset) - dot(n, axis));
      for (int i = 0; i < 20000; ++i) {
        // The polygon's circumradius is 1; half of the points are near the rim.
        const double radius = i % 2 ? std::sqrt(unit(random)) : 1 - options.radius.value * 2 * unit(random);
        const double angle = 6.283185307179586 * unit(random);
        const Vector3 p = centre + u * (radius * std::cos(angle)) + v * (radius * std::sin(angle));
        double deepest = -INFINITY;
        for (unsigned k = 0; k < kSides; ++k) {
          const std::uint32_t h = facet.firstHalfEdge() + k;
          ASSERT_EQ(loop.halfEdge(h).facet, f);
          deepest = std::max(deepest, loop.depth(facet, h, p));
        }
        if (std::abs(deepest) < 1e-7 * scale) {
          ++border;
          continue;
        }
        const Detection answer = detect(view, 0, f, Point3(p));
        ASSERT_EQ(answer.inZone, deepest > 0) << "facet " << f << ", depth " << deepest;
        if (answer.inZone) {
          ++inZone;
          // The half-edge to start from is the one whose cylinder the point is deepest in.
          ASSERT_NEAR(loop.depth(facet, answer.halfEdge, p), deepest, 1e-5 * scale);
        } else
          ++onFlat;
      }
    }
    EXPECT_EQ(caps, 2u);
    EXPECT_GT(inZone, 5000u);
    EXPECT_GT(onFlat, 5000u);
    EXPECT_LT(border, 40u);
  }
}

TEST(Detection, FacetsOfFewEdgesHaveNoTree) {
  PreprocessOptions options;
  options.radius.value = 0.1;
  const auto result = preprocess(meshOf(oracle::prism(8, 1)), options);
  const RoundingView& view = result.rounding->view();
  EXPECT_TRUE(view.treeRoots.empty());
  for (const FacetRecord& facet : view.facets)
    EXPECT_FALSE(facet.hasTree());
}

} // namespace
} // namespace chamfer
