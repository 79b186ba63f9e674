// The scene as glTF: the same rules as tiles, since it is a function of the scene's content too.
#include "common/digest.h"
#include "server/http/queue/stage_timing.h"
#include "server/http/routes/preview_glb.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"
#include "server/http/schema/limits.h"
#include "server/http/version.h"

namespace chamfer::http {

Response previewRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                      const std::string& name) {
  const auto scene = readyScene(entry);
  if (name != scene->id.hex()) return redirectToId(request, *scene, "preview.glb");
  const std::string etag = '"' + digestOf(std::string(kVersion) + "|preview|" + scene->id.hex()).hex() + '"';
  Response response = taggedAnswer(request, etag, "model/gltf-binary", kForever);
  if (response.status == 304 || request.method == "HEAD") return response;

  // In a slot, since it takes as much memory as a small render.
  StageTiming timing(parts.metrics);
  const RenderQueue::Slot slot = parts.queue.acquire(request.client, request.cancelled);
  timing.lap(Stage::Queue);
  response.body = previewGlb(*scene, kMaxPreviewBytes);
  timing.lap(Stage::Encode);
  response.headers.emplace_back("Server-Timing", timing.text());
  return response;
}

} // namespace chamfer::http
