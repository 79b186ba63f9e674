// LDR-FLIP: the error map of two pictures as a display shows them (see flip.h for the papers).
#pragma once

#include "server/jobs/image/picture.h"

#include <optional>
#include <vector>

namespace chamfer {

/// A picture as a display shows it: linear RGB, 0..1.
class Shown {
public:
  /// Without an exposure values are clamped to 0..1; with one (in stops) they are tone mapped by the ACES
  /// curve of the HDR paper. Keeps a reference.
  Shown(const Picture& picture, std::optional<double> exposure);

  unsigned width() const { return picture_.width; }
  unsigned height() const { return picture_.height; }
  /// Row y of each channel: width() values.
  void row(unsigned y, float* r, float* g, float* b) const;
  /// Two pictures of one shape that are shown alike.
  bool sameRow(const Shown& o, unsigned y) const;

private:
  float shown(float value) const;

  const Picture& picture_;
  bool toneMapped_;
  double scale_ = 1;
};

/// The larger root of tone curve = 0.85: what the exposures of HDR-FLIP are made of.
double toneCurveShoulder();

/// Raises `map` ([height][width]) to the error where that is larger. Pixels per degree from 1 to 1000.
void raiseToLdrFlip(const Shown& a, const Shown& b, double pixelsPerDegree, std::vector<float>& map);

} // namespace chamfer
