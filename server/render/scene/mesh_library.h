// The meshes of one scene: each file read and built once, with the rounding that its entry asks for.
#pragma once

#include "server/render/scene/scene_description.h"

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
  ///  - with a radius: the sidecar's where it fits the mesh and every solid of it has that radius, else built
  ///  here (what
  ///    is wrong with a sidecar becomes a warning);
  /// A sidecar fits the mesh of the file or that with hulls (PreprocessResult::mesh); what is rounded as its
  /// hull is traced as its hull, too.
  ///  - without: the sidecar's, or none where there is no sidecar. Throws StaleSidecar, DamagedSidecar.
  LoadedMesh load(const MeshDescription& description, std::vector<std::string>& warnings);

private:
  struct Geometry {
    std::shared_ptr<const TriangleMesh> mesh;
    std::shared_ptr<const TracedMesh> traced;
    Digest geometry, content;
  };
  static Geometry makeGeometry(std::shared_ptr<const TriangleMesh> mesh);
  const Geometry& geometry(const std::filesystem::path& file);
  /// What a file's mesh becomes where components of it are rounded as their hulls (PreprocessResult::mesh).
  const Geometry& hulled(std::shared_ptr<const TriangleMesh> mesh);
  /// The same for a mesh; null where there are none.
  const Geometry* withHulls(const Geometry& geometry);

  std::filesystem::path root_, base_;
  unsigned threads_;
  std::map<std::filesystem::path, Geometry> geometries_;
  std::map<std::string, Geometry> hulled_; ///< by content
};

} // namespace chamfer
