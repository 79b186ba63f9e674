// From the body of a request to a job: its cases checked, its inputs found, its work bounded, its name known.
#pragma once

#include "server/http/comparisons/job_options.h"
#include "server/http/comparisons/served_host.h"
#include "server/jobs/suite/suite.h"

#include <string>
#include <vector>

namespace chamfer::http {

struct Submission {
  std::string id;      ///< the digest of all that the result depends on
  std::string request; ///< text of request.json
};

/// `body`: a suite, as data/COMPARISONS.md describes it; sides and masks are named from the served folder.
/// Throws Error(Malformed), ParameterError with the case's place, and ProblemError for scenes that are not
/// ready.
Submission readSubmission(const std::string& body, const Parts& parts, const JobOptions& options);

/// What request.json says.
struct JobRequest {
  std::string version; ///< of the program that took it
  JobOrigins origins;
  std::vector<CaseChoice> cases;
};
/// Error(Malformed).
JobRequest readJobRequest(const std::string& text);

} // namespace chamfer::http
