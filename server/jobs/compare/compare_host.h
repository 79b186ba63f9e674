// What comparisons ask of the program around them: scenes, files, and rendering.
#pragma once

#include "server/jobs/suite/side.h"
#include "server/render/path/render.h"
#include "server/render/request/tile_request.h"

#include <filesystem>
#include <memory>
#include <string>

namespace chamfer {

class CompareHost {
public:
  virtual ~CompareHost() = default;
  /// The scene of a side that is rendered. Throws Error with the reason.
  virtual std::shared_ptr<const Scene> scene(const SideChoice& side) = 0;
  /// Where an image or a mask of that name lies. Throws Error where it may not be named.
  virtual std::filesystem::path file(const std::string& name) = 0;
  /// The mean of the request's samples over its tile. Error(Cancelled) soon after the work lost its purpose.
  virtual RenderResult render(const std::shared_ptr<const Scene>& scene, const TileRequest& request) = 0;
};

} // namespace chamfer
