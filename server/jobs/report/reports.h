// What a comparison found, for programs, build farms and people.
#pragma once

#include "server/jobs/compare/result.h"

#include <string>

namespace chamfer {

/// One JSON object, "schema": "chamfer.comparison/1"; ends with a newline. data/COMPARISONS.md describes it
/// key by key. Numbers that are not finite (psnr of equal pictures) are written as the strings "inf", "-inf",
/// "nan".
std::string comparisonJson(const SuiteResult& result);

/// JUnit XML as Jenkins, GitLab and GitHub's actions read it: one testcase a case, <failure> for "differs",
/// <error> for "error" and "cannot tell", with the reason and the command that repeats it.
std::string comparisonJUnit(const SuiteResult& result);

/// One HTML file that needs no network: for every case a slider between the two pictures, a heat map of the
/// difference with its scale, where the largest difference is, metrics beside their limits, the statistics in
/// words.
std::string comparisonHtml(const SuiteResult& result);

/// A few lines a case, for a terminal; the last one is the verdict.
std::string comparisonText(const SuiteResult& result);

} // namespace chamfer
