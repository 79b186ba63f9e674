#include "server/render/scene/mesh_library.h"

#include "common/error.h"
#include "preprocess/core/inradius.h"
#include "server/render/scene/scene_files.h"

namespace chamfer {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string hexOf(std::span<const T> span) {
  return digestOf(std::as_bytes(span)).hex();
}

/// Of all that a rounding holds: the same whether it came from a sidecar or was built here.
std::string digestText(const RoundingView& v) {
  return hexOf(v.solids) + hexOf(v.facets) + hexOf(v.spheres) + hexOf(v.packed) + hexOf(v.wide) +
         hexOf(v.treeRoots) + hexOf(v.treeNodes) + hexOf(v.facetOfTriangle);
}

/// Positions, triangles, texture coordinates, materials.
Digest contentDigest(const TriangleMesh& m, const Digest& geometry) {
  std::string text = geometry.hex() + hexOf(std::span<const std::array<float, 2>>(m.uvs)) +
                     hexOf(std::span<const std::array<std::uint32_t, 3>>(m.uvTriangles)) +
                     hexOf(std::span<const std::uint32_t>(m.materialOfTriangle));
  for (const MeshMaterial& a : m.materials) {
    const double numbers[] = {a.baseColor[0], a.baseColor[1], a.baseColor[2], a.roughness,   a.metallic,
                              a.transmission, a.ior,          a.emission[0],  a.emission[1], a.emission[2]};
    text += hexOf(std::span<const double>(numbers));
    for (const MeshTexture* t : {&a.baseColorTexture, &a.roughnessTexture, &a.normalTexture}) {
      const double placement[] = {t->scale[0],  t->scale[1],      t->offset[0],
                                  t->offset[1], double(t->clamp), t->strength};
      text += hexOf(std::span<const double>(placement)) + t->file + '\n';
    }
  }
  return digestOf(text);
}

bool hasRadius(const RoundingView& view, double radius) {
  for (std::size_t i = 0; i < view.solidCount(); ++i)
    if (view.solids[i].radius != float(radius)) return false;
  return view.solidCount() > 0;
}

/// Was a sidecar made as the description asks? By its options, or by another spelling of them: "2%" of a lone
/// solid, say.
bool fits(const Rounding& sidecar, const MeshDescription& d, const Radius& radius) {
  const RoundingOptions& made = sidecar.options();
  if (d.onNonConvex && *d.onNonConvex != made.onNonConvex) return false;
  if (d.radiusClamp && *d.radiusClamp != made.clamp) return false;
  if (radius.relative == made.relative && radius.value == made.radius) return true;
  return !radius.relative && hasRadius(sidecar.view(), radius.value);
}

PreprocessResult round(const SceneMesh& mesh, const Radius& radius, unsigned threads) {
  PreprocessOptions options = optionsOf(mesh.options);
  options.radius = radius;
  options.threads = threads;
  return preprocess(*mesh.mesh, options);
}

/// The radius that a rounding's solids must stay below: the smallest inradius, or with a clamp, which takes
/// smaller ones out, the largest.
double largestRadius(const Rounding& rounding) {
  const RoundingView& view = rounding.view();
  const bool clamped = rounding.options().clamp > 0;
  double bound = clamped ? 0 : INFINITY;
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < view.solidCount(); ++i) {
    planes.clear();
    for (std::uint32_t f = view.solids[i].firstFacet; f < view.solids[i + 1].firstFacet; ++f)
      planes.push_back({Vector3(view.facets[f].normal), double(view.facets[f].offset)});
    const double inradius = largestBall(planes, view.solids[i].boundRadius).radius;
    bound = clamped ? std::max(bound, inradius) : std::min(bound, inradius);
  }
  return std::isfinite(bound) ? bound : 0;
}

/// The same of a mesh that has no rounding yet; 0 when it cannot be rounded at all.
double largestRadius(const SceneMesh& mesh, unsigned threads) {
  if (mesh.rounding) return largestRadius(*mesh.rounding);
  try {
    return round(mesh, {1e-6, true}, threads).report.maxRadius; // a radius small enough for any solid
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::NotConvexSolid && e.kind() != ErrorKind::RadiusTooLarge) throw;
    return 0;
  }
}

/// A copy whose positions are stretched: what a rounding must see that is to be round after a scale that is
/// not the same in all directions.
std::shared_ptr<const TriangleMesh> stretched(const TriangleMesh& mesh, const Stretch& stretch) {
  auto copy = std::make_shared<TriangleMesh>(mesh);
  const Transform t = stretch.transform();
  for (Point3& p : copy->positions)
    p = t(p);
  return copy;
}

std::string optionsText(const RoundingOptions& o) {
  const double numbers[] = {o.weld, o.planarity, o.convexity, o.clamp, double(o.onNonConvex)};
  return hexOf(std::span<const double>(numbers));
}

} // namespace

fs::path sidecarOf(const fs::path& mesh) { return fs::path(mesh.string() + ".chamfer"); }

MeshLibrary::Geometry MeshLibrary::geometryOf(std::shared_ptr<const TriangleMesh> mesh) {
  Geometry g;
  g.geometry = geometryDigest(*mesh);
  g.content = contentDigest(*mesh, g.geometry);
  g.traced = makeTracedMesh(mesh);
  g.mesh = std::move(mesh);
  return g;
}

