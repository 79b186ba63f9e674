// A path tracer of the simplest kind, to judge the real one by: independent random numbers, every light found
// by chance, no roulette. It shares the scene, the tracer and the BSDFs with the one under test, and neither
// its light sampling, its weights nor its sampler.
#pragma once

#include "server/render/path/prepared_scene.h"

namespace chamfer::test {

/// The frame of the prepared scene's own camera. No shading normals but the exact surface's: roundings
/// analytic and none, materials without normal textures; lights that chance can find. Pure: same arguments,
/// same bits.
Image renderPlainly(const PreparedScene& prepared, unsigned width, unsigned height, unsigned samples,
                    unsigned maxBounces, unsigned seed);

} // namespace chamfer::test
