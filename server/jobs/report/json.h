// The comparison's JSON before it is text: the HTML report holds the same.
#pragma once

#include "server/jobs/compare/result.h"

#include <nlohmann/json.hpp>

namespace chamfer {

/// Of a number: itself, or "inf", "-inf", "nan".
nlohmann::ordered_json jsonNumber(double value);

nlohmann::ordered_json suiteJson(const SuiteResult& result);

/// On one line with `indent` -1. What is no UTF-8 becomes U+FFFD.
std::string textOfJson(const nlohmann::ordered_json& json, int indent);

} // namespace chamfer
