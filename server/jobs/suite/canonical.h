// A case in one spelling, whatever keys were left out and in whatever order and under which names its inputs
// were given: two cases of one text are the same comparison.
#pragma once

#include "server/jobs/suite/suite.h"

#include <string>

namespace chamfer {

/// What a case's inputs are: scenes' ids, digests of files' bytes, hexadecimal; empty: there is none.
struct CaseOrigins {
  std::string a, b, mask;
};

/// What is asked of a side that is rendered, of seed 0, with the case's defaults filled in. `other`: the
/// other side. Width and height stay 0 where they are those of the other side's image. The tile is a URL's,
/// else the frame.
TileRequest resolvedRequest(const SideChoice& side, const SideChoice& other, const CaseChoice& of);

std::string canonicalCase(const CaseChoice& choice, const CaseOrigins& origins);

} // namespace chamfer
