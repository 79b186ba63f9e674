// The interface described for programs: an OpenAPI 3.1 document, made from the table of routes
// (route_table.h), the rows of parameters (render/request/parameters.h) and limits (limits.h) that requests
// are checked against, and the schemas of the answers (openapi_schemas.h).
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace chamfer::http {

/// `keys`: does the server ask for one?
nlohmann::ordered_json openApiDocument(bool keys);

} // namespace chamfer::http
