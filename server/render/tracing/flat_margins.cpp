#include "server/render/tracing/flat_margins.h"

#include "common/core_view.h"

#include <algorithm>
#include <cmath>
#include <thread>

namespace chamfer {
namespace {

/// Facets with more sides than this are left to their trees: the work for a triangle grows with the sides.
constexpr std::size_t kMostSides = 64;
/// Triangles that are worth a thread.
constexpr std::size_t kShare = 8192;
/// A barycentric coordinate may be off by this.
constexpr double kDoubt = 1.0 / TriangleFlat::kUnit;

/// A border of the flat: the signed distance inside it of each of the triangle's vertices.
using Border = std::array<double, 3>;
/// Barycentric coordinates, the least of a smaller triangle's.
using Margins = std::array<double, 3>;
/// Those of the triangle and all around it that may be meant.
constexpr Margins kEnlarged{-kDoubt, -kDoubt, -kDoubt};

/// The margins' corner `k` keeps the other two vertices' margins and has the rest itself: how far inside the
/// border is it?
double depthOfCorner(const Border& border, const Margins& margins, std::size_t k) {
  const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
  return border[k] + margins[i] * (border[i] - border[k]) + margins[j] * (border[j] - border[k]);
}

/// Raises margins until all three corners are inside all borders, each time the one that brings most. Whether
/// that succeeds is for the caller to check.
void raiseMargins(const std::vector<Border>& borders, Margins& margins) {
  for (int pass = 0; pass < 4; ++pass) {
    bool raised = false;
    for (const Border& border : borders)
      for (std::size_t k = 0; k < 3; ++k) {
        const double depth = depthOfCorner(border, margins, k);
        if (depth >= 0) continue;
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        const std::size_t most = border[i] > border[j] ? i : j;
        const double gain = border[most] - border[k];
        if (!(gain > 0)) return;
        margins[most] += -depth / gain;
        raised = true;
      }
    if (!raised || margins[0] + margins[1] + margins[2] >= 1) return;
  }
}

/// Works on one triangle after the other; keeps what it knows of the facet while that stays the same.
class Worker {
public:
  Worker(const RoundingView& view, const TriangleMesh& mesh) : view_(view), mesh_(mesh) {}

  TriangleFlat of(std::size_t t) {
    const std::uint32_t facet = view_.facetOfTriangle[t];
    if (facet == kNone) return {};
    if (facet != facet_) load(facet);
    TriangleFlat flat;
    flat.facet = facet;
    if (!corners_.empty()) fill(flat, mesh_.triangles[t]);
    return flat;
  }

private:
  void load(std::uint32_t facet) {
    facet_ = facet;
    const FacetRecord& record = view_.facets[facet];
    const SolidRecord& solid = view_.solids[record.solid];
    origin_ = {solid.origin[0], solid.origin[1], solid.origin[2]};
    normal_ = Vector3(record.normal);
    offset_ = record.offset;
    corners_.clear();
    if (record.vanished()) return;
    const CoreView core(view_, record.solid);
    const std::uint32_t first = record.firstHalfEdge(), local = core.halfEdge(first).facet;
    for (std::uint32_t h = first; h < core.halfEdgeCount() && core.halfEdge(h).facet == local; ++h) {
      if (corners_.size() == kMostSides) {
        corners_.clear();
        return;
      }
      corners_.push_back(core.start(h));
    }
  }

  void fill(TriangleFlat& flat, const std::array<std::uint32_t, 3>& vertices) {
    std::array<Vector3, 3> at;
    double offPlane = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      at[k] = Vector3(mesh_.positions[vertices[k]]) - origin_;
      offPlane = std::max(offPlane, std::abs(dot(normal_, at[k]) - offset_));
    }
    collectBorders(at);
    Margins margins = kEnlarged;
    raiseMargins(borders_, margins);
    std::array<std::uint8_t, 3> units;
    for (std::size_t k = 0; k < 3; ++k) {
      const double up = std::ceil((margins[k] + kDoubt) * TriangleFlat::kUnit);
      if (!(up < TriangleFlat::kNever)) return;
      units[k] = std::uint8_t(up);
      margins[k] = up / TriangleFlat::kUnit - kDoubt;
    }
    if (!inside(margins)) return;
    // A third of what may be off is for the place that is met, one for the vertices along the triangle, and
    // one for their height over the facet's plane, seen at the flattest.
    const double share = leastHeight(at) * kDoubt / 3;
    if (offPlane * TriangleFlat::kSteepest > share) return;
    const double slack = std::floor(std::log2(share));
    if (!(slack > -126 && slack < 127)) return;
    flat.margins = units;
    flat.slack = std::int8_t(slack);
  }

  /// Those that the triangle, enlarged by what may be off, is not wholly inside of.
  void collectBorders(const std::array<Vector3, 3>& at) {
    borders_.clear();
    for (std::size_t c = 0; c < corners_.size(); ++c) {
      const Vector3 along = corners_[c + 1 < corners_.size() ? c + 1 : 0] - corners_[c];
      const double squared = lengthSquared(along);
      if (!(squared > 0)) continue;
      const Vector3 inward = cross(normal_, along) / std::sqrt(squared);
      Border border;
      for (std::size_t k = 0; k < 3; ++k)
        border[k] = dot(inward, at[k] - corners_[c]);
      if (!inside(border, kEnlarged)) borders_.push_back(border);
    }
  }

  static bool inside(const Border& border, const Margins& margins) {
    return depthOfCorner(border, margins, 0) >= 0 && depthOfCorner(border, margins, 1) >= 0 &&
           depthOfCorner(border, margins, 2) >= 0;
  }
  bool inside(const Margins& margins) const {
    return margins[0] + margins[1] + margins[2] < 1 &&
           std::all_of(borders_.begin(), borders_.end(), [&](const Border& b) { return inside(b, margins); });
  }

  static double leastHeight(const std::array<Vector3, 3>& at) {
    const double longest =
        std::max({lengthSquared(at[1] - at[0]), lengthSquared(at[2] - at[1]), lengthSquared(at[0] - at[2])});
    return length(cross(at[1] - at[0], at[2] - at[0])) / std::sqrt(longest);
  }

  const RoundingView& view_;
  const TriangleMesh& mesh_;
  std::uint32_t facet_ = kNone;
  Vector3 origin_, normal_;
  double offset_ = 0;
  std::vector<Vector3> corners_; ///< of the flat, without its height over E; empty: nothing is surely flat
  std::vector<Border> borders_;
};

} // namespace

std::vector<TriangleFlat> flatMargins(const RoundingView& view, const TriangleMesh& mesh) {
  std::vector<TriangleFlat> flats(view.facetOfTriangle.size());
  const std::size_t threads =
      std::clamp<std::size_t>(flats.size() / kShare, 1, std::max(1u, std::thread::hardware_concurrency()));
  const auto work = [&](std::size_t part) {
    Worker worker(view, mesh);
    for (std::size_t t = flats.size() * part / threads; t < flats.size() * (part + 1) / threads; ++t)
      flats[t] = worker.of(t);
  };
  std::vector<std::jthread> others;
  for (std::size_t part = 1; part < threads; ++part)
    others.emplace_back(work, part);
  work(0);
  others.clear(); // joins
  return flats;
}

} // namespace chamfer
