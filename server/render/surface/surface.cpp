#include "server/render/surface/surface.h"

#include "server/render/surface/bevel.h"
#include "server/render/surface/tangent_frame.h"

namespace chamfer {

Surfaces::Surfaces(std::shared_ptr<const Scene> scene, std::vector<MeshForm> forms, unsigned probes)
    : scene_(std::move(scene)), forms_(std::move(forms)), fillings_(forms_.size()), probes_(probes) {
  const SceneData& data = *scene_->data;
  for (std::size_t m = 0; m < forms_.size(); ++m) {
    const MeshMaterials& own = data.meshMaterials[m];
    if (!own.transmits || !forms_[m].rounding) continue;
    const RoundingView& view = forms_[m].rounding->view();
    fillings_[m].assign(view.solidCount(), kNone);
    for (std::uint32_t t = 0; t < own.ofTriangle.size(); ++t) {
      const std::uint32_t facet = view.facetOfTriangle[t];
      if (facet == kNone || !(data.materials[own.ofTriangle[t]].transmission > 0)) continue;
      std::uint32_t& first = fillings_[m][view.facets[facet].solid];
      if (first == kNone) first = t;
    }
  }
}

const MeshForm* Surfaces::form(std::uint32_t instance) const {
  const std::uint32_t mesh = source(instance).mesh;
  return mesh < forms_.size() ? &forms_[mesh] : nullptr;
}

const TriangleMesh& Surfaces::tracedMesh(std::uint32_t mesh) const {
  const std::size_t own = forms_.size();
  if (mesh >= own) return *scene_->data->extraMeshes[mesh - own].mesh;
  return forms_[mesh].explicitMesh ? forms_[mesh].explicitMesh->mesh() : *scene_->meshes[mesh].mesh;
}

bool Surfaces::transmits(const InstanceSource& s) const {
  const SceneData& data = *scene_->data;
  if (s.material != kNone) return data.materials[s.material].transmission > 0;
  const auto& own = data.meshMaterials[s.mesh];
  return own.ofTriangle.empty() ? data.materials[SceneData::kDefaultMaterial].transmission > 0
                                : own.transmits;
}

std::vector<TracedInstance> Surfaces::ownInstances() const {
  std::vector<TracedInstance> own = scene_->instances;
  for (std::uint32_t i = 0; i < own.size(); ++i) {
    const MeshForm& f = *form(i);
    own[i].rounding = f.mode == RoundingMode::Analytic ? f.rounding : nullptr;
    if (f.explicitMesh) own[i].mesh = f.explicitMesh->traced();
    own[i].transmits = transmits(source(i));
  }
  return own;
}

const Material& Surfaces::material(const InstanceSource& source, std::uint32_t originalTriangle) const {
  const SceneData& data = *scene_->data;
  if (source.material != kNone) return data.materials[source.material];
  const std::vector<std::uint32_t>& own = data.meshMaterials[source.mesh].ofTriangle;
  return data.materials[own.empty() ? SceneData::kDefaultMaterial : own[originalTriangle]];
}

const Material& Surfaces::material(std::uint32_t instance, std::uint32_t triangle) const {
  const MeshForm* f = form(instance);
  return material(source(instance), f && f->explicitMesh ? f->explicitMesh->source(triangle) : triangle);
}

const Material& Surfaces::filling(std::uint32_t instance, std::uint32_t triangle) const {
  const InstanceSource& s = source(instance);
  if (s.material != kNone || s.mesh >= fillings_.size() || fillings_[s.mesh].empty())
    return material(instance, triangle);
  const MeshForm& f = forms_[s.mesh];
  const std::uint32_t original = f.explicitMesh ? f.explicitMesh->source(triangle) : triangle;
  const RoundingView& view = f.rounding->view();
  const std::uint32_t facet = view.facetOfTriangle[original];
  const std::uint32_t first = facet == kNone ? kNone : fillings_[s.mesh][view.facets[facet].solid];
  return material(s, first == kNone ? original : first);
}

const Material* Surfaces::materialOfAll(std::uint32_t instance, std::uint32_t triangle) const {
  const InstanceSource& s = source(instance);
  const MeshForm* f = form(instance);
  if (!f || !f->explicitMesh) return &material(s, triangle);
  const std::uint32_t from = f->explicitMesh->source(triangle),
                      facet = f->rounding->view().facetOfTriangle[from];
  if (s.material == kNone && f->original && facet != kNone) {
    const bool flat = f->explicitMesh->feature(triangle) == Feature::Flat;
    if (flat ? f->original->severalMaterialsOnFacet(facet)
             : f->original->severalMaterialsOnSolid(f->rounding->view().facets[facet].solid))
      return nullptr;
  }
  return &material(s, from);
}

bool Surfaces::variesOver(const MeshForm& f, const InstanceSource& s, std::uint32_t solid,
                          const Material& there) const {
  return there.hasTexture() || (s.material == kNone && f.original->severalMaterialsOnSolid(solid));
}

MeshPlace Surfaces::originalPlace(const MeshForm& f, const TraceHit& hit, std::uint32_t facet,
                                  Feature feature) const {
  const Transform& worldFromObject = scene_->instances[hit.instance].worldFromObject;
  const Point3 p = worldFromObject.applyInverse(hit.position);
  if (feature == Feature::Flat) return f.original->placeOnFacet(facet, p);
  const Vector3 normal = f.explicitMesh ? f.explicitMesh->normal({hit.triangle, hit.u, hit.v})
                                        : normalize(Vector3(worldFromObject.inverse()(Normal3(hit.normal))));
  return f.original->placeOfRounding(f.rounding->view().facets[facet].solid, p, normal);
}

SurfacePlace Surfaces::place(const TraceHit& hit) const {
  const MeshForm* f = form(hit.instance);
  const InstanceSource& s = source(hit.instance);
  SurfacePlace p{{hit.triangle, hit.u, hit.v}, hit.feature, nullptr};
  if (f && f->explicitMesh) {
    p.feature = f->explicitMesh->feature(hit.triangle);
    p.original.triangle = f->explicitMesh->source(hit.triangle);
  }
  p.material = &material(s, p.original.triangle);
  // An exact flat is met on its own triangle.
  if (!f || !f->original || (!f->explicitMesh && p.feature == Feature::Flat)) return p;
  const RoundingView& view = f->rounding->view();
  const std::uint32_t facet = view.facetOfTriangle[p.original.triangle];
  if (facet == kNone || !variesOver(*f, s, view.facets[facet].solid, *p.material)) return p;
  p.original = originalPlace(*f, hit, facet, p.feature);
  p.material = &material(s, p.original.triangle);
  return p;
}

ShadingNormal Surfaces::shadingNormal(const TraceHit& hit, const SurfacePlace& place, const Sampler& sampler,
                                      unsigned bounce) const {
  ShadingNormal n{hit.normal, hit.normal};
  const MeshForm* f = form(hit.instance);
  if (!f) return n;
  if (f->explicitMesh) {
    const Transform& world = scene_->instances[hit.instance].worldFromObject;
    n.smooth = normalize(Vector3(world(Normal3(f->explicitMesh->normal({hit.triangle, hit.u, hit.v})))));
    n.normal = n.smooth;
  } else if (f->mode == RoundingMode::Bevel) {
    const TracedInstance& instance = scene_->instances[hit.instance];
    const Transform objectFromWorld = instance.worldFromObject.inverse();
    const Vector3 flat = normalize(Vector3(objectFromWorld(Normal3(hit.normal))));
    const Vector3 bent = bevelNormal(
        {*instance.mesh, tracedMesh(source(hit.instance).mesh), f->rounding->view()}, hit.triangle,
        objectFromWorld(hit.position), flat, probes_, sampler, kFirstBevelPair + bounce * kMostBevelProbes);
    if (!(bent == flat)) n.normal = normalize(Vector3(instance.worldFromObject(Normal3(bent))));
  }
  if (place.material->normalTexture != kNoTexture) n.normal = textureNormal(hit, place, n.normal);
  return n;
}

bool Surfaces::textureCoordinates(const TraceHit& hit, const SurfacePlace& place, Float2& uv) const {
  const std::uint32_t index = source(hit.instance).mesh;
  if (index >= scene_->meshes.size()) return false; // a studio's own objects have no textures
  const TriangleMesh& mesh = *scene_->meshes[index].mesh;
  const auto there = uvAt(mesh, place.original);
  if (there) uv = {(*there)[0], (*there)[1]};
  return there.has_value();
}

SurfaceValues Surfaces::values(const TraceHit& hit, const SurfacePlace& place) const {
  const Material& m = *place.material;
  SurfaceValues s{m.baseColor, m.roughness, m.metallic, m.specular, m.transmission, m.ior};
  if (m.baseColorTexture == kNoTexture && m.roughnessTexture == kNoTexture) return s;
  Float2 uv;
  if (!textureCoordinates(hit, place, uv)) return s;
  const std::vector<Texture>& textures = scene_->data->textures;
  if (m.baseColorTexture != kNoTexture) {
    const Color c = textures[m.baseColorTexture].at(uv.x, uv.y);
    const auto unit = [](float v) { return std::clamp(v, 0.f, 1.f); };
    s.baseColor *= Color{unit(c.r), unit(c.g), unit(c.b)};
  }
  if (m.roughnessTexture != kNoTexture)
    s.roughness *= std::clamp(textures[m.roughnessTexture].at(uv.x, uv.y).g, 0.f, 1.f);
  return s;
}

Vector3 Surfaces::textureNormal(const TraceHit& hit, const SurfacePlace& place, const Vector3& normal) const {
  Float2 uv;
  if (!textureCoordinates(hit, place, uv)) return normal;
  const TriangleMesh& mesh = *scene_->meshes[source(hit.instance).mesh].mesh;
  const auto frame =
      tangentFrame(mesh, place.original.triangle, normal, scene_->instances[hit.instance].worldFromObject);
  if (!frame) return normal;
  const Texture& texture = scene_->data->textures[place.material->normalTexture];
  // Where the placement mirrors the image, its normals lean the other way.
  const auto& scale = texture.placement().scale;
  const double strength = place.material->normalStrength;
  return frame->turned(texture.at(uv.x, uv.y),
                       {scale[0] < 0 ? -strength : strength, scale[1] < 0 ? -strength : strength});
}

std::size_t Surfaces::memoryBytes() const {
  std::size_t bytes = 0;
  for (const MeshForm& f : forms_)
    bytes +=
        (f.explicitMesh ? f.explicitMesh->memoryBytes() : 0) + (f.original ? f.original->memoryBytes() : 0);
  return bytes;
}

} // namespace chamfer
