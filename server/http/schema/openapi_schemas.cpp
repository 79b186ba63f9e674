#include "server/http/schema/openapi_schemas.h"

#include "server/http/schema/limits.h"

namespace chamfer::http {
namespace {

constexpr const char* kSchemas = R"json({
"Triple": {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3},
"Id": {"type": "string", "pattern": "^[0-9a-f]{32}$", "description": "digest of all that determines the scene's pixels"},
"Problem": {
  "type": "object", "description": "RFC 9457", "additionalProperties": false,
  "required": ["type", "title", "status", "detail", "request_id"],
  "properties": {
    "type": {"type": "string", "pattern": "^urn:chamfer:problem:[a-z-]+$"},
    "title": {"type": "string"},
    "status": {"type": "integer", "minimum": 400, "maximum": 599},
    "detail": {"type": "string", "minLength": 1, "description": "what, the number, and the fix"},
    "parameter": {"type": "string", "description": "the offending one"},
    "value": {"type": "string", "description": "as it was sent, at most 200 bytes of it"},
    "limits": {"type": "object", "properties": {
      "minimum": {"type": "number"}, "above": {"type": "number"}, "below": {"type": "number"},
      "maximum": {"type": "number"}, "one_of": {"type": "string"}, "numbers": {"type": "string"},
      "unit": {"type": "string"}}, "additionalProperties": false},
    "request_id": {"type": "string"}}},
"Info": {
  "type": "object", "additionalProperties": false,
  "required": ["name", "version", "ray_instruction_set", "formats", "limits", "parameters", "queue", "prepared_scenes", "comparisons"],
  "properties": {
    "name": {"const": "chamferd"},
    "version": {"type": "string"},
    "ray_instruction_set": {"type": "string", "description": "that rays are traced with; fixed, so that a tile has the same bytes on every node"},
    "formats": {"type": "object", "required": ["tiles", "frames"], "additionalProperties": {"type": "array", "items": {"type": "string"}}},
    "limits": {},
    "parameters": {"type": "array", "items": {
      "type": "object", "additionalProperties": false, "required": ["name", "where", "kind", "default", "limits"],
      "properties": {
        "name": {"type": "string"},
        "where": {"type": "string", "description": "path, query or body; of a part: the parameter it is part of"},
        "kind": {"enum": ["integer", "number", "numbers", "word", "text"]},
        "default": {"type": ["string", "null"], "description": "null: it must be given"},
        "limits": {"type": "object"},
        "about": {"type": "string"}}}},
    "queue": {
      "type": "object", "additionalProperties": false, "required": ["slots", "running", "places", "waiting", "retry_after_seconds"],
      "properties": {
        "slots": {"type": "integer", "minimum": 1}, "running": {"type": "integer", "minimum": 0},
        "places": {"type": "integer", "minimum": 0}, "waiting": {"type": "integer", "minimum": 0},
        "retry_after_seconds": {"type": "integer", "minimum": 1}}},
    "prepared_scenes": {
      "type": "object", "additionalProperties": false, "required": ["count", "bytes", "limit_bytes", "hits", "builds", "evictions"],
      "properties": {
        "count": {"type": "integer", "minimum": 0}, "bytes": {"type": "integer", "minimum": 0},
        "limit_bytes": {"type": "integer", "minimum": 0}, "hits": {"type": "integer", "minimum": 0},
        "builds": {"type": "integer", "minimum": 0}, "evictions": {"type": "integer", "minimum": 0}}},
    "comparisons": {
      "type": ["object", "null"], "additionalProperties": false, "required": ["queued", "running", "places", "limit_bytes"],
      "description": "null: the server takes none (--jobs)",
      "properties": {
        "queued": {"type": "integer", "minimum": 0}, "running": {"type": "integer", "minimum": 0},
        "places": {"type": "integer", "minimum": 1, "description": "jobs that may wait or run"},
        "limit_bytes": {"type": "integer", "minimum": 0, "description": "of all jobs' files"}}}}},
"Radius": {
  "type": ["object", "null"], "additionalProperties": false, "required": ["current", "max"],
  "properties": {
    "current": {"type": ["number", "null"], "description": "mesh units; null: sharp"},
    "max": {"type": ["number", "null"], "description": "a radius must be below it; null: not known, or nothing is rounded"}}},
"SceneSummary": {
  "type": "object", "required": ["name", "id", "state", "triangles", "rounded_edges", "bounds", "radius", "warnings"],
  "description": "what is not known, since the scene is not ready, is null",
  "properties": {
    "name": {"type": "string", "minLength": 1},
    "id": {"anyOf": [{"$ref": "#/components/schemas/Id"}, {"type": "null"}]},
    "state": {"enum": ["loading", "ready", "stale", "damaged", "failed"]},
    "error": {"type": "object", "additionalProperties": false, "required": ["kind", "detail"],
              "properties": {"kind": {"type": "string"}, "detail": {"type": "string"}}},
    "triangles": {"type": ["integer", "null"]},
    "rounded_edges": {"type": ["integer", "null"]},
    "bounds": {"type": ["object", "null"], "additionalProperties": false, "required": ["min", "max"], "description": "world units",
               "properties": {"min": {"$ref": "#/components/schemas/Triple"}, "max": {"$ref": "#/components/schemas/Triple"}}},
    "radius": {"$ref": "#/components/schemas/Radius"},
    "warnings": {"type": "array", "items": {"type": "string"}}}},
"SceneList": {"type": "array", "items": {"allOf": [{"$ref": "#/components/schemas/SceneSummary"}], "unevaluatedProperties": false}},
"Mesh": {
  "type": "object", "additionalProperties": false,
  "required": ["name", "triangles", "rounded", "solids", "rounded_edges", "radius", "rounding_bytes"],
  "properties": {
    "name": {"type": "string"}, "triangles": {"type": "integer"}, "rounded": {"type": "boolean"},
    "solids": {"type": ["integer", "null"]}, "rounded_edges": {"type": "integer"},
    "radius": {"$ref": "#/components/schemas/Radius"}, "rounding_bytes": {"type": "integer"}}},
"TextureSize": {
  "type": ["object", "null"], "additionalProperties": false, "required": ["width", "height"],
  "properties": {"width": {"type": "integer", "minimum": 1}, "height": {"type": "integer", "minimum": 1}}},
"Material": {
  "type": "object", "additionalProperties": false,
  "required": ["name", "base_color", "roughness", "metallic", "specular", "transmission", "ior", "emission", "absorption", "base_color_texture", "roughness_texture", "normal_texture"],
  "properties": {
    "name": {"type": "string"},
    "base_color": {"$ref": "#/components/schemas/Triple"},
    "roughness": {"type": "number"}, "metallic": {"type": "number"}, "specular": {"type": "number"},
    "transmission": {"type": "number"}, "ior": {"type": "number"},
    "emission": {"$ref": "#/components/schemas/Triple"}, "absorption": {"$ref": "#/components/schemas/Triple"},
    "base_color_texture": {"$ref": "#/components/schemas/TextureSize"},
    "roughness_texture": {"$ref": "#/components/schemas/TextureSize"},
    "normal_texture": {"$ref": "#/components/schemas/TextureSize"}}},
"Camera": {
  "type": "object", "additionalProperties": false,
  "required": ["eye", "target", "up", "vfov_degrees", "aperture_diameter", "focus_distance"],
  "properties": {
    "eye": {"$ref": "#/components/schemas/Triple"}, "target": {"$ref": "#/components/schemas/Triple"},
    "up": {"$ref": "#/components/schemas/Triple"}, "vfov_degrees": {"type": "number"},
    "aperture_diameter": {"type": "number"}, "focus_distance": {"type": "number", "description": "0: distance to the target"}}},
"Scene": {
  "allOf": [{"$ref": "#/components/schemas/SceneSummary"}], "unevaluatedProperties": false,
  "required": ["up_axis", "instances", "meshes", "materials", "camera", "load"],
  "properties": {
    "up_axis": {
      "type": ["object", "null"], "additionalProperties": false, "required": ["current", "ids"],
      "description": "of a bare mesh, the axis of its file that points up; null: a scene file says it of each mesh",
      "properties": {
        "current": {"enum": ["y", "z"]},
        "ids": {"type": "object", "additionalProperties": false, "required": ["y", "z"], "description": "the same mesh with either axis up: scenes of their own, one of them this one",
                "properties": {"y": {"$ref": "#/components/schemas/Id"}, "z": {"$ref": "#/components/schemas/Id"}}}}},
    "instances": {"type": "integer"},
    "meshes": {"type": "array", "items": {"$ref": "#/components/schemas/Mesh"}},
    "materials": {"type": "array", "items": {"$ref": "#/components/schemas/Material"}},
    "camera": {"$ref": "#/components/schemas/Camera"},
    "load": {
      "type": "object", "additionalProperties": false, "required": ["seconds", "memory_bytes", "files"],
      "properties": {
        "seconds": {"type": "number", "minimum": 0},
        "memory_bytes": {"type": "integer", "minimum": 1},
        "files": {"type": "array", "items": {"type": "string"}, "description": "names below the served folder; the scene is loaded again when one changes"}}}}},
"Rect": {"type": "array", "description": "x, y, width, height", "minItems": 4, "maxItems": 4,
         "items": {"type": "integer", "minimum": 0, "maximum": 65536}},
"PerLevel": {
  "type": "object", "additionalProperties": false, "description": "relative to the brightness",
  "properties": {"pixel": {"type": "number", "minimum": 0}, "block": {"type": "number", "minimum": 0}, "image": {"type": "number", "minimum": 0}}},
"CaseKeys": {
  "type": "object",
  "properties": {
    "width": {"type": "integer", "minimum": 1, "maximum": 65536}, "height": {"type": "integer", "minimum": 1, "maximum": 65536},
    "samples": {"type": "integer", "minimum": 1, "maximum": 1048576, "description": "of each pixel, of every seed"},
    "seeds": {"type": "integer", "minimum": 1, "maximum": 4096, "description": "the budget"},
    "seconds": {"type": "number", "minimum": 0, "description": "the budget in time; 0: none"},
    "crop": {"$ref": "#/components/schemas/Rect"},
    "mask": {"type": "string", "description": "an image below the served folder"},
    "only": {"type": "array", "items": {"$ref": "#/components/schemas/Rect"}},
    "except": {"type": "array", "items": {"$ref": "#/components/schemas/Rect"}},
    "tolerance": {"type": "object", "additionalProperties": false, "properties": {"absolute": {"type": "number", "minimum": 0}, "relative": {"type": "number", "minimum": 0}}},
    "limits": {"type": "object", "additionalProperties": {"type": "number", "minimum": 0}},
    "statistics": {"anyOf": [{"type": "boolean"}, {
      "type": "object", "additionalProperties": false,
      "properties": {
        "significance": {"type": "number", "minimum": 1e-6, "maximum": 0.5},
        "tolerance": {"$ref": "#/components/schemas/PerLevel"}, "resolution": {"$ref": "#/components/schemas/PerLevel"}}}]}}},
"Suite": {
  "type": "object", "additionalProperties": false, "required": ["schema", "cases"],
  "properties": {
    "schema": {"const": "chamfer.cases/1"},
    "defaults": {"allOf": [{"$ref": "#/components/schemas/CaseKeys"}], "unevaluatedProperties": false},
    "cases": {"type": "array", "minItems": 1, "maxItems": 64, "items": {
      "allOf": [{"$ref": "#/components/schemas/CaseKeys"}], "unevaluatedProperties": false, "required": ["name", "a", "b"],
      "properties": {
        "name": {"type": "string"},
        "a": {"type": "string", "description": "what is judged: a scene's name or id with ?parameters, a tile's URL, an image below the served folder"},
        "b": {"type": "string", "description": "what it is judged by: the same, or digest:HEX"}}}}}},
"Outcome": {"enum": ["same", "differs", "cannot-tell", "error", null]},
"JobProgress": {
  "type": ["object", "null"], "additionalProperties": false, "required": ["case", "cases", "name", "seeds", "most_seeds"],
  "description": "null: nothing is worked on",
  "properties": {
    "case": {"type": "integer", "minimum": 0, "description": "the one under way, from 0"}, "cases": {"type": "integer", "minimum": 1},
    "name": {"type": "string"},
    "seeds": {"type": "integer", "minimum": 0, "description": "done of the case"},
    "most_seeds": {"type": "integer", "minimum": 0, "description": "that its budget allows"}}},
"JobFacts": {
  "type": "object", "required": ["id", "state", "created", "finished", "outcome", "detail", "node", "progress", "links"],
  "properties": {
    "id": {"$ref": "#/components/schemas/Id"},
    "state": {"enum": ["queued", "running", "done", "cancelled", "failed"]},
    "created": {"type": "string", "description": "UTC"},
    "finished": {"type": ["string", "null"], "description": "UTC"},
    "outcome": {"$ref": "#/components/schemas/Outcome"},
    "detail": {"type": ["string", "null"], "description": "why it failed"},
    "node": {"type": ["string", "null"], "description": "the process that works on it"},
    "progress": {"$ref": "#/components/schemas/JobProgress"},
    "links": {
      "type": "object", "additionalProperties": false, "required": ["self", "events", "suite", "result", "report", "junit"],
      "properties": {
        "self": {"type": "string"}, "events": {"type": "string"}, "suite": {"type": "string"},
        "result": {"type": ["string", "null"]}, "report": {"type": ["string", "null"]}, "junit": {"type": ["string", "null"]}}}}},
"Comparison": {
  "allOf": [{"$ref": "#/components/schemas/JobFacts"}], "unevaluatedProperties": false, "required": ["cases"],
  "properties": {
    "cases": {"type": "array", "items": {
      "type": "object", "additionalProperties": false, "required": ["name", "outcome", "reason"],
      "properties": {"name": {"type": "string"}, "outcome": {"$ref": "#/components/schemas/Outcome"}, "reason": {"type": ["string", "null"]}}}}}},
"ComparisonList": {"type": "array", "items": {"allOf": [{"$ref": "#/components/schemas/JobFacts"}], "unevaluatedProperties": false}},
"Hit": {
  "type": ["object", "null"], "additionalProperties": false, "description": "null: a miss",
  "required": ["t", "position", "normal", "feature", "instance", "solid", "triangle"],
  "properties": {
    "t": {"type": "number", "description": "in lengths of the ray's direction"},
    "position": {"$ref": "#/components/schemas/Triple"},
    "normal": {"allOf": [{"$ref": "#/components/schemas/Triple"}], "description": "unit, outward"},
    "feature": {"enum": ["flat", "cylinder", "sphere"]},
    "instance": {"type": "integer"}, "solid": {"type": ["integer", "null"], "description": "null: the mesh is sharp"},
    "triangle": {"type": "integer"}}},
"Hits": {
  "type": "object", "additionalProperties": false, "required": ["hits"],
  "properties": {"hits": {"type": "array", "items": {"$ref": "#/components/schemas/Hit"}}}}
})json";

} // namespace

nlohmann::ordered_json answerSchemas() {
  nlohmann::ordered_json schemas = nlohmann::ordered_json::parse(kSchemas);
  nlohmann::ordered_json limits{{"type", "object"},
                                {"required", {"deadline_seconds", "connections", "explicit_triangles"}}};
  for (const LimitRow& row : limitRows()) {
    limits["properties"][row.name] = {{"const", row.value}, {"description", row.about}};
    limits["required"].push_back(row.name);
  }
  limits["properties"]["deadline_seconds"] = {{"type", "number"}, {"description", "of one request"}};
  limits["properties"]["connections"] = {{"type", "integer"}, {"description", "open at one time"}};
  limits["properties"]["explicit_triangles"] = {
      {"type", "integer"},
      {"description", "of a scene with rounding=mesh:K, each mesh counted once: as many as the memory for "
                      "prepared scenes holds"}};
  limits["additionalProperties"] = false;
  schemas["Info"]["properties"]["limits"] = limits;
  return schemas;
}

} // namespace chamfer::http
