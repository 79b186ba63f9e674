// Rays against one rounded solid R (docs: the rounding's file header, rounding.h).
//
// Everything here is in the solid's frame and in double arithmetic on the stored float32 data; `t` is in
// units of the ray direction's length, which need not be 1. The functions are pure and thread safe.
#pragma once

#include "common/rounding.h"

#include <optional>

namespace chamfer {

enum class Feature : std::uint8_t { Flat, Cylinder, Sphere };

/// One end of the interval of a line inside R.
struct RoundedEnd {
  double t = 0;
  Vector3 normal; ///< unit, outward
  Feature feature = Feature::Flat;

  RoundedEnd() = default;
  RoundedEnd(double t_, const Vector3& n, Feature f) : t(t_), normal(n.x, n.y, n.z), feature(f) {}
  /// Number by number: a copy in wide words would wait for the narrow stores just before it.
  RoundedEnd(const RoundedEnd& o) : RoundedEnd(o.t, o.normal, o.feature) {}
  RoundedEnd& operator=(const RoundedEnd& o) {
    t = o.t;
    normal.x = o.normal.x;
    normal.y = o.normal.y;
    normal.z = o.normal.z;
    feature = o.feature;
    return *this;
  }
};

/// A line's interval inside R.
struct RoundedInterval {
  RoundedEnd in, out;
};

/// What the detection says of a point on P's surface.
struct Detection {
  bool inZone;            ///< false: the point is on a flat
  std::uint32_t halfEdge; ///< in the zone: a feature near the point to start the walk from
};

/// Is the point `p` (on or near facet `facet` of solid `solid`; solid's frame) in a chamfer zone? Tests the
/// facet's own detection cylinders, through the kd-tree where the facet has one.
Detection detect(const RoundingView& view, std::uint32_t solid, std::uint32_t facet, const Point3& p);

/// Where the whole line of `ray` enters R, or nothing when the line misses R. `startHalfEdge`: where the
/// search begins; any local half-edge gives the same answer, a near one gives it sooner. The ray's origin
/// should be near the solid (within some diameters): positions lose about 1e-16 of its distance.
std::optional<RoundedEnd> entry(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                                std::uint32_t startHalfEdge);
/// Where the line leaves R: the entry of the reversed line.
std::optional<RoundedEnd> exit(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                               std::uint32_t startHalfEdge);
/// Both.
std::optional<RoundedInterval> interval(const RoundingView& view, std::uint32_t solid, const Ray& ray,
                                        std::uint32_t startHalfEdge);

/// A mesh triangle's candidate for being the hit of a ray.
struct Candidate {
  std::uint32_t facet; ///< index in view.facets of the facet that the triangle belongs to
  double t;            ///< where the ray meets the triangle; a float32 value is near enough
};

/// The first end of the ray's interval in the candidate's solid that lies beyond `tnear`, with the ray in the
/// MESH's frame; nothing when there is none. This is the whole decision behind a mesh hit where nothing is
/// known of the ray's origin: flats are answered at once, zones are searched, slivers are seen through. The
/// answer does not depend on which of the solid's triangles asked, but a back-facing candidate of a ray that
/// begins outside P may answer nothing: a front-facing one speaks for that ray.
std::optional<RoundedEnd> firstEndBeyond(const RoundingView& view, const Candidate& candidate, const Ray& ray,
                                         double tnear);

/// The near end of the ray's line in the candidate's solid, wherever the ray begins, ray in the mesh's frame:
/// for a path outside of P. A back-facing candidate answers nothing: a front-facing one speaks.
std::optional<RoundedEnd> nearEnd(const RoundingView& view, const Candidate& candidate, const Ray& ray);
/// The far end, for a path inside R. A front-facing candidate answers nothing.
std::optional<RoundedEnd> farEnd(const RoundingView& view, const Candidate& candidate, const Ray& ray);
/// Both without a candidate, for a ray that begins in the solid or in its sliver (mesh's frame). `facet`: any
/// of the solid's, in view.facets.
std::optional<RoundedInterval> intervalFrom(const RoundingView& view, std::uint32_t facet, const Ray& ray);

/// Is a point of the mesh's frame in the unrounded solid P, or on its surface for all that float32 can tell?
bool inUnroundedSolid(const RoundingView& view, std::uint32_t solid, const Point3& point);
/// The same in bounded time: of a solid with many facets true may be said of a point beside it.
bool maybeInUnroundedSolid(const RoundingView& view, std::uint32_t solid, const Point3& point);
/// Is the ball about a point of the mesh's frame inside R, surely? False without looking where a solid has
/// many facets.
bool isDeepIn(const RoundingView& view, std::uint32_t solid, const Point3& point, double radius);
/// Does `outer`'s P hold the whole of `inner`'s R, for all that float32 can tell? Both are of the view.
bool holdsSolid(const RoundingView& view, std::uint32_t outer, std::uint32_t inner);

/// Is a point of the mesh's frame in the rounded solid? Takes time linear in the solid's facets.
bool contains(const RoundingView& view, std::uint32_t solid, const Point3& point);

} // namespace chamfer
