#include "server/jobs/compare/result.h"

#include <algorithm>
#include <array>

namespace chamfer {
namespace {

struct OutcomeRow {
  Outcome outcome;
  const char* word;
  int exitStatus;
};

/// From the worst to the best.
constexpr std::array<OutcomeRow, 4> kOutcomes = {{{Outcome::Error, "error", 2},
                                                  {Outcome::Differs, "differs", 1},
                                                  {Outcome::CannotTell, "cannot-tell", 2},
                                                  {Outcome::Same, "same", 0}}};

std::size_t rowOf(Outcome outcome) {
  for (std::size_t i = 0; i < kOutcomes.size(); ++i)
    if (kOutcomes[i].outcome == outcome) return i;
  return 0; // what is unknown is an error
}

template <class Results>
Outcome worstOf(const Results& results) {
  Outcome all = Outcome::Same;
  for (const auto& one : results)
    all = worse(all, one.outcome);
  return results.empty() ? Outcome::Error : all; // nothing compared is no pass
}

} // namespace

const char* outcomeWord(Outcome outcome) { return kOutcomes[rowOf(outcome)].word; }

Outcome worse(Outcome a, Outcome b) { return kOutcomes[std::min(rowOf(a), rowOf(b))].outcome; }

int exitStatusOf(Outcome outcome) { return kOutcomes[rowOf(outcome)].exitStatus; }

Outcome StatisticsResult::outcome() const { return worstOf(levels); }

Outcome SuiteResult::outcome() const { return worstOf(cases); }

} // namespace chamfer
