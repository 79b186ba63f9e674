#include "server/http/schema/openapi.h"

#include "common/text.h"

#include "server/http/routes/content_type.h"
#include "server/http/routes/problem.h"
#include "server/http/routes/route_table.h"
#include "server/http/schema/limits.h"
#include "server/http/schema/openapi_schemas.h"
#include "server/http/version.h"
#include "server/render/request/parameters.h"

#include <algorithm>
#include <cctype>
#include <cmath>

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kDescription =
    "Tiles and frames of rounded scenes. A tile is a pure function of its URL: same URL, same bytes, on "
    "every "
    "node, so that any cache or load balancer serves. Scene ids are digests of content; a name redirects to "
    "the id that it stands for now.\n\n"
    "Every answer carries X-Request-Id: the request's own, where it is up to 64 letters, digits, '-', '_' or "
    "'.', else a new one. Errors are application/problem+json (RFC 9457). 503 and Retry-After: try again. "
    "HEAD answers as GET without a body, and without rendering. No CORS header is sent and what pages of "
    "other sites ask for (Sec-Fetch-Site) is refused, unless a proxy in front arranges it. Bodies need a "
    "Content-Length and no "
    "Content-Encoding; ranges are not served.";

/// Beside those for keys, sites and conditions.
constexpr std::string_view kCommonStatuses = "400 405 414 431 503";

