// Cavities: a closed surface that faces inwards and lies inside another one that faces outwards.
#pragma once

#include "preprocess/components/solids.h"

namespace chamfer {

/// Gives components that are cavities their fault. A component inside another that faces outwards as well, or
/// inside one that was inside out too, is no cavity.
void findCavities(std::vector<Component>& components);

} // namespace chamfer
