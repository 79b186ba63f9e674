// `--update`: what is rendered now becomes what is compared with.
#pragma once

#include "server/jobs/compare/compare_suite.h"

#include <filesystem>
#include <string>
#include <vector>

namespace chamfer {

/// Writes the references of all cases that have one: images, and digests in the text of `suite`, of which
/// nothing else changes. Returns what was done, for people. Throws Error: where no case has a reference, or
/// one digest stands in several cases that do not agree any more.
std::string acceptReferences(const std::vector<CaseChoice>& cases, const std::filesystem::path& suite,
                             CompareHost& host, const SuiteControl& control);

/// Does any render serve two sides or more?
bool rendersTwice(const std::vector<CaseChoice>& cases);

} // namespace chamfer
