// Tiles are cut into fixed blocks that threads take in any order. The paths of a block travel together
// (wavefront), yet each gets what it would get alone, and a pixel sums its own in the order of its samples:
// the result depends on neither blocks nor threads.
#include "server/render/path/aov.h"
#include "server/render/path/camera.h"
#include "server/render/path/path_tracer.h"
#include "server/render/path/pixel_filter.h"
#include "server/render/path/prepared_scene.h"
#include "server/render/wavefront/wavefront.h"

#include "common/error.h"

#include <algorithm>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace chamfer {

RayCount& RayCount::operator+=(const RayCount& o) {
  traced += o.traced;
  hits += o.hits;
  rounded += o.rounded;
  return *this;
}

RayStatistics& RayStatistics::operator+=(const RayStatistics& o) {
  camera += o.camera;
  bounce += o.bounce;
  shadow += o.shadow;
  nonFiniteSamples += o.nonFiniteSamples;
  return *this;
}

namespace {

constexpr unsigned kBlock = 16; ///< pixels along a block's side

void validate(const RenderSettings& s, const TileRect& t) {
  const auto fail = [](const std::string& what) { throw Error(ErrorKind::OutOfRange, what); };
  if (s.width == 0 || s.height == 0) fail("the frame must have at least one pixel");
  if (t.width == 0 || t.height == 0) fail("the tile must have at least one pixel");
  if (t.x >= s.width || t.y >= s.height || t.width > s.width - t.x || t.height > s.height - t.y)
    fail("the tile " + std::to_string(t.x) + "," + std::to_string(t.y) + "," + std::to_string(t.width) + "," +
         std::to_string(t.height) + " is not within the frame of " + std::to_string(s.width) + "x" +
         std::to_string(s.height));
  if (!(s.indirectClamp >= 0)) fail("the clamp of indirect light must not be below 0");
  if (s.firstSample >= s.endSample)
    fail("the sample range " + std::to_string(s.firstSample) + "-" + std::to_string(s.endSample) +
         " is empty");
}

/// Samples of each of a block's pixels that travel together.
unsigned samplesAtOnce(std::size_t pixels) {
  return unsigned(std::max<std::size_t>(1, Wavefront::kPaths / pixels));
}

class TileJob {
public:
  TileJob(const PreparedScene& prepared, const RenderSettings& settings, const TileRect& tile,
          const RenderControl& control)
      : surfaces_(prepared.surfaces()), tracer_(prepared.tracer()), settings_(settings), tile_(tile),
        control_(control), camera_(settings.camera ? *settings.camera : prepared.scene().camera,
                                   settings.width, settings.height),
        paths_(surfaces_, tracer_, prepared.lights(), settings.maxBounces, settings.indirectClamp),
        columns_((tile.width + kBlock - 1) / kBlock),
        blocks_(columns_ * ((tile.height + kBlock - 1) / kBlock)) {
    // All rays of a pinhole start at the eye, those of a lens near it: what that is in is mostly asked once.
    const Camera& camera = settings.camera ? *settings.camera : prepared.scene().camera;
    from_ = tracer_.stateAt(camera.eye);
    oneState_ = !camera_.usesLens() || tracer_.sameStateAround(camera.eye, camera.apertureDiameter / 2);
    result_.image = {tile.width, tile.height, std::vector<float>(std::size_t(tile.width) * tile.height * 4)};
  }

  RenderResult run() {
    const unsigned cores = std::max(1u, std::thread::hardware_concurrency());
    const unsigned threads = std::min(control_.threads ? control_.threads : cores, blocks_);
    {
      std::vector<std::jthread> helpers;
      for (unsigned i = 1; i < threads; ++i)
        helpers.emplace_back([this] { work(); });
      work();
    }
    if (failure_) std::rethrow_exception(failure_);
    return std::move(result_);
  }

private:
  void work() {
    RayStatistics statistics;
    Wavefront wave(paths_);
    try {
      for (unsigned block; !stop_ && (block = next_++) < blocks_;) {
        renderBlock(block, statistics, wave);
        if (control_.progress) control_.progress(double(++done_) / blocks_);
      }
    } catch (...) {
      stop_ = true;
      const std::lock_guard lock(mutex_);
      if (!failure_) failure_ = std::current_exception();
    }
    const std::lock_guard lock(mutex_);
    result_.statistics += statistics;
  }

  /// A pixel of the block that is being rendered.
  struct Pixel {
    unsigned x, y; ///< of the tile
    double sum[4] = {};
  };

