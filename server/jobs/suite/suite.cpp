#include "server/jobs/suite/suite.h"

#include "common/error.h"
#include "common/text.h"
#include "server/render/scene/json_reader.h"

#include <set>

namespace chamfer {
namespace {

constexpr const char* kSchema = "chamfer.cases/1";

unsigned whole(const JsonReader& j, unsigned low, unsigned high) {
  return unsigned(j.wholeNumber(low, high));
}

/// [x, y, width, height]
TileRect readRect(const JsonReader& j) {
  j.requireArray();
  if (j.size() != 4) j.fail("must be [x, y, width, height] in pixels");
  const auto number = [&](std::size_t i, unsigned low) { return whole(j.at(i), low, 65536); };
  return {number(0, 0), number(1, 0), number(2, 1), number(3, 1)};
}

std::vector<TileRect> readRects(const JsonReader& j) {
  std::vector<TileRect> rects;
  j.forEach([&](const JsonReader& r) { rects.push_back(readRect(r)); });
  return rects;
}

void readPerLevel(const JsonReader& j, PerLevel& out) {
  j.requireObject({"pixel", "block", "image"});
  j.with("pixel", [&](const JsonReader& r) { out.pixel = r.number(kNotNegative); });
  j.with("block", [&](const JsonReader& r) { out.block = r.number(kNotNegative); });
  j.with("image", [&](const JsonReader& r) { out.image = r.number(kNotNegative); });
}

void readStatistics(const JsonReader& j, CaseChoice& c) {
  if (j.isBool()) {
    c.wantsStatistics = j.boolean();
    return;
  }
  j.requireObject({"significance", "tolerance", "resolution"});
  c.wantsStatistics = true;
  j.with("significance", [&](const JsonReader& r) { c.statistics.significance = r.number({1e-6, 0.5}); });
  j.with("tolerance", [&](const JsonReader& r) { readPerLevel(r, c.statistics.tolerance); });
  j.with("resolution", [&](const JsonReader& r) { readPerLevel(r, c.statistics.resolution); });
}

void readLimits(const JsonReader& j, CaseChoice& c) {
  j.forEachMember([&](const std::string& name, const JsonReader& r) {
    Metric metric{};
    try {
      metric = parseMetric(name);
    } catch (const Error& error) {
      r.fail(error.what());
    }
    const double number = r.number({0, metricRow(metric).most});
    std::erase_if(c.limits, [&](const auto& other) { return other.first == metric; });
    c.limits.emplace_back(metric, number);
  });
}

/// What both a case and the defaults may say.
void readCommon(const JsonReader& j, CaseChoice& c) {
  j.with("width", [&](const JsonReader& r) { c.width = whole(r, 1, 65536); });
  j.with("height", [&](const JsonReader& r) { c.height = whole(r, 1, 65536); });
  j.with("samples", [&](const JsonReader& r) { c.samples = whole(r, 1, 1u << 20); });
  j.with("seeds", [&](const JsonReader& r) { c.seeds = whole(r, 1, kMostSeeds); });
  j.with("seconds", [&](const JsonReader& r) { c.seconds = r.number(kNotNegative); });
  j.with("crop", [&](const JsonReader& r) { c.region.crop = readRect(r); });
  j.with("mask", [&](const JsonReader& r) { c.region.mask = r.string(); });
  j.with("only", [&](const JsonReader& r) { c.region.only = readRects(r); });
  j.with("except", [&](const JsonReader& r) { c.region.except = readRects(r); });
  j.with("tolerance", [&](const JsonReader& r) {
    r.requireObject({"absolute", "relative"});
    r.with("absolute", [&](const JsonReader& n) { c.tolerance.absolute = n.number(kNotNegative); });
    r.with("relative", [&](const JsonReader& n) { c.tolerance.relative = n.number(kNotNegative); });
  });
  j.with("limits", [&](const JsonReader& r) { readLimits(r, c); });
  j.with("statistics", [&](const JsonReader& r) { readStatistics(r, c); });
}

SideChoice readSide(const JsonReader& j) {
  try {
    return parseSide(j.string());
  } catch (const Error& error) {
    j.fail(error.what());
  }
}

} // namespace

void checkCase(const CaseChoice& c) {
  const auto fail = [&](const std::string& what) {
    throw Error(ErrorKind::Usage, (c.name.empty() ? "" : "case " + inQuotes(c.name, 100) + ": ") + what);
  };
  if ((c.width == 0) != (c.height == 0)) fail("width and height of a frame are given together");
  if (c.a.kind == SideKind::Digest) fail("a digest is what a render is judged by: make it side b");
  if (c.b.kind == SideKind::Digest) {
    if (!c.a.isRender()) fail("a digest is of a render's bits: side a must be one");
    if (!c.limits.empty() || c.wantsStatistics.value_or(false))
      fail("of a digest only equality can be asked: no limits, no statistics");
  }
  if (c.wantsStatistics.value_or(false) && c.renders() && c.budget() < 2)
    fail("statistics need two seeds at least, better 16 or more");
  if (!c.wantsStatistics.value_or(true) && c.limits.empty() && c.budget() > 1)
    fail("without limits and without statistics nothing is asked; give a limit, or 1 as the number of seeds "
         "to compare single pictures exactly");
  for (const auto& [metric, limit] : c.limits)
    if (const MetricRow& row = metricRow(metric); !(limit >= 0 && limit <= row.most))
      throw Error(ErrorKind::OutOfRange,
                  "the limit of " + std::string(row.name) + " is " + numberText(limit) +
                      "; it must be 0 or more" +
                      (row.most < 1e300 ? ", and " + numberText(row.most) + " at most" : std::string()));
}

std::vector<CaseChoice> parseSuite(const std::string& json, const std::string& file) {
  const nlohmann::json document = parseJson(json, file);
  const JsonReader j(document, file);
  j.requireObject({"schema", "defaults", "cases"});
  if (const JsonReader schema = j.at("schema"); schema.string() != kSchema)
    schema.fail("is " + inQuotes(schema.string()) + "; this version reads \"" + kSchema + "\"");
  CaseChoice defaults;
  j.with("defaults", [&](const JsonReader& r) {
    r.requireObject({"width", "height", "samples", "seeds", "seconds", "crop", "mask", "only", "except",
                     "tolerance", "limits", "statistics"});
    readCommon(r, defaults);
  });
  std::vector<CaseChoice> cases;
  std::set<std::string> names;
  const JsonReader list = j.at("cases");
  list.forEach([&](const JsonReader& r) {
    r.requireObject({"name", "a", "b", "width", "height", "samples", "seeds", "seconds", "crop", "mask",
                     "only", "except", "tolerance", "limits", "statistics"});
    CaseChoice c = defaults;
    c.name = r.at("name").string();
    if (!names.insert(c.name).second) r.at("name").fail("is the name of an earlier case, too");
    c.a = readSide(r.at("a"));
    c.b = readSide(r.at("b"));
    // Where a case says either, the other is not taken from the defaults.
    if (r.has("limits") != r.has("statistics")) {
      if (r.has("statistics")) c.limits.clear();
      if (r.has("limits")) c.wantsStatistics.reset();
    }
    readCommon(r, c);
    try {
      checkCase(c);
    } catch (const Error& error) {
      r.fail(error.what());
    }
    cases.push_back(std::move(c));
  });
  if (cases.empty()) list.fail("has no case");
  return cases;
}

} // namespace chamfer
