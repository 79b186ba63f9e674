// The command line of `chamferd compare`.
#pragma once

#include "server/jobs/cli/compare_command.h"

#include <CLI/CLI.hpp>

namespace chamfer {

/// Adds the command; parsing fills in `options`, which must live as long as `app`.
CLI::App* addCompareCommand(CLI::App& app, CompareCommandOptions& options);

} // namespace chamfer
