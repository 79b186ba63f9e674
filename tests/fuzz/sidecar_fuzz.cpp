// The loader of sidecars survives any bytes: it refuses them, or accepts a rounding on which every query ends
// and stays in bounds.
#include "common/error.h"
#include "common/ray_query.h"
#include "common/sidecar.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <vector>

namespace {

/// Repairs the checksums of mutated bytes, so that the checks behind them are reached.
std::vector<std::byte> withChecksums(std::span<const std::byte> bytes) {
  constexpr std::size_t kPrefix = 80, kSections = 8, kTable = kPrefix + 16 * kSections, kHeader = kTable + 8;
  constexpr std::size_t kElement[kSections] = {sizeof(chamfer::SolidRecord),  sizeof(chamfer::FacetRecord),
                                               sizeof(chamfer::SphereRecord), sizeof(chamfer::PackedHalfEdge),
                                               sizeof(chamfer::WideHalfEdge), sizeof(chamfer::TreeRoot),
                                               sizeof(chamfer::TreeNode),     sizeof(std::uint32_t)};
  std::vector<std::byte> fixed(bytes.begin(), bytes.end());
  if (fixed.size() < kHeader) return fixed;
  std::size_t offset = kHeader;
  for (std::size_t s = 0; s < kSections; ++s) {
    std::uint64_t count = 0;
    std::memcpy(&count, fixed.data() + kPrefix + 16 * s, 8);
    if (count > (fixed.size() - offset) / kElement[s]) break;
    const std::size_t size = (std::size_t(count) * kElement[s] + 7) / 8 * 8;
    if (size > fixed.size() - offset) break;
    const std::uint64_t sum = chamfer::checksumOf(std::span(fixed).subspan(offset, size));
    std::memcpy(fixed.data() + kPrefix + 16 * s + 8, &sum, 8);
    offset += size;
  }
  const std::uint64_t sum = chamfer::checksumOf(std::span(fixed).first(kTable));
  std::memcpy(fixed.data() + kTable, &sum, 8);
  return fixed;
}

void load(std::span<const std::byte> bytes) {
  try {
    const auto rounding = chamfer::parseSidecar(bytes);
    const chamfer::RoundingView& view = rounding->view();
    for (std::uint32_t f = 0; f < view.facets.size() && f < 16; ++f) {
      const std::uint32_t solid = view.facets[f].solid;
      (void)chamfer::detect(view, solid, f, {0.1, 0.2, 0.3});
      (void)chamfer::interval(view, solid, {{3, 2, 1}, {-3, -2.1, -0.9}}, 0);
    }
  } catch (const chamfer::Error&) {
  }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  load(bytes);
  load(withChecksums(bytes));
  return 0;
}
