// Everything of a scene's objects that emits, as triangles to aim at.
//
// A sharp emitter is its triangles, radiating from both sides; where they close a volume they are aimed at
// from its outside alone. A rounded one lies inside its mesh's solid P: it is aimed at through P's triangles
// that face the receiving point. A point outside of P sees the convex P through exactly one of them, so the
// density of a direction is known without knowing where R is met; rays that miss R between P's surface and
// its rounding find nothing. Points inside P are not aimed at from (what they see is found by scattered
// rays).
#pragma once

#include "server/render/surface/surface.h"

#include <optional>
#include <unordered_map>
#include <vector>

namespace chamfer {

struct EmissiveTriangle {
  Point3 corner;        ///< world
  Vector3 edge1, edge2; ///< to the other corners
  Color emission;       ///< radiance
  std::uint32_t instance = kNone, triangle = kNone;
  std::uint32_t solid = kNone; ///< kNone: sharp
  bool oneSided =
      false; ///< aimed at only from where cross(edge1, edge2) points: the other side is its own inside
};

class Emitters {
public:
  Emitters() = default;
  /// `instances` in the order of the scene's data; their roundings must outlive this. Triangles of several
  /// materials are left to scattered rays.
  Emitters(const Surfaces& surfaces, const std::vector<TracedInstance>& instances);
  /// Sharp triangles in world coordinates alone, in ascending order of (instance, triangle).
  explicit Emitters(std::vector<EmissiveTriangle> triangles) : triangles_(std::move(triangles)) {}

  const std::vector<EmissiveTriangle>& triangles() const { return triangles_; }
  /// Index in triangles() of a mesh's triangle; kNone where it does not emit.
  std::uint32_t find(std::uint32_t instance, std::uint32_t triangle) const;

  /// Where a ray from outside enters the unrounded solid of a rounded emitter.
  struct Entry {
    double t;      ///< in units of the direction's length
    double cosine; ///< between ray and facet, above 0
  };
  /// Nothing when the ray starts inside or misses, or the solid is not aimed at.
  std::optional<Entry> entry(std::uint32_t instance, std::uint32_t solid, const Ray& ray) const;
  /// A ball, in world coordinates, that holds a rounded emitter's solid.
  struct Ball {
    Point3 centre;
    double radius;
  };
  Ball ball(std::uint32_t instance, std::uint32_t solid) const;
  std::size_t memoryBytes() const { return triangles_.size() * sizeof(EmissiveTriangle); }

private:
  struct RoundedEmitter {
    const RoundingView* view;
    Transform worldFromObject, objectFromWorld;
    std::vector<bool>
        aimedAt; ///< by solid: those of one emission all over, whose triangles lie in P's facets
  };
  void addInstance(const Surfaces& surfaces, const TracedInstance& instance, std::uint32_t index);
  std::vector<EmissiveTriangle> triangles_;
  std::unordered_map<std::uint32_t, RoundedEmitter> rounded_; ///< by instance
};

} // namespace chamfer