const MeshLibrary::Geometry& MeshLibrary::geometry(const fs::path& file) {
  const auto [entry, added] = geometries_.try_emplace(file);
  if (added) entry->second = geometryOf(std::make_shared<TriangleMesh>(readMesh(file, root_)));
  return entry->second;
}

const MeshLibrary::Geometry& MeshLibrary::hulled(std::shared_ptr<const TriangleMesh> mesh) {
  const auto [entry, added] = hulled_.try_emplace(contentDigest(*mesh, geometryDigest(*mesh)).hex());
  if (added) entry->second = geometryOf(std::move(mesh));
  return entry->second;
}

const MeshLibrary::Geometry* MeshLibrary::withHulls(const Geometry& geometry,
                                                    const RoundingOptions& options) {
  SceneMesh mesh;
  mesh.mesh = geometry.mesh;
  mesh.options = options; // decide which components are convex as they are
  try {
    const PreprocessResult result = round(mesh, {1e-6, true}, threads_);
    return result.mesh ? &hulled(result.mesh) : nullptr;
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::NotConvexSolid && e.kind() != ErrorKind::RadiusTooLarge) throw;
    return nullptr;
  }
}

std::shared_ptr<const Rounding> MeshLibrary::sidecar(const MeshDescription& d, const Geometry& g,
                                                     const fs::path& mesh, std::vector<std::string>& warnings,
                                                     const Geometry*& its) {
  const fs::path file = sidecarOf(mesh);
  std::error_code error;
  if (d.staysSharp || !fs::is_regular_file(file, error)) return nullptr;
  resolveBelow(root_, file.parent_path(), file.filename().string()); // no link leads out
  try {
    auto rounding = loadSidecar(file);
    its = &g;
    if (rounding->meshDigest() != g.geometry) {
      its = withHulls(g, rounding->options());
      if (!its || rounding->meshDigest() != its->geometry)
        rounding = loadSidecar(file, &g.geometry); // says that it is stale
    }
    if (rounding->view().facetOfTriangle.size() != its->mesh->triangles.size())
      throw Error(ErrorKind::DamagedSidecar, "the sidecar is damaged: it does not have the mesh's number of "
                                             "triangles; run chamferprep on the mesh again");
    return rounding;
  } catch (const Error& e) {
    if (!d.radius) throw;
    warnings.push_back((d.path.empty() ? "" : d.path + ": ") +
                       "the sidecar is not used, the mesh was rounded on load: " + e.what());
    return nullptr;
  }
}

LoadedMesh MeshLibrary::load(const MeshDescription& d, std::vector<std::string>& warnings,
                             const Stretch& stretch) {
  const std::string where = d.path.empty() ? "" : d.path + ": ";
  LoadedMesh loaded;
  SceneMesh& m = loaded.mesh;
  m.name = d.name;
  m.file = resolveBelow(root_, base_, d.file);
  const bool unit = stretch == Stretch();
  const Geometry& original = geometry(m.file);
  Geometry ofStretch;
  if (!stretch.isUniform()) ofStretch = geometryOf(stretched(*original.mesh, stretch));
  const Geometry& written = stretch.isUniform() ? original : ofStretch;
  const Geometry* g = &written;
  m.mesh = g->mesh;
  m.staysSharp = d.staysSharp;
  if (stretch.isUniform()) m.radiusUnit = stretch.scale();
  if (!unit) m.name += " (scaled " + stretch.text() + ")";
  for (const std::string& w : g->mesh->warnings)
    warnings.push_back(where + w);

  // A stretched mesh has no sidecar, but is to be rounded as its file's says.
  const Geometry* its = nullptr;
  m.rounding = sidecar(d, original, m.file, warnings, its);
  if (m.rounding) m.options = m.rounding->options();
  if (d.onNonConvex) m.options.onNonConvex = *d.onNonConvex;
  if (d.radiusClamp) m.options.clamp = *d.radiusClamp;
  std::optional<Radius> radius = d.radius;
  if (radius && d.worldRadius) radius->value /= m.radiusUnit;
  if (m.rounding && (!stretch.isUniform() || (radius && !fits(*m.rounding, d, *radius))))
    m.rounding = nullptr; // made for another radius
  if (m.rounding) g = its;
  if (radius && !m.rounding) {
    PreprocessResult result = round(m, *radius, threads_);
    m.rounding = std::move(result.rounding);
    if (result.mesh) g = &hulled(result.mesh);
    for (const std::string& w : result.report.warnings)
      if (std::find(written.mesh->warnings.begin(), written.mesh->warnings.end(), w) ==
          written.mesh->warnings.end())
        warnings.push_back(where + w);
  }
  m.mesh = g->mesh;
  m.traced = g->traced;
  if (m.rounding) m.options = m.rounding->options();
  if (!d.staysSharp && (m.rounding || d.path.empty()))
    m.maxRadius = largestRadius(m, threads_) * m.radiusUnit;
  if (!m.rounding && !d.path.empty()) m.staysSharp = true; // a scene file's mesh without radius and sidecar

  std::string content = g->content.hex() + (m.staysSharp ? "sharp" : "") + optionsText(m.options);
  if (m.rounding) {
    const RoundingView& view = m.rounding->view();
    content += digestText(view);
    for (std::size_t i = 0; i < view.solidCount(); ++i) {
      m.radius = std::max(m.radius, double(view.solids[i].radius) * m.radiusUnit);
      loaded.roundedEdges += view.solids[i].halfEdgeCount / 2;
    }
  }
  loaded.content = digestOf(content);
  return loaded;
}

} // namespace chamfer
