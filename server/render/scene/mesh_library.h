// The meshes of one scene: each file read and built once, with the rounding that its entry asks for.
#pragma once

#include "server/render/scene/scene_description.h"
#include "server/render/scene/stretch.h"

#include <map>

namespace chamfer {

/// Where the rounding of a mesh file is looked for.
std::filesystem::path sidecarOf(const std::filesystem::path& mesh);

/// A mesh entry, loaded.
struct LoadedMesh {
  SceneMesh mesh;
  std::size_t roundedEdges = 0;
  Digest content; ///< of everything that determines the mesh's part in the pixels
};

class MeshLibrary {
public:
  /// `threads` 0: all cores.
  MeshLibrary(std::filesystem::path root, std::filesystem::path base, unsigned threads = 0)
      : root_(std::move(root)), base_(std::move(base)), threads_(threads) {}

  /// The rounding is decided by the files alone:
  ///  - `staysSharp`: none;
  ///  - with a radius: the sidecar's where it fits the mesh and was made as the description asks, else built
  ///    here (what is wrong with a sidecar becomes a warning), with the sidecar's options where the
  ///    description names none;
  ///  - without: the sidecar's, or none where there is no sidecar. Throws StaleSidecar, DamagedSidecar.
  /// A sidecar fits the mesh of the file or that with hulls (PreprocessResult::mesh); what is rounded as its
  /// hull is traced as its hull, too.
  /// `stretch`: of the instances that the mesh is for, where the description's radius is in world units. A
  /// uniform one changes the radius, any other the mesh: its copy has the stretch already.
  LoadedMesh load(const MeshDescription& description, std::vector<std::string>& warnings,
                  const Stretch& stretch = {});

private:
  struct Geometry {
    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const TracedMesh> traced;
    Digest geometry, content;
  };
  const Geometry& geometry(const std::filesystem::path& file);
  static Geometry geometryOf(std::shared_ptr<const TriangleMesh> mesh);
  /// Null where there is none. `its`: set to the geometry that it belongs to.
  std::shared_ptr<const Rounding> sidecar(const MeshDescription& description, const Geometry& geometry,
                                          const std::filesystem::path& mesh,
                                          std::vector<std::string>& warnings, const Geometry*& its);
  /// What a file's mesh becomes where components of it are rounded as their hulls (PreprocessResult::mesh).
  const Geometry& hulled(std::shared_ptr<const TriangleMesh> mesh);
  /// The same for a mesh, rounded with these options; null where there are none.
  const Geometry* withHulls(const Geometry& geometry, const RoundingOptions& options);

  std::filesystem::path root_, base_;
  unsigned threads_;
  std::map<std::filesystem::path, Geometry> geometries_;
  std::map<std::string, Geometry> hulled_; ///< by content
};

} // namespace chamfer
