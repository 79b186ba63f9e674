// FLIP: how different two pictures look when one flips between them. Andersson, Nilsson, Akenine-Moeller,
// Oskarsson, Astrom and Fairchild, "FLIP: A Difference Evaluator for Alternating Images", HPG 2020; for
// linear (high dynamic range) pictures Andersson, Nilsson, Shirley and Akenine-Moeller, "Visualizing Errors
// in Rendered High Dynamic Range Images", Eurographics 2021 (short papers).
#pragma once

#include "server/jobs/image/picture.h"

#include <vector>

namespace chamfer {

/// Of an observer 0.7 m before a monitor 0.7 m wide with 3840 pixels: the papers' own.
inline constexpr double kFlipPixelsPerDegree = 67.020643;

/// The error map, [height][width], 0..1. Both pictures of one size with 3 or 4 channels (alpha is left out)
/// or 1. Display pictures take LDR-FLIP; linear ones HDR-FLIP, the largest LDR-FLIP over the exposures that
/// the reference `b` asks for (ACES tone curve). Values finite; negative ones count as 0.
std::vector<float> flipMap(const Picture& a, const Picture& b, double pixelsPerDegree = kFlipPixelsPerDegree);

} // namespace chamfer
