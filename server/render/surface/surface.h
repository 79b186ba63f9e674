// What a hit is made of and how shading sees it: the one place that knows which rounding was chosen. The
// exact rounding's hits carry their normal; a mesh's normals are interpolated, a bevel's are probed, and a
// normal texture turns what comes out of that.
#pragma once

#include "server/render/material/bsdf.h"
#include "server/render/path/render.h"
#include "server/render/path/sampler.h"
#include "server/render/scene/scene_data.h"
#include "server/render/surface/rounded_mesh.h"

namespace chamfer {

/// A mesh of the scene as the chosen rounding has it traced.
struct MeshForm {
  RoundingMode mode = RoundingMode::None;
  std::shared_ptr<const Rounding> rounding;        ///< null: it stays sharp, and the mode is None
  std::shared_ptr<const RoundedMesh> explicitMesh; ///< of the mode Mesh: traced in the mesh's place
  /// Of a rounded form, exact or explicit, where material or texture depend on the place; else null.
  std::shared_ptr<const OriginalSurface> original;
};

/// A hit's place on the original mesh, with the original surface's material.
struct SurfacePlace {
  MeshPlace original;
  Feature feature;
  const Material* material;
  bool rounded() const { return feature != Feature::Flat; }
};

/// World, unit, outward.
struct ShadingNormal {
  Vector3 smooth; ///< of the surface that the geometry stands for
  Vector3 normal; ///< for shading: `smooth`, turned by a bevel or a normal texture
};

/// Sampler pairs from here on belong to bevel probes: kMostBevelProbes a bounce, none of a path's own.
inline constexpr std::uint32_t kFirstBevelPair = 1u << 16, kMostBevelProbes = 256;

class Surfaces {
public:
  /// `forms` by mesh of the scene; `probes`: of each bevelled hit, 1 to kMostBevelProbes.
  Surfaces(std::shared_ptr<const Scene> scene, std::vector<MeshForm> forms, unsigned probes);

  SurfacePlace place(const TraceHit& hit) const;
  /// Is the shading normal the hit's own?
  bool hasOwnNormal(const TraceHit& hit, const SurfacePlace& place) const {
    const MeshForm* f = form(hit.instance);
    return place.material->normalTexture == kNoTexture &&
           (!f || (!f->explicitMesh && f->mode != RoundingMode::Bevel));
  }
  /// `bounce`: which of the path's hits this is, for the probes' random numbers.
  ShadingNormal shadingNormal(const TraceHit& hit, const SurfacePlace& place, const Sampler& sampler,
                              unsigned bounce) const;
  /// The material's values with its textures looked up.
  SurfaceValues values(const TraceHit& hit, const SurfacePlace& place) const;

  const Scene& scene() const { return *scene_; }
  /// The mesh that rays meet, of one in the scene's order, extra meshes last.
  const TriangleMesh& tracedMesh(std::uint32_t mesh) const;
  /// All instances as they are traced: the scene's own, without a studio's.
  std::vector<TracedInstance> ownInstances() const;
  /// The material of a traced triangle, of the original surface's triangle that it stands for.
  const Material& material(std::uint32_t instance, std::uint32_t triangle) const;
  /// What fills the solid that a traced triangle belongs to: of a rounded solid that several materials lie
  /// on, the first of the mesh's triangles that light goes through has its say, wherever a path came in.
  const Material& filling(std::uint32_t instance, std::uint32_t triangle) const;
  /// As material(); null where it has several.
  const Material* materialOfAll(std::uint32_t instance, std::uint32_t triangle) const;
  std::size_t memoryBytes() const; ///< of explicit meshes, without hierarchies

private:
  const InstanceSource& source(std::uint32_t instance) const {
    return scene_->data->instanceSource[instance];
  }
  /// Does light go through any of its triangles?
  bool transmits(const InstanceSource& source) const;
  /// Null for a studio's own objects.
  const MeshForm* form(std::uint32_t instance) const;
  /// Has the solid more than one material, or a texture, so that the place on it matters?
  bool variesOver(const MeshForm& form, const InstanceSource& source, std::uint32_t solid,
                  const Material& there) const;
  MeshPlace originalPlace(const MeshForm& form, const TraceHit& hit, std::uint32_t facet,
                          Feature feature) const;
  const Material& material(const InstanceSource& source, std::uint32_t originalTriangle) const;
  bool textureCoordinates(const TraceHit& hit, const SurfacePlace& place, Float2& uv) const;
  Vector3 textureNormal(const TraceHit& hit, const SurfacePlace& place, const Vector3& normal) const;

  std::shared_ptr<const Scene> scene_;
  std::vector<MeshForm> forms_;
  /// By mesh and solid, the triangle that has its say; empty: the mesh has one material, or no light goes
  /// through.
  std::vector<std::vector<std::uint32_t>> fillings_;
  unsigned probes_;
};

} // namespace chamfer
