// A side of a case, loaded: its frame, its part of it, and its pictures seed by seed.
#pragma once

#include "server/jobs/compare/compare_host.h"
#include "server/jobs/compare/result.h"
#include "server/jobs/seeds/seed_store.h"
#include "server/jobs/suite/suite.h"

#include <memory>

namespace chamfer {

/// Of a picture: its size, channels and bits.
Digest pictureDigest(const Picture& picture);

class SideSource {
public:
  /// Loads the scene or reads the image. Errors name the side. `store`: nothing: seeds are not kept.
  SideSource(const char* which, const SideChoice& choice, const CaseChoice& of, CompareHost& host,
             const SeedStore* store, std::string version);

  bool isRender() const { return choice_.isRender(); }
  /// Of the frame; 0x0 of a scene that takes the other side's.
  unsigned width() const { return width_; }
  unsigned height() const { return height_; }
  /// What there is of the frame.
  const TileRect& part() const { return part_; }
  /// An image with as many pixels as `tile` is that tile of a frame, and not a frame of its own.
  bool couldBe(const TileRect& tile) const;
  void beTile(unsigned width, unsigned height, const TileRect& tile);
  void takeFrame(unsigned width, unsigned height);

  const std::shared_ptr<const Scene>& scene() const { return scene_; } ///< of a render
  const TileRequest& request() const { return request_; }              ///< of a render: of seed 0
  const Picture& image() const { return image_; }                      ///< of an image

  /// Which pictures it gives for `crop`: the same key, the same bits in every seed. Of renders.
  Digest key(const TileRect& crop) const { return seedKey(requestOf(0, crop)); }
  /// Colour alone (3 channels) or with alpha (4): an image has its own, a render gives either.
  unsigned channels() const { return channels_; }
  void takeChannels(unsigned channels) { channels_ = channels; }

  /// The picture of `crop` (in the frame) of the k-th seed; of an image the same for all. Throws
  /// Error(OutOfRange) where samples of it were no finite numbers.
  Picture seed(unsigned k, const TileRect& crop) const;
  /// Label, settings, scene: what a report says before anything was rendered.
  SideResult describe() const;
  std::string name() const; ///< for messages: side a ("...")

private:
  TileRequest requestOf(unsigned k, const TileRect& crop) const;
  Digest seedKey(const TileRequest& request) const;
  Picture rendered(const TileRequest& request) const;

  const char* which_;
  const SideChoice& choice_;
  CompareHost& host_;
  const SeedStore* store_;
  std::string version_;
  std::shared_ptr<const Scene> scene_;
  TileRequest request_;
  Picture image_;
  unsigned width_ = 0, height_ = 0, channels_ = 3;
  TileRect part_;
};

} // namespace chamfer