std::vector<std::string> words(std::string_view text, char separator = ' ') {
  std::vector<std::string> result;
  while (!text.empty()) {
    const std::size_t end = text.find(separator);
    result.emplace_back(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  return result;
}

Json plainNumber(double value) {
  if (std::abs(value) < 1e15 && value == std::floor(value)) return static_cast<std::int64_t>(value);
  return value;
}

void putLimits(const ParameterRow& row, Json& schema) {
  schema[row.aboveMinimum ? "exclusiveMinimum" : "minimum"] = plainNumber(row.minimum);
  schema["maximum"] = plainNumber(row.maximum);
}

/// "analytic|mesh:K": an enumeration, or a pattern where a number is part of a word.
Json wordSchema(const ParameterRow& row, const std::vector<std::string>& formats) {
  const auto isNumber = [](char c) { return c >= 'A' && c <= 'Z'; };
  Json schema{{"type", "string"}};
  std::string pattern;
  bool numbers = false;
  Json list = Json::array();
  for (const std::string& word : words(row.words, '|')) {
    if (!formats.empty() && std::find(formats.begin(), formats.end(), word) == formats.end()) continue;
    list.push_back(word);
    pattern += pattern.empty() ? "" : "|";
    for (const char c : word) {
      numbers |= isNumber(c);
      pattern += isNumber(c) ? std::string("[1-9][0-9]*") : std::string(1, c);
    }
  }
  if (numbers)
    schema["pattern"] = "^(" + pattern + ")$";
  else
    schema["enum"] = list;
  return schema;
}

/// "a,b[,c]": two or three numbers in a row, with their names.
Json numbersSchema(const ParameterRow& row) {
  Json schema{{"type", "array"}};
  const std::size_t bracket = row.words.find('[');
  std::string all;
  for (const char c : row.words)
    if (c != '[' && c != ']') all += c;
  schema["prefixItems"] = Json::array();
  for (const std::string& name : words(all, ',')) {
    Json item{{"title", name}, {"type", "number"}};
    const auto own = std::ranges::find(parameterRows(), std::string_view(name), &ParameterRow::name);
    putLimits(own != parameterRows().end() && own->where == row.name ? *own : row, item);
    schema["prefixItems"].push_back(item);
  }
  schema["items"] = false;
  schema["minItems"] = words(row.words.substr(0, bracket), ',').size();
  schema["maxItems"] = schema["prefixItems"].size();
  return schema;
}

Json schemaOf(const ParameterRow& row, const std::vector<std::string>& formats) {
  switch (row.kind) {
  case ParameterKind::Word:
    return wordSchema(row, formats);
  case ParameterKind::Numbers:
    return numbersSchema(row);
  case ParameterKind::Text:
    return {{"type", "string"}, {"minLength", 1}};
  default:
    Json schema{{"type", row.kind == ParameterKind::Integer ? "integer" : "number"}};
    putLimits(row, schema);
    return schema;
  }
}

std::string described(const ParameterRow& row) {
  std::string text(row.about);
  if (!row.unit.empty()) text += (text.empty() ? "" : "; ") + std::string(row.unit);
  for (const ParameterRow& part : parameterRows())
    if (part.where == row.name)
      text += "; " + std::string(part.name) + ": " + exactNumberText(part.minimum) + " to " +
              exactNumberText(part.maximum) + ' ' + std::string(part.unit);
  if (!row.fallback.empty()) text += "; default: " + std::string(row.fallback);
  return text;
}

std::vector<std::string> formatsOf(const RouteRow& route) {
  std::vector<std::string> formats;
  for (const ImageFormat format : {ImageFormat::F16, ImageFormat::Exr, ImageFormat::Png})
    if (route.produces.find(contentTypeOf(format)) != std::string_view::npos)
      formats.emplace_back(formatWord(format));
  return formats;
}

Json parameter(const ParameterRow& row, const char* place, const RouteRow& route) {
  Json json{{"name", row.name}, {"in", place}};
  if (*place == 'p' || row.fallback.empty()) json["required"] = true;
  json["description"] = described(row);
  if (row.kind == ParameterKind::Numbers) {
    json["style"] = "form"; // numbers with commas between them
    json["explode"] = false;
  }
  json["schema"] = schemaOf(row, row.name == "format" ? formatsOf(route) : std::vector<std::string>{});
  return json;
}

Json parametersOf(const RouteRow& route) {
  Json list = Json::array();
  for (std::size_t at = 0; (at = route.path.find('{', at)) != std::string_view::npos; ++at) {
    const std::string_view name = route.path.substr(at + 1, route.path.find('}', at) - at - 1);
    if (name == "file")
      list.push_back({{"name", "file"},
                      {"in", "path"},
                      {"required", true},
                      {"description", "a file of the page; none: index.html"},
                      {"schema", {{"type", "string"}}}});
    else if (name == "job")
      list.push_back({{"name", "job"},
                      {"in", "path"},
                      {"required", true},
                      {"description", "id of a comparison, hexadecimal"},
                      {"schema", {{"type", "string"}, {"minLength", 32}, {"maxLength", 32}}}});
    else
      list.push_back(parameter(parameterRow(name), "path", route));
  }
  if (route.takes == "query")
    for (const ParameterRow& row : parameterRows())
      if (row.standsIn("query")) list.push_back(parameter(row, "query", route));
  if (route.id == RouteId::ComparisonEvents)
    list.push_back({{"name", "Last-Event-ID"},
                    {"in", "header"},
                    {"description", "id of the event that is known; none: the state as it is comes at once"},
                    {"schema", {{"type", "string"}}}});
  return list;
}

Json jsonBody(Json schema) {
  return {{"required", true}, {"content", {{"application/json", {{"schema", std::move(schema)}}}}}};
}

Json bodyOf(const RouteRow& route) {
  if (route.takes == "suite") return jsonBody({{"$ref", "#/components/schemas/Suite"}});
  Json schema{{"type", "object"}, {"properties", Json::object()}, {"required", Json::array()}};
  for (const ParameterRow& row : parameterRows()) {
    if (!row.standsIn("body")) continue;
    Json property = schemaOf(row, {});
    if (row.name == "rays") property = {{"type", "array"}, {"maxItems", kMaxRays}, {"items", property}};
    property["description"] = described(row);
    schema["properties"][row.name] = property;
    if (row.fallback.empty()) schema["required"].push_back(row.name);
  }
  schema["additionalProperties"] = false;
  return jsonBody(std::move(schema));
}

Json headersOf(const RouteRow& route) {
  Json headers;
  for (const char* name : {"X-Request-Id", "X-Content-Type-Options", "Cache-Control"})
    headers[name] = {{"schema", {{"type", "string"}}}};
  for (const std::string& name : words(route.headers))
    headers[name] = {{"schema", {{"type", "string"}}}};
  return headers;
}

Json responsesOf(const RouteRow& route, const std::string& method) {
  Json responses = Json::object();
  if (method == "OPTIONS")
    responses["204"] = {{"description", "Allow names the methods"},
                        {"headers", {{"Allow", {{"schema", {{"type", "string"}}}}}}}};
  std::string statuses = std::string(route.statuses) + ' ' + std::string(kCommonStatuses);
  if (!route.anyHost) statuses += " 403 421";
  if (route.needsKey) statuses += " 401";
  if (method != "OPTIONS") statuses += " 412";
  auto sorted = words(statuses);
  std::sort(sorted.begin(), sorted.end());
  for (const std::string& status : sorted) {
    if (method == "OPTIONS" && status < "400") continue;
    Json response;
    if (status == "200" || status == "202") {
      response = {{"description", route.about}, {"headers", headersOf(route)}};
      for (const std::string& type : words(route.produces))
        if (method != "HEAD")
          response["content"][type] =
              route.schema.empty()
                  ? Json::object()
                  : Json{{"schema", {{"$ref", "#/components/schemas/" + std::string(route.schema)}}}};
    } else if (status == "204") {
      response = {{"description", route.about}};
    } else if (status == "304") {
      response = {{"description", "If-None-Match names the ETag"}};
    } else if (status == "307") {
      response = {{"description", "the scene was called by its name: Location has its id"},
                  {"headers", {{"Location", {{"schema", {{"type", "string"}}}}}}}};
    } else {
      response = {{"description", problemTitle(std::stoi(status))}};
      if (method != "HEAD")
        response["content"]["application/problem+json"] = {
            {"schema", {{"$ref", "#/components/schemas/Problem"}}}};
    }
    responses[status] = response;
  }
  return responses;
}

Json operation(const RouteRow& route, const std::string& method, bool keys) {
  std::string id;
  for (const char c : method + std::string(route.path))
    id += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  Json json{{"operationId", id}, {"summary", route.about}, {"parameters", parametersOf(route)}};
  if (method == "OPTIONS") json["summary"] = "which methods it answers";
  if (method == "POST") json["requestBody"] = bodyOf(route);
  if (keys && route.needsKey)
    json["security"] = Json::array({{{"bearer", Json::array()}}, {{"header", Json::array()}}});
  json["responses"] = responsesOf(route, method);
  return json;
}

} // namespace

Json openApiDocument(bool keys) {
  Json document{{"openapi", "3.1.0"}};
  document["info"] = {{"title", "chamferd"},
                      {"version", kVersion},
                      {"description", kDescription},
                      {"license", {{"name", "GPL-3.0-or-later"}, {"identifier", "GPL-3.0-or-later"}}}};
  document["servers"] = Json::array({{{"url", "/"}}});
  document["security"] = Json::array();
  for (const RouteRow& route : routeRows())
    for (std::string method : words(route.methods, ',')) {
      method.erase(0, method.find_first_not_of(' '));
      document["paths"][route.path][lowerCase(method)] = operation(route, method, keys);
    }
  document["components"]["schemas"] = answerSchemas();
  document["components"]["securitySchemes"] = {
      {"bearer", {{"type", "http"}, {"scheme", "bearer"}}},
      {"header", {{"type", "apiKey"}, {"in", "header"}, {"name", "X-Api-Key"}}}};
  return document;
}

} // namespace chamfer::http
