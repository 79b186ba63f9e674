#include "server/render/material/albedo_table.h"

#include "server/render/material/albedo_grid.h"

namespace chamfer {
namespace {

using namespace albedo_grid;

#include "albedo_tables.inc"

float lerp(float a, float b, float t) { return a + (b - a) * t; }

/// The cell of a place on an axis of `nodes`; `share`: how far it is to the cell's upper node.
int cellOf(float place, int nodes, float& share) {
  const int cell = std::min(int(place), nodes - 2);
  share = place - float(cell);
  return cell;
}

/// Within a column of cosines.
struct CosineCell {
  explicit CosineCell(float mu) : cell(cellOf(cosinePlace(mu), kCosines, share)) {}
  float in(const float* column) const { return lerp(column[cell], column[cell + 1], share); }
  float share;
  int cell;
};

} // namespace

ReflectionAlbedo::ReflectionAlbedo(float roughness)
    : row_(cellOf(roughnessPlace(roughness), kRoughnesses, share_)) {}

CoatAlbedo ReflectionAlbedo::directional(float mu) const {
  const CosineCell cosine(mu);
  const int low = row_ * kCosines, high = low + kCosines;
  return {lerp(cosine.in(kMirrored + low), cosine.in(kMirrored + high), share_),
          lerp(cosine.in(kWhite + low), cosine.in(kWhite + high), share_)};
}

CoatAlbedo ReflectionAlbedo::average() const {
  return {lerp(kMirroredAverage[row_], kMirroredAverage[row_ + 1], share_),
          lerp(kWhiteAverage[row_], kWhiteAverage[row_ + 1], share_)};
}

const ReflectionTables& reflectionTables() {
  static constexpr ReflectionTables tables{kMirrored, kWhite, kMirroredAverage, kWhiteAverage};
  return tables;
}

GlassAlbedo::GlassAlbedo(float roughness, float eta)
    : near_(eta < 1), far_(!near_), row_(cellOf(roughnessPlace(roughness), kRoughnesses, rowShare_)),
      index_(cellOf(indexPlace(eta), kIndices, indexShare_)) {}

float GlassAlbedo::directional(int side, float mu) const {
  const CosineCell cosine(mu);
  const auto at = [&](int index) {
    const float* column = kGlass + ((side * kIndices + index) * kRoughnesses + row_) * kCosines;
    return lerp(cosine.in(column), cosine.in(column + kCosines), rowShare_);
  };
  return lerp(at(index_), at(index_ + 1), indexShare_);
}

float GlassAlbedo::average(int side) const {
  const auto at = [&](int index) {
    const float* means = kGlassAverage + (side * kIndices + index) * kRoughnesses + row_;
    return lerp(means[0], means[1], rowShare_);
  };
  return lerp(at(index_), at(index_ + 1), indexShare_);
}

float GlassAlbedo::thinFresnelAverage() const {
  return lerp(kFresnelAverage[index_], kFresnelAverage[index_ + 1], indexShare_);
}

} // namespace chamfer
