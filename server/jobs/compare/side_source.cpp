#include "server/jobs/compare/side_source.h"

#include "common/error.h"
#include "common/text.h"

#include <cstring>

namespace chamfer {
namespace {

constexpr const char* kNonFiniteSamples = "chamfer:non_finite_samples";

Picture pictureOf(const RenderResult& result) {
  Picture p;
  p.width = result.image.width;
  p.height = result.image.height;
  p.channels = 4;
  p.values = result.image.rgba;
  if (result.statistics.nonFiniteSamples > 0)
    p.about[kNonFiniteSamples] = std::to_string(result.statistics.nonFiniteSamples);
  return p;
}

Picture withoutAlpha(const Picture& picture) {
  Picture p = picture;
  p.channels = 3;
  p.values.resize(p.pixels() * 3);
  for (std::size_t i = 0; i < p.pixels(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      p.values[i * 3 + c] = picture.values[i * 4 + c];
  return p;
}

} // namespace

Digest pictureDigest(const Picture& picture) {
  std::string bytes = std::to_string(picture.width) + 'x' + std::to_string(picture.height) + 'x' +
                      std::to_string(picture.channels) + ':';
  const std::size_t head = bytes.size(), body = picture.values.size() * sizeof(float);
  bytes.resize(head + body);
  if (body > 0) std::memcpy(bytes.data() + head, picture.values.data(), body);
  return digestOf(bytes);
}

SideSource::SideSource(const char* which, const SideChoice& choice, const CaseChoice& of, CompareHost& host,
                       const SeedStore* store, std::string version)
    : which_(which), choice_(choice), host_(host), store_(store), version_(std::move(version)) {
  try {
    if (choice.kind == SideKind::Image) {
      image_ = readPicture(host.file(choice.source));
      width_ = image_.width;
      height_ = image_.height;
      channels_ = image_.channels;
    } else if (choice.isRender()) {
      scene_ = host.scene(choice);
      request_ = choice.request;
      RenderSettings& s = request_.settings;
      if (choice.kind == SideKind::Scene) {
        if (s.endSample == 0) s.endSample = of.samples;
        if (s.width == 0) s.width = of.width, s.height = of.height;
      }
      if (s.aov != Aov::Beauty) channels_ = 4; // their alpha says where anything is
      width_ = s.width;
      height_ = s.height;
    }
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::Cancelled) throw;
    throw Error(error.kind(), name() + ": " + error.what());
  }
  part_ = choice.kind == SideKind::Tile ? request_.tile : TileRect{0, 0, width_, height_};
}

std::string SideSource::name() const {
  return std::string("side ") + which_ + " (" + inQuotes(choice_.text, 200) + ')';
}

bool SideSource::couldBe(const TileRect& tile) const {
  return choice_.kind == SideKind::Image && width_ == tile.width && height_ == tile.height;
}

void SideSource::beTile(unsigned width, unsigned height, const TileRect& tile) {
  width_ = width;
  height_ = height;
  part_ = tile;
}

void SideSource::takeFrame(unsigned width, unsigned height) {
  request_.settings.width = width_ = width;
  request_.settings.height = height_ = height;
  part_ = {0, 0, width, height};
}

/// Of a scene only what is compared is rendered; a tile as its URL says.
TileRequest SideSource::requestOf(unsigned k, const TileRect& crop) const {
  TileRequest request = request_;
  if (choice_.kind == SideKind::Scene) request.tile = crop;
  request.settings.seed += k;
  request.format = ImageFormat::Exr;
  return request;
}

Digest SideSource::seedKey(const TileRequest& request) const {
  return digestOf(version_ + "|seed|" + scene_->id.hex() + '|' + canonicalSettings(request));
}

Picture SideSource::rendered(const TileRequest& request) const {
  const Digest key = seedKey(request);
  if (store_)
    if (std::optional<Picture> kept = store_->find(key); kept && kept->width == request.tile.width &&
                                                         kept->height == request.tile.height &&
                                                         kept->channels == 4)
      return std::move(*kept);
  Picture picture = pictureOf(host_.render(scene_, request));
  if (store_) store_->keep(key, picture);
  return picture;
}

Picture SideSource::seed(unsigned k, const TileRect& crop) const {
  const auto within = [&](const Picture& whole, const TileRect& part) {
    const TileRect own{crop.x - part.x, crop.y - part.y, crop.width, crop.height};
    return own == TileRect{0, 0, whole.width, whole.height} ? whole : cropped(whole, own);
  };
  if (!isRender()) return within(image_, part_);
  const TileRequest request = requestOf(k, crop);
  const Picture whole = rendered(request);
  if (const auto bad = whole.about.find(kNonFiniteSamples); bad != whole.about.end())
    throw Error(ErrorKind::OutOfRange, name() + ": seed " + std::to_string(request.settings.seed) + " has " +
                                           bad->second + " samples that are no finite numbers");
  const Picture picture = within(whole, request.tile);
  return channels_ == 3 ? withoutAlpha(picture) : picture;
}

SideResult SideSource::describe() const {
  SideResult result;
  result.label = choice_.text;
  result.isRender = isRender();
  if (!isRender()) return result;
  result.sceneId = scene_->id.hex();
  result.settings = settingsOf(request_);
  result.samplesPerSeed = request_.samples();
  return result;
}

} // namespace chamfer
