// Bsdf (material/bsdf.h) of opaque surfaces in lanes: diffuse base, coat and metal, no glass. Formula by
// formula the same, so that a lane's bits are the scalar's; what the lobes are is said there.
#pragma once

#include "server/render/material/microfacet.h"
#include "server/render/wavefront/lanes.h"

namespace chamfer {

/// Values of the surfaces in eight lanes; every lane must be set.
struct OpaqueSurfaces {
  ColorLaneFloats baseColor;
  LaneFloats roughness, metallic, specular, ior;
};

struct BsdfLanes {
  ColorLanes f;
  Lanes pdf = 0;
};

struct BsdfSampleLanes {
  VectorLanes wi;
  ColorLanes weight;
  Lanes pdf = 0;
  LaneMask delta{false}, valid{false};
};

class OpaqueBsdf {
public:
  OpaqueBsdf(const OpaqueSurfaces& surfaces, const VectorLanes& wo);
  BsdfLanes evaluate(const VectorLanes& wi) const; ///< wi.z not above 0: nothing
  BsdfSampleLanes sample(const Lanes& lobe, const Lanes& ux, const Lanes& uy) const;
  LaneMask hasSmoothPart() const { return cosine_ > 0 || (reflect_ > 0 && !mirror_); }

private:
  struct Albedo {
    Lanes total, white;
    Lanes at(const Lanes& f0) const { return f0 * total + (Lanes(1) - f0) * white; }
  };
  Albedo directional(const Lanes& mu) const;
  ColorLanes schlickOfMetal(const Lanes& cosine) const;
  ColorLanes reflectance(const Lanes& cosine) const;

  VectorLanes wo_;
  GgxT<Lanes> ggx_;
  ColorLanes baseColor_;
  Lanes metal_, base_, coatF0_;
  LaneMask mirror_;
  int row_[kLanes];
  Lanes rowShare_;
  ColorLanes baseLobe_, metalLobe_;
  Lanes cosine_ = 0, reflect_ = 0;
  bool anyMetal_, anyBase_;
};

} // namespace chamfer