  void renderBlock(unsigned block, RayStatistics& statistics, Wavefront& wave) {
    const unsigned x0 = block % columns_ * kBlock, y0 = block / columns_ * kBlock;
    std::vector<Pixel> pixels;
    for (unsigned y = y0; y < std::min(y0 + kBlock, tile_.height); ++y)
      for (unsigned x = x0; x < std::min(x0 + kBlock, tile_.width); ++x)
        pixels.push_back({x, y});
    const unsigned atOnce = samplesAtOnce(pixels.size());
    for (unsigned first = settings_.firstSample; first < settings_.endSample;) {
      if (control_.cancelled && (stop_ || control_.cancelled()))
        throw Error(ErrorKind::Cancelled, "the render was cancelled");
      const unsigned end = first + std::min(atOnce, settings_.endSample - first);
      if (settings_.aov == Aov::Beauty)
        renderBeauty(pixels, first, end, statistics, wave);
      else
        renderAov(pixels, first, end, statistics);
      first = end;
    }
    const double count = settings_.endSample - settings_.firstSample;
    for (const Pixel& p : pixels)
      for (std::size_t k = 0; k < 4; ++k)
        result_.image.rgba[(std::size_t(p.y) * tile_.width + p.x) * 4 + k] = float(p.sum[k] / count);
  }

  void renderBeauty(std::vector<Pixel>& pixels, unsigned first, unsigned end, RayStatistics& statistics,
                    Wavefront& wave) {
    wave.clear();
    std::deque<PathState> states; // stay where they are
    for (unsigned s = first; s < end; ++s)
      for (const Pixel& p : pixels) {
        const Sampler sampler(tile_.x + p.x, tile_.y + p.y, s, settings_.seed);
        const Ray ray = cameraRay(p, sampler);
        wave.add(ray, oneState_ ? from_ : states.emplace_back(tracer_.stateAt(ray.origin)), sampler);
      }
    wave.follow(statistics);
    for (std::size_t i = 0; i < (end - first) * pixels.size(); ++i)
      add(pixels[i % pixels.size()], {wave.light(i), 1}, statistics);
  }

  void renderAov(std::vector<Pixel>& pixels, unsigned first, unsigned end, RayStatistics& statistics) {
    for (unsigned s = first; s < end; ++s)
      for (Pixel& p : pixels) {
        const Sampler sampler(tile_.x + p.x, tile_.y + p.y, s, settings_.seed);
        const Ray ray = cameraRay(p, sampler);
        add(p,
            aovSample(surfaces_, tracer_, settings_.aov, ray, oneState_ ? from_ : tracer_.stateAt(ray.origin),
                      sampler, statistics),
            statistics);
      }
  }

  Ray cameraRay(const Pixel& p, const Sampler& sampler) const {
    const Float2 offset = PixelFilter::instance().sample(sampler.pair(kPixelPair));
    const Float2 lens = camera_.usesLens() ? sampler.pair(kLensPair) : Float2{};
    return camera_.ray(tile_.x + p.x + 0.5 + offset.x, tile_.y + p.y + 0.5 + offset.y, lens);
  }

  static void add(Pixel& p, const AovSample& sample, RayStatistics& statistics) {
    p.sum[3] += sample.coverage;
    if (!isFinite(sample.value)) {
      ++statistics.nonFiniteSamples;
      return;
    }
    p.sum[0] += sample.value.r;
    p.sum[1] += sample.value.g;
    p.sum[2] += sample.value.b;
  }

  const Surfaces& surfaces_;
  const Tracer& tracer_;
  const RenderSettings& settings_;
  const TileRect& tile_;
  const RenderControl& control_;
  CameraRays camera_;
  PathState from_;
  bool oneState_; ///< of all camera rays
  PathTracer paths_;
  unsigned columns_, blocks_;
  RenderResult result_;
  std::atomic<unsigned> next_{0}, done_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  std::exception_ptr failure_;
};

} // namespace

std::uint64_t looksOfRender(const RenderSettings& s, const TileRect& tile) {
  validate(s, tile);
  std::uint64_t looks = 0;
  const auto inBlock = [](unsigned size, unsigned from) { return std::min(kBlock, size - from); };
  for (unsigned y = 0; y < tile.height; y += kBlock)
    for (unsigned x = 0; x < tile.width; x += kBlock) {
      const unsigned atOnce = samplesAtOnce(std::size_t(inBlock(tile.width, x)) * inBlock(tile.height, y));
      looks += (std::uint64_t(s.endSample) - s.firstSample + atOnce - 1) / atOnce;
    }
  return looks;
}

RenderResult renderTile(const PreparedScene& prepared, const RenderSettings& settings, const TileRect& tile,
                        const RenderControl& control) {
  validate(settings, tile);
  return TileJob(prepared, settings, tile, control).run();
}

} // namespace chamfer
