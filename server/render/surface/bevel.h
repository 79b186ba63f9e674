// rounding=bevel:N, the industry's bevel shader, to compare with: the geometry stays sharp, the shading
// normal is the mean of the normals found around the point, within the radius, by N probe rays.
//
// The method is Cycles' Bevel node (Blender Manual, "Bevel Node"; Cycles' svm/bevel.h), after the disk
// projection of
//   King, Kulla, Conty and Fajardo, "BSSRDF Importance Sampling", SIGGRAPH 2013 Talks:
// a point is drawn on a disk about the shaded point, with the cubic falloff as density; the disk faces along
// the normal or, each half as often, along one of two tangents; a probe crosses the ball of the radius there;
// each surface of the same object that it meets counts with the falloff at its true distance, the three axes
// weighed against each other by the power heuristic.
#pragma once

#include "server/render/path/sampler.h"
#include "server/render/tracing/tracer.h"

namespace chamfer {

/// Where a bevel looks: one mesh, in its own frame, so that all instances of it bevel alike.
struct BevelMesh {
  const TracedMesh& traced;
  const TriangleMesh& mesh;
  const RoundingView& rounding; ///< radii and the facets' outward normals; no rounding is traced
};

/// Shading normal at `p` on a triangle of the mesh, object frame, unit, on the side of `normal` (the
/// triangle's, unit). Returns `normal` where the triangle is not rounded. Probe i uses pair `firstPair` + i
/// of the sampler.
Vector3 bevelNormal(const BevelMesh& bevel, std::uint32_t triangle, const Point3& p, const Vector3& normal,
                    unsigned probes, const Sampler& sampler, std::uint32_t firstPair);

/// The falloff with which surfaces at distance `r` count, per area: 10 (R - r)^3 / (pi R^5), which integrates
/// to 1 over a disk of radius R.
double bevelFalloff(double radius, double r);
/// The distance from the centre below which the share `u` in [0, 1) of the falloff over the disk lies.
double sampleBevelDistance(double radius, double u);

} // namespace chamfer
