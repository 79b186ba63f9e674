#include "server/http/schema/limits.h"

#include "server/render/request/parameters.h"

namespace chamfer::http {
namespace {

constexpr LimitRow kLimits[] = {
    {"tile_pixels", kMaxTilePixels, "of one tile"},
    {"frame_pixels", kMaxFramePixels, "of one frame"},
    {"request_samples", kMaxRequestSamples, "pixels times samples of one request"},
    {"rays", kMaxRays, "of one batch"},
    {"body_bytes", kMaxBodyBytes, "of a request's body"},
    {"head_bytes", kMaxHeadBytes, "of a request's head"},
    {"header_fields", kMaxHeaderFields, "of a request's head"},
    {"target_bytes", kMaxTargetBytes, "of a request's path and query"},
    {"suite_bytes", kMaxSuiteBytes, "of the suite of a job of comparisons"},
    {"cases", kMaxCases, "of one job of comparisons"},
    {"comparison_pixels", kMaxComparisonPixels, "compared by all cases of one job together"},
    {"comparison_samples", kMaxComparisonSamples,
     "pixels times samples times seeds of both sides, of all cases of one job together"},
    {"comparison_file_bytes", kMaxComparisonFileBytes, "of an image or a mask that a case names"},
    {"preview_bytes", kMaxPreviewBytes, "of a scene's preview.glb; larger ones are not made"},
};

} // namespace

std::span<const LimitRow> limitRows() { return kLimits; }

} // namespace chamfer::http
