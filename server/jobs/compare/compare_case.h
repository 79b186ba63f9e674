// Comparisons carried out: seeds are rendered until the verdict stands or the budget ends.
#pragma once

#include "server/jobs/compare/compare_host.h"
#include "server/jobs/compare/result.h"
#include "server/jobs/seeds/seed_store.h"
#include "server/jobs/suite/suite.h"

#include <functional>
#include <string>

namespace chamfer {

struct CompareControl {
  std::string version;              ///< of the program; a part of what names seeds and references
  unsigned threads = 0;             ///< of statistics; 0: all cores
  const SeedStore* store = nullptr; ///< nothing: seeds are not kept
  /// Seeds done (of both sides) of those that the budget allows.
  std::function<void(unsigned done, unsigned most)> progress{};
  std::function<bool()> cancelled{}; ///< asked between seeds
};

/// Faults of the case's inputs are its result (Outcome::Error with the reason). Throws Error(Cancelled), and
/// what is not the case's fault.
CaseResult compareCase(const CaseChoice& choice, CompareHost& host, const CompareControl& control);

/// Accepts what side a renders now: writes side b, an image, from the case's whole budget of seeds, with its
/// variance. Throws Error where the case has no such sides. The new reference's attributes name its origin.
/// Of a digest: nothing is written; returns the new text of the side.
std::string acceptCase(const CaseChoice& choice, CompareHost& host, const CompareControl& control);

} // namespace chamfer
