// JSON Schemas (2020-12) of the answers, the components of openapi.h's document. They name every member and
// allow no other.
#pragma once

#include <nlohmann/json.hpp>

namespace chamfer::http {

/// By name: Problem, Info, SceneList, SceneSummary, Scene, Hits and what they share.
nlohmann::ordered_json answerSchemas();

} // namespace chamfer::http
