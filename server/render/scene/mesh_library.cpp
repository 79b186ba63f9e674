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
    text += hexOf(std::span<const double>(numbers)) + a.baseColorTexture + '\n' + a.roughnessTexture + '\n' +
            a.normalTexture + '\n';
  }
  return digestOf(text);
}

bool hasRadius(const RoundingView& view, double radius) {
  for (std::size_t i = 0; i < view.solidCount(); ++i)
    if (view.solids[i].radius != float(radius)) return false;
  return view.solidCount() > 0;
}

PreprocessResult round(const SceneMesh& mesh, const Radius& radius, unsigned threads) {
  PreprocessOptions options;
  options.radius = radius;
  options.onNonConvex = mesh.onNonConvex;
  options.threads = threads;
  return preprocess(*mesh.mesh, options);
}

/// Of the solids of a rounding, from their facets alone.
double smallestInradius(const RoundingView& view) {
  double smallest = INFINITY;
  std::vector<Plane> planes;
  for (std::size_t i = 0; i < view.solidCount(); ++i) {
    planes.clear();
    for (std::uint32_t f = view.solids[i].firstFacet; f < view.solids[i + 1].firstFacet; ++f)
      planes.push_back({Vector3(view.facets[f].normal), double(view.facets[f].offset)});
    smallest = std::min(smallest, largestBall(planes, view.solids[i].boundRadius).radius);
  }
  return std::isfinite(smallest) ? smallest : 0;
}

/// The largest radius that the mesh admits; 0 when it cannot be rounded at all.
double largestRadius(const SceneMesh& mesh, unsigned threads) {
  if (mesh.rounding) return smallestInradius(mesh.rounding->view());
  try {
    return round(mesh, {1e-6, true}, threads).report.maxRadius; // a radius small enough for any solid
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::NotConvexSolid && e.kind() != ErrorKind::RadiusTooLarge) throw;
    return 0;
  }
}

} // namespace

fs::path sidecarOf(const fs::path& mesh) { return fs::path(mesh.string() + ".chamfer"); }

MeshLibrary::Geometry MeshLibrary::makeGeometry(std::shared_ptr<const TriangleMesh> mesh) {
  Geometry g;
  g.geometry = geometryDigest(*mesh);
  g.content = contentDigest(*mesh, g.geometry);
  g.traced = makeTracedMesh(mesh);
  g.mesh = std::move(mesh);
  return g;
}

const MeshLibrary::Geometry& MeshLibrary::geometry(const fs::path& file) {
  const auto [entry, added] = geometries_.try_emplace(file);
  if (added) entry->second = makeGeometry(std::make_shared<TriangleMesh>(readMesh(file)));
  return entry->second;
}

const MeshLibrary::Geometry& MeshLibrary::hulled(std::shared_ptr<const TriangleMesh> mesh) {
  const auto [entry, added] = hulled_.try_emplace(contentDigest(*mesh, geometryDigest(*mesh)).hex());
  if (added) entry->second = makeGeometry(std::move(mesh));
  return entry->second;
}

const MeshLibrary::Geometry* MeshLibrary::withHulls(const Geometry& geometry) {
  SceneMesh mesh;
  mesh.mesh = geometry.mesh;
  mesh.onNonConvex = OnNonConvex::Hull;
  try {
    const PreprocessResult result = round(mesh, {1e-6, true}, threads_);
    return result.mesh ? &hulled(result.mesh) : nullptr;
  } catch (const Error& e) {
    if (e.kind() != ErrorKind::NotConvexSolid && e.kind() != ErrorKind::RadiusTooLarge) throw;
    return nullptr;
  }
}

LoadedMesh MeshLibrary::load(const MeshDescription& d, std::vector<std::string>& warnings) {
  const std::string where = d.path.empty() ? "" : d.path + ": ";
  LoadedMesh loaded;
  SceneMesh& m = loaded.mesh;
  m.name = d.name;
  m.file = resolveBelow(root_, base_, d.file);
  const Geometry* g = &geometry(m.file);
  m.mesh = g->mesh;
  m.staysSharp = d.staysSharp;
  m.onNonConvex = d.onNonConvex;
  for (const std::string& w : g->mesh->warnings)
    warnings.push_back(where + w);

  const fs::path sidecar = sidecarOf(m.file);
  std::error_code error;
  const bool hasSidecar = !d.staysSharp && fs::is_regular_file(sidecar, error);
  if (hasSidecar)
    resolveBelow(root_, sidecar.parent_path(), sidecar.filename().string()); // no link leads out
  if (hasSidecar) {
    try {
      m.rounding = loadSidecar(sidecar);
      if (m.rounding->meshDigest() != g->geometry) {
        const Geometry* hulls = withHulls(*g);
        if (hulls && m.rounding->meshDigest() == hulls->geometry)
          g = hulls;
        else
          m.rounding = loadSidecar(sidecar, &g->geometry); // says that it is stale
      }
      if (m.rounding->view().facetOfTriangle.size() != g->mesh->triangles.size())
        throw Error(ErrorKind::DamagedSidecar,
                    "the sidecar is damaged: it does not have the mesh's number of "
                    "triangles; run chamferprep on the mesh again");
    } catch (const Error& e) {
      if (!d.radius) throw;
      m.rounding = nullptr;
      warnings.push_back(where + "the sidecar is not used, the mesh was rounded on load: " + e.what());
    }
    if (m.rounding && d.radius && (d.radius->relative || !hasRadius(m.rounding->view(), d.radius->value)))
      m.rounding = nullptr; // made for another radius
    if (m.rounding && !d.radius) {
      // The sidecar's maker has accepted this mesh somehow: another radius must not be stricter.
      const auto& facets = m.rounding->view().facetOfTriangle;
      const bool anySharp = std::find(facets.begin(), facets.end(), kNone) != facets.end();
      m.onNonConvex = anySharp ? OnNonConvex::Sharp : OnNonConvex::Hull;
    }
  }
  if (d.radius && !m.rounding) {
    PreprocessResult result = round(m, *d.radius, threads_);
    m.rounding = std::move(result.rounding);
    m.maxRadius = result.report.maxRadius;
    g = result.mesh ? &hulled(result.mesh) : &geometry(m.file);
    for (const std::string& w : result.report.warnings)
      warnings.push_back(where + w);
  } else if (!d.staysSharp && (m.rounding || d.path.empty())) {
    m.maxRadius = largestRadius(m, threads_);
  }
  if (!m.rounding && !d.path.empty()) m.staysSharp = true; // a scene file's mesh without radius and sidecar

  m.mesh = g->mesh;
  m.traced = g->traced;
  std::string content = g->content.hex() + (m.staysSharp ? "sharp" : "") + std::to_string(int(m.onNonConvex));
  if (m.rounding) {
    const RoundingView& view = m.rounding->view();
    content += digestText(view);
    for (std::size_t i = 0; i < view.solidCount(); ++i) {
      m.radius = std::max(m.radius, double(view.solids[i].radius));
      loaded.roundedEdges += view.solids[i].halfEdgeCount / 2;
    }
  }
  loaded.content = digestOf(content);
  return loaded;
}

} // namespace chamfer
