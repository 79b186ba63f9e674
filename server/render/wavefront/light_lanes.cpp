#include "server/render/wavefront/light_lanes.h"

#include "server/render/path/warp.h"

namespace chamfer {

LightSampler::LightSampler(const Lights& lights) : lights_(lights) {
  const auto& few = lights.triangles().few();
  inLanes_ = lights.triangleShare() > 0 && !few.empty() &&
             std::none_of(few.begin(), few.end(), [](const auto& t) { return t.wholeSolid; });
}

void LightSampler::sample(const Point3* points, const LaneFloats& choice, const LaneFloats& ux,
                          const LaneFloats& uy, std::size_t count, LightLanes& result) const {
  const float share = lights_.triangleShare();
  if (inLanes_) sampleTriangles(points, choice, ux, uy, result);
  for (std::size_t i = 0; i < count; ++i) {
    if (inLanes_ && choice[i] < share) continue;
    const LightSample s = lights_.sample(points[i], choice[i], {ux[i], uy[i]});
    result.toLight[i] = s.toLight;
    result.tfar[i] = s.tfar;
    result.direction.set(i, s.direction);
    result.radiance.set(i, s.radiance);
    result.pdf[i] = s.pdf;
    result.delta[i] = s.delta;
    result.instance[i] = s.instance;
    result.solid[i] = s.solid;
  }
}

void LightSampler::sampleTriangles(const Point3* points, const LaneFloats& choice, const LaneFloats& ux,
                                   const LaneFloats& uy, LightLanes& result) const {
  const TriangleLights& triangles = lights_.triangles();
  const float share = lights_.triangleShare();
  const double perReach = triangles.perReach();
  const auto& few = triangles.few();
  const auto from = [&](const Point3& at) {
    VectorLaneFloats d;
    for (std::size_t i = 0; i < kLanes; ++i)
      d.set(i, Vector3f((at - points[i]) * perReach));
    return VectorLanes(d);
  };

  // The choice, as TriangleLights::choose().
  Lanes weights[kFewLights], sum = 0;
  for (std::size_t k = 0; k < few.size(); ++k) {
    const TriangleLights::Target& t = few[k];
    const VectorLanes d = from(t.centre);
    const Lanes distance2 = lengthSquared(d), height = dot(VectorLanes(t.normal), d);
    const Lanes cosine = abs(height) / sqrt(max(distance2, Lanes(1e-30f * t.size2)));
    weights[k] = Lanes(t.power) * (cosine + Lanes(0.05f)) / (distance2 + Lanes(t.size2));
    if (t.oneSided) where(!(height < 0), weights[k]) = 0;
    sum += weights[k];
  }
  const Lanes within = min(Lanes(choice) / Lanes(share), Lanes(0x1.fffffep-1f));
  Lanes left = within * sum, chosen = 0, weight = weights[0];
  LaneMask open(true);
  for (std::size_t k = 0; k < few.size(); ++k) {
    const LaneMask taken = open && weights[k] > 0;
    where(taken, chosen) = float(k);
    where(taken, weight) = weights[k];
    left -= weights[k];
    open = open && !(left < 0);
  }
  const Lanes chance = weight / sum;

  // The triangle as it is seen, as TriangleLights::near().
  VectorLaneFloats corner, edge1, edge2, normal;
  LaneFloats size2, area, sided;
  Vector3 fromPoint[kLanes];
  const EmissiveTriangle* lights[kLanes];
  for (std::size_t i = 0; i < kLanes; ++i) {
    const auto index = std::uint32_t(chosen[i]);
    const TriangleLights::Aim& aim = triangles.aim(index);
    lights[i] = &triangles.triangle(index);
    fromPoint[i] = lights[i]->corner - points[i];
    corner.set(i, Vector3f(fromPoint[i] * perReach));
    edge1.set(i, aim.edge1);
    edge2.set(i, aim.edge2);
    normal.set(i, aim.normal);
    size2[i] = aim.size2;
    area[i] = aim.area;
    sided[i] = lights[i]->oneSided;
    result.radiance.set(i, lights[i]->emission);
    result.delta[i] = false;
    result.instance[i] = lights[i]->instance;
    result.solid[i] = lights[i]->solid;
  }
  const VectorLanes a = corner, b = a + VectorLanes(edge1), c = a + VectorLanes(edge2), n = normal;
  const Lanes height = dot(n, a);
  const LaneMask faces = (Lanes(sided) > 0 && height < 0) || (!(Lanes(sided) > 0) && !(height == 0));
  const SphericalTriangleT<Lanes> seen(a, b, c, height);
  const LaneMask near = !(lengthSquared(a + b + c) > Lanes(9 * kFarLight) * Lanes(size2)) &&
                        seen.solidAngle() > kSmallestNear && seen.solidAngle() < kLargestNear;
  VectorLaneFloats onSphere;
  if (any_of(near)) onSphere = VectorLaneFloats(seen.sample(ux, uy));
  Lanes second, third;
  warpToTriangle(Lanes(ux), Lanes(uy), second, third);

  // The place on it, in double.
  const LaneFloats at2(second), at3(third);
  VectorLaneFloats toLight;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const EmissiveTriangle& light = *lights[i];
    if (near[i]) {
      const Vector3 d(onSphere[i]), itsNormal = cross(light.edge1, light.edge2);
      result.toLight[i] = d * (dot(itsNormal, fromPoint[i]) / dot(itsNormal, d));
    } else {
      result.toLight[i] = fromPoint[i] + light.edge1 * double(at2[i]) + light.edge2 * double(at3[i]);
    }
    toLight.set(i, Vector3f(result.toLight[i] * perReach));
  }
  const VectorLanes to = toLight;
  const Lanes distance2 = lengthSquared(to), distance = sqrt(distance2);
  const Lanes cosine = abs(height) / (Lanes(2) * Lanes(area) * distance);
  const Lanes pdf =
      chance * select(near, Lanes(1) / seen.solidAngle(), distance2 / (cosine * Lanes(area))) * Lanes(share);
  const LaneMask lit = sum > 0 && faces && distance2 > 0 && cosine > 0;
  result.pdf = LaneFloats(select(lit, pdf, Lanes(0)));
  result.direction = VectorLaneFloats(to * (Lanes(1) / distance));
  const LaneFloats distances(distance), cosines(cosine);
  for (std::size_t i = 0; i < kLanes; ++i)
    result.tfar[i] = shadowEnd(distances[i], cosines[i]);
}

} // namespace chamfer
