// Tiles and frames: queue, prepare, render, encode.
#include "common/text.h"
#include "server/http/monitoring/log.h"
#include "server/http/queue/render_pace.h"
#include "server/http/queue/stage_timing.h"
#include "server/http/routes/content_type.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"
#include "server/http/version.h"
#include "server/render/image/image_io.h"
#include "server/render/request/query.h"
#include "server/render/request/tile_request.h"

#include <cmath>

namespace chamfer::http {
namespace {

/// What follows the scene in the path, as sent.
std::string restOf(std::string_view word, std::span<const std::string_view> segments) {
  std::string rest(word);
  for (const std::string_view segment : segments)
    rest += '/' + std::string(segment);
  return rest;
}

std::string encoded(const Image& image, const TileRequest& wanted) {
  std::vector<std::byte> bytes;
  switch (wanted.format) {
  case ImageFormat::F16:
    bytes = encodeF16(image, wanted.samples());
    break;
  case ImageFormat::Exr:
    bytes = encodeExr(image);
    break;
  case ImageFormat::Png:
    bytes = encodePng(image);
    break;
  }
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Throws ProblemError (422) as soon as it is clear that the deadline cannot be met by far.
RenderResult renderedInTime(const Parts& parts, const Request& request, const PreparedScene& ready,
                            const TileRequest& wanted) {
  RenderPace pace(request.cancelled, looksOfRender(wanted.settings, wanted.tile));
  const RenderControl control{parts.options.threads, [&pace] { return pace.stop(); }, nullptr};
  try {
    return renderTile(ready, wanted.settings, wanted.tile, control);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::Cancelled || !pace.hopeless()) throw;
  }
  const std::uint64_t work = std::uint64_t{wanted.tile.width} * wanted.tile.height * wanted.samples();
  const auto most = static_cast<std::uint64_t>(pace.share() * static_cast<double>(work));
  const double seconds = std::chrono::duration<double>(parts.options.deadline).count();
  throw ProblemError({.status = 422,
                      .kind = errorWord(ErrorKind::OutOfRange),
                      .detail = "at the pace of its beginning this would take " +
                                exactNumberText(std::ceil(seconds / pace.share())) +
                                " seconds, and the server gives up after " + exactNumberText(seconds) +
                                "; ask for a smaller tile or fewer samples, about " + std::to_string(most) +
                                " pixels times samples in all",
                      .parameter = "samples",
                      .value = std::to_string(work),
                      .limits = "{\"maximum\":" + std::to_string(most) + "}"});
}

Response imageRoute(const Parts& parts, const Request& request, const std::shared_ptr<const Scene>& scene,
                    const TileRequest& wanted) {
  const std::string etag = '"' + answerDigest(kVersion, scene->id, wanted).hex() + '"';
  Response response = taggedAnswer(request, etag, contentTypeOf(wanted.format), kForever);
  if (response.status == 304 || request.method == "HEAD") return response; // known without rendering

  StageTiming timing(parts.metrics);
  const RenderQueue::Slot slot = parts.queue.acquire(request.client, request.cancelled);
  timing.lap(Stage::Queue);
  const auto ready = preparedFor(parts, scene, wanted.rounding, request.cancelled);
  timing.lap(Stage::Prepare);
  const RenderResult result = renderedInTime(parts, request, *ready, wanted);
  timing.lap(Stage::Render);
  response.body = encoded(result.image, wanted);
  timing.lap(Stage::Encode);

  const RayStatistics& rays = result.statistics;
  parts.metrics.traced(rays);
  response.headers.emplace_back("Server-Timing", timing.text());
  response.headers.emplace_back("X-Chamfer-Rays", std::to_string(rays.rays()));
  response.headers.emplace_back("X-Chamfer-Hits", std::to_string(rays.hits()));
  response.headers.emplace_back("X-Chamfer-Rounded", std::to_string(rays.roundedHits()));
  if (const std::size_t beyond = wanted.format == ImageFormat::F16 ? beyondHalf(result.image) : 0; beyond > 0)
    response.headers.emplace_back("X-Chamfer-Saturated", std::to_string(beyond));
  if (rays.nonFiniteSamples > 0) {
    response.headers.emplace_back("X-Chamfer-Non-Finite", std::to_string(rays.nonFiniteSamples));
    logMessage(LogLevel::Warning, "request " + request.id + ": " + std::to_string(rays.nonFiniteSamples) +
                                      " samples were not finite and count as black");
  }
  return response;
}

} // namespace

Response tileRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                   const std::string& scene, std::span<const std::string_view> segments) {
  const TileRequest wanted = parseTile(segments, request.query);
  const auto ready = readyScene(entry);
  if (scene != ready->id.hex()) return redirectToId(request, *ready, restOf("tiles", segments));
  return imageRoute(parts, request, ready, wanted);
}

Response frameRoute(const Parts& parts, const Request& request, const CatalogueEntry& entry,
                    const std::string& scene, std::span<const std::string_view> segments) {
  const TileRequest wanted = parseFrame(segments, request.query);
  const auto ready = readyScene(entry);
  if (scene != ready->id.hex()) return redirectToId(request, *ready, restOf("frames", segments));
  Response response = imageRoute(parts, request, ready, wanted);
  if (response.status == 200) {
    const std::string base = entry.name.substr(entry.name.rfind('/') + 1);
    response.headers.emplace_back("Content-Disposition", "attachment; filename*=UTF-8''" +
                                                             percentEncode(base, false) + '.' +
                                                             formatWord(wanted.format));
  }
  return response;
}

} // namespace chamfer::http
