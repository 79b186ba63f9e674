// Several cases, one after the other.
#pragma once

#include "server/jobs/compare/compare_case.h"

#include <functional>
#include <string>
#include <vector>

namespace chamfer {

struct SuiteControl {
  CompareControl each{};
  std::string command;                                       ///< as it was called
  std::function<std::string(const CaseChoice&)> commandOf{}; ///< that repeats one case alone
  std::function<void(std::size_t index, unsigned done, unsigned most)> progress{};
  std::function<void(std::size_t index, const CaseResult&)> finished{};
};

/// Throws as compareCase().
SuiteResult compareSuite(const std::vector<CaseChoice>& cases, CompareHost& host,
                         const SuiteControl& control);

} // namespace chamfer
