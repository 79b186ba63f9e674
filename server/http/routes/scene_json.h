// Scenes as /v1/scenes describes them.
#pragma once

#include "server/http/catalogue/catalogue.h"

#include <string>

namespace chamfer::http {

/// One element of the list: name, id, state, triangles, rounded edges, bounds, radius, warnings. What is not
/// known (the scene is not ready) is null.
std::string sceneSummaryJson(const CatalogueEntry& entry, const std::string& root);
/// The same with meshes, materials, camera and load report. The entry must be ready.
std::string sceneDetailJson(const CatalogueEntry& entry, const std::string& root);

struct RadiusRange {
  double current = 0; ///< the largest of the scene's roundings; 0: it has none
  double max =
      0; ///< below this every rounded mesh of the scene can be rendered; 0: unknown, or none is rounded
};
RadiusRange radiusRange(const Scene& scene);

} // namespace chamfer::http
