// FLIP straight after its papers, for tests: two-dimensional kernels, one sum a pixel, in double. Slow.
#pragma once

#include "server/jobs/image/picture.h"

#include <optional>
#include <vector>

namespace chamfer::test {

/// The error map of LDR-FLIP of pictures of linear values, 1 or 3 channels, clamped to 0..1; or of both after
/// the ACES curve at an exposure. `colorOnly`: without features.
std::vector<double> plainFlip(const Picture& a, const Picture& b, double pixelsPerDegree,
                              std::optional<double> exposure = {}, bool colorOnly = false);

/// The colour error alone, of two colours (linear RGB, 0..1) that fill pictures.
double plainColorError(const double (&a)[3], const double (&b)[3]);

} // namespace chamfer::test
