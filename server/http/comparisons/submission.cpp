#include "server/http/comparisons/submission.h"

#include "common/digest.h"
#include "common/error.h"
#include "common/text.h"
#include "server/http/routes/problem.h"
#include "server/http/schema/limits.h"
#include "server/http/version.h"
#include "server/jobs/suite/canonical.h"
#include "server/render/image/image_io.h"
#include "server/render/request/parameter_error.h"
#include "server/render/request/parameters.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace chamfer::http {
namespace {

using Json = nlohmann::ordered_json;

/// Bytes of a kept seed's pixel, before compression.
constexpr std::uint64_t kSeedPixelBytes = 4 * sizeof(float);

[[noreturn]] void refuse(const std::string& place, std::uint64_t value, std::uint64_t most,
                         const std::string& what) {
  throw ParameterError(ErrorKind::OutOfRange,
                       what + ": " + std::to_string(value) + ", at most " + std::to_string(most), place,
                       std::to_string(value), "{\"maximum\":" + std::to_string(most) + "}");
}

struct Extent {
  std::uint64_t width = 0, height = 0;
  std::uint64_t pixels() const { return width * height; }
};

class Reader {
public:
  Reader(const Parts& parts, const JobOptions& options) : parts_(parts), options_(options) {}

  void read(const std::vector<CaseChoice>& cases) {
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const CaseChoice& c = cases[i];
      const std::string place = "cases[" + std::to_string(i) + "]";
      CaseOrigins origins{originOf(c.a, place + ".a"), originOf(c.b, place + ".b"), {}};
      if (const std::string mask = c.region.mask.string(); !mask.empty())
        origins.mask = fileOrigin(mask, place + ".mask");
      addWork(c, place);
      text_ += '\n' + canonicalCase(c, origins);
    }
  }

  const std::string& text() const { return text_; }
  const JobOrigins& origins() const { return origins_; }

private:
  std::string originOf(const SideChoice& side, const std::string& place) {
    if (side.kind == SideKind::Digest) return {};
    if (side.kind == SideKind::Image) return fileOrigin(side.source, place);
    if (side.upAxis)
      throw ParameterError(ErrorKind::OutOfRange,
                           "the server has loaded its meshes with one axis up; leave up_axis out", place,
                           side.text);
    if (const auto known = origins_.scenes.find(side.source); known != origins_.scenes.end())
      return known->second;
    const auto entry = findScene(parts_.catalogue, side.source);
    if (!entry) {
      if (!parts_.catalogue.loaded()) throw ProblemError(busy("the scenes are being loaded", 1));
      throw ParameterError(ErrorKind::NotFound,
                           "there is no scene of this name or id; GET /v1/scenes lists them", place,
                           side.source);
    }
    return origins_.scenes[side.source] = readyScene(*entry)->id.hex();
  }

  std::string fileOrigin(const std::string& name, const std::string& place) {
    if (const auto known = origins_.files.find(name); known != origins_.files.end()) return known->second;
    try {
      const auto file = servedFile(parts_.catalogue.root(), name);
      const auto [width, height] = imageSize(file, name);
      if (const std::uint64_t pixels = std::uint64_t{width} * height; pixels > kMaxFramePixels)
        refuse(place, pixels, kMaxFramePixels, "pixels of an image");
      images_[name] = {width, height};
      return origins_.files[name] = fileDigest(file);
    } catch (const ParameterError&) {
      throw;
    } catch (const Error& error) {
      throw ParameterError(error.kind(), place + ": " + error.what(), place, name);
    }
  }

  /// What there is of a side; 0x0: of a digest, and of a scene that takes the other side's size.
  Extent extentOf(const SideChoice& side, const SideChoice& other, const CaseChoice& c) const {
    if (side.kind == SideKind::Digest) return {};
    if (side.kind == SideKind::Image) return images_.at(side.source);
    const TileRect tile = resolvedRequest(side, other, c).tile;
    return {tile.width, tile.height};
  }

  void addWork(const CaseChoice& c, const std::string& place) {
    Extent a = extentOf(c.a, c.b, c), b = extentOf(c.b, c.a, c);
    if (a.pixels() == 0) a = b;
    if (b.pixels() == 0) b = a;
    const std::uint64_t compared = c.region.crop ? std::uint64_t{c.region.crop->width} * c.region.crop->height
                                                 : std::min(a.pixels(), b.pixels());
    pixels_ += compared;
    if (pixels_ > kMaxComparisonPixels)
      refuse(place, pixels_, kMaxComparisonPixels,
             "pixels that are compared, of the cases so far together, give a smaller frame or a crop, or "
             "submit cases apart");
    for (const auto& [side, other] : {std::pair{&c.a, &c.b}, std::pair{&c.b, &c.a}}) {
      if (!side->isRender()) continue;
      const std::uint64_t seeds = std::max(1u, c.budget());
      const std::uint64_t rendered =
          side->kind == SideKind::Tile ? extentOf(*side, *other, c).pixels() : compared;
      samples_ += rendered * seeds * resolvedRequest(*side, *other, c).samples();
      seedBytes_ += rendered * seeds * kSeedPixelBytes;
    }
    if (samples_ > kMaxComparisonSamples)
      refuse(place, samples_, kMaxComparisonSamples,
             "pixels times samples times seeds of both sides, of the cases so far together");
    if (seedBytes_ > options_.bytes / 2)
      refuse(place, seedBytes_, options_.bytes / 2,
             "bytes that rendered seeds may take (16 a pixel), of the cases so far together");
  }

  const Parts& parts_;
  const JobOptions& options_;
  JobOrigins origins_;
  std::map<std::string, Extent> images_;
  std::uint64_t pixels_ = 0, samples_ = 0, seedBytes_ = 0;
  std::string text_;
};

} // namespace

Submission readSubmission(const std::string& body, const Parts& parts, const JobOptions& options) {
  if (body.size() > kMaxSuiteBytes)
    throw Error(ErrorKind::PayloadTooLarge, "the suite has " + std::to_string(body.size()) +
                                                " bytes, at most " + std::to_string(kMaxSuiteBytes) +
                                                " are read");
  const std::vector<CaseChoice> cases = parseSuite(body, "the body");
  if (cases.size() > kMaxCases) refuse("cases", cases.size(), kMaxCases, "cases of one job");
  Reader reader(parts, options);
  reader.read(cases);

  Json request{{"schema", "chamfer.job/1"}, {"version", kVersion}};
  request["scenes"] = reader.origins().scenes;
  request["files"] = reader.origins().files;
  request["suite"] = Json::parse(body);
  return {digestOf("comparison|" + std::string(kVersion) + reader.text()).hex(),
          request.dump(1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

JobRequest readJobRequest(const std::string& text) {
  try {
    const Json json = Json::parse(text);
    JobRequest request;
    request.version = json.at("version").get<std::string>();
    request.origins.scenes = json.at("scenes").get<std::map<std::string, std::string>>();
    request.origins.files = json.at("files").get<std::map<std::string, std::string>>();
    request.cases = parseSuite(json.at("suite").dump(), "request.json");
    return request;
  } catch (const Json::exception&) {
    throw Error(ErrorKind::Malformed, "request.json is damaged");
  }
}

} // namespace chamfer::http
