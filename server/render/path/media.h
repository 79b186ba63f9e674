// What lies on either side of a surface that a path meets: which solid's medium it comes from, which it would
// go on into, and which of several coinciding surfaces acts.
//
// Rules. Light goes through solids of a transmissive material; each is filled with a medium of its index and
// absorption, outside is vacuum. Where several overlap, the smallest one's medium counts (what is put into
// another thing displaces it), of equal ones the last in the scene. Where solids touch, nothing lies between
// them: light goes from one medium straight into the other, and an opaque surface that touches glass is seen
// through the glass alone. A surface between equal media is not there. Cf. C. Schmidt and B. Budge, "Simple
// Nested Dielectrics in Ray Traced Images", JGT 7(2), 2002, whose priorities this takes from the sizes.
#pragma once

#include "server/render/surface/surface.h"

namespace chamfer {

/// The surface that a path meets, as it acts on light.
struct Crossing {
  const TraceHit* hit; ///< the hit itself or one of those that coincide with it
  SurfacePlace place;
  const Material* before; ///< the medium that the path comes through; null: none
  float eta;              ///< index of refraction of the far side over that of the near side
  bool nothing;           ///< no surface: the path goes on as it is
};

class Media {
public:
  /// Both must outlive it.
  Media(const Surfaces& surfaces, const Tracer& tracer) : surfaces_(surfaces), tracer_(tracer) {}

  /// `direction`: of the path that arrives. The result points into `hit` or `arrival`, whose state gets the
  /// normal of the surface that acts.
  Crossing crossing(const TraceHit& hit, Arrival& arrival, const Vector3& direction) const;
  /// The medium that a ray along `direction` begins in; null: none.
  const Material* at(const PathState& state, const Vector3& direction) const;

private:
  /// Does `a` displace `b` where they overlap?
  bool displaces(std::uint32_t aInstance, std::uint32_t aSolid, std::uint32_t bInstance,
                 std::uint32_t bSolid) const;

  const Surfaces& surfaces_;
  const Tracer& tracer_;
};

/// The share of light that a medium lets through over a distance.
Color transmittance(const Material* medium, double distance);

} // namespace chamfer
