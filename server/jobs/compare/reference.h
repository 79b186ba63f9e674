// References: pictures in files that tell what made them, so that a comparison sees when they are of another
// version or another scene.
#pragma once

#include "server/jobs/compare/side_source.h"

#include <string>

namespace chamfer {

/// `mean` as a reference for that side: its attributes name version, scene, settings, seeds and samples.
Picture referenceOf(Picture mean, const SideSource& side, unsigned seeds, const std::string& version);

/// Why the reference does not belong to what `side` renders now; empty: it does, or it says nothing of where
/// it came from.
std::string staleness(const Picture& reference, const SideSource& side, const std::string& version);

/// Samples of each pixel of a reference; 0: it does not say.
unsigned samplesOf(const Picture& reference);

} // namespace chamfer
