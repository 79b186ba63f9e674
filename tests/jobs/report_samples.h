// Made-up results for tests of reports: every outcome, every part present and absent.
#pragma once

#include "server/jobs/compare/result.h"

namespace chamfer::test {

/// Soft gradients with noise of `noise`; of the same `seed` the same.
Picture makePicture(unsigned width, unsigned height, unsigned channels, unsigned seed, double noise);

/// Two pictures of this shape that differ by noise and, in a square, by more; metrics with and without
/// limits, statistics, a largest error. Outcome Differs.
CaseResult makeCase(const std::string& name, unsigned width, unsigned height, unsigned channels);

/// Cases that are the same, differ, cannot be told, are in error with and without pictures; masked, grey,
/// with alpha, one pixel large, very wide, large enough to be reduced, with values that are no finite
/// numbers.
SuiteResult makeSuite();

/// Names, reasons and commands that try to get out of JSON, XML, HTML and a terminal.
CaseResult makeHostileCase();

} // namespace chamfer::test
