#include "server/jobs/compare/reference.h"

#include "common/text.h"

#include <charconv>

namespace chamfer {
namespace {

constexpr const char *kVersion = "chamfer:version", *kScene = "chamfer:scene",
                     *kSettings = "chamfer:settings", *kSeeds = "chamfer:seeds",
                     *kSamples = "chamfer:samples";

/// Without what may differ between a reference and its judge: sizes are compared elsewhere, and other seeds
/// and samples are another estimate of the same picture.
std::string settingsText(const SideSource& side) {
  TileRequest request = side.request();
  RenderSettings& s = request.settings;
  request.tile = {};
  s.seed = 0;
  s.firstSample = 0;
  s.endSample = 1;
  return canonicalSettings(request);
}

} // namespace

Picture referenceOf(Picture mean, const SideSource& side, unsigned seeds, const std::string& version) {
  mean.about[kVersion] = version;
  mean.about[kScene] = side.scene()->id.hex();
  mean.about[kSettings] = settingsText(side);
  mean.about[kSeeds] = std::to_string(side.request().settings.seed) + "-" +
                       std::to_string(std::uint64_t{side.request().settings.seed} + seeds);
  mean.about[kSamples] = std::to_string(std::uint64_t{seeds} * side.request().samples());
  return mean;
}

std::string staleness(const Picture& reference, const SideSource& side, const std::string& version) {
  const auto of = [&](const char* key) {
    const auto found = reference.about.find(key);
    return found == reference.about.end() ? std::string() : found->second;
  };
  std::string why;
  const auto add = [&](const std::string& part) { why += (why.empty() ? "made " : ", ") + part; };
  if (const std::string v = of(kVersion); !v.empty() && v != version)
    add("by version " + printable(v) + " (this is " + version + ")");
  if (const std::string id = of(kScene); !id.empty() && id != side.scene()->id.hex())
    add("of another scene (" + printable(id) + ", now " + side.scene()->id.hex() + ")");
  if (const std::string s = of(kSettings); !s.empty() && s != settingsText(side)) add("with other settings");
  return why;
}

unsigned samplesOf(const Picture& reference) {
  const auto found = reference.about.find(kSamples);
  unsigned samples = 0;
  if (found != reference.about.end())
    std::from_chars(found->second.data(), found->second.data() + found->second.size(), samples);
  return samples;
}

} // namespace chamfer
