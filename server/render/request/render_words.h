// The words by which requests and command lines name render settings; one place for both.
#pragma once

#include "server/render/path/render.h"

#include <string>
#include <string_view>

namespace chamfer {

/// Of mesh:K and bevel:N.
inline constexpr unsigned kMaxRoundingCount = 256;

/// "none", "analytic", "mesh:K" (K 1..256 segments) or "bevel:N" (N 1..256 probes); `radius` and
/// `radiusClamp` are left empty. Throws Error(Usage) for another word, Error(OutOfRange) for a count outside
/// its limits.
RoundingChoice parseRounding(std::string_view text);
/// The word that parseRounding() reads back.
std::string roundingWord(const RoundingChoice& choice);

/// A float as the shortest number that reads back as it: 0.1, not 0.10000000149011612.
double plainNumber(float value);

/// "beauty", "albedo", "normal", "geometric_normal", "depth", "feature" or "instance". Throws Error(Usage).
Aov parseAov(std::string_view text);
const char* aovWord(Aov aov);

} // namespace chamfer
