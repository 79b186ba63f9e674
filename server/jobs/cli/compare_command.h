// `chamferd compare A B` and `chamferd compare --suite cases.json`. The caller parses the command line.
#pragma once

#include "server/jobs/image/region.h"
#include "server/jobs/suite/suite.h"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace chamfer {

struct CompareCommandOptions {
  std::string version;                ///< of the program
  std::string command;                ///< as it was called, to be typed again
  std::vector<std::string> sides;     ///< A and B; none with a suite
  std::filesystem::path suite;        ///< cases in a file
  std::vector<std::string> onlyCases; ///< of the suite; none: all
  std::filesystem::path root;         ///< see LocalHost
  CaseChoice one;                     ///< what the command line says of A and B beside their names
  std::optional<bool> statistics;
  bool update = false;           ///< accept new references
  std::string json, junit, html; ///< files to write; "-": standard output; empty: not wanted
  std::filesystem::path keep;    ///< folder of seeds that stays; empty: a temporary one
  unsigned threads = 0;          ///< 0: all cores
  bool quiet = false;
};

/// Compares, prints what was found on standard output, writes the reports. Returns the exit status: 0 same, 1
/// differs, 2 cannot tell, or a case was in error. Throws Error for what is not one case's fault; the exit
/// status of that is 2, too.
int runCompareCommand(const CompareCommandOptions& options);

/// Arguments as a shell takes them.
std::string shellText(const std::vector<std::string>& arguments);

} // namespace chamfer
