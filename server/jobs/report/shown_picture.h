// Pictures as a report shows them: not too large, as PNG.
#pragma once

#include "server/jobs/compare/result.h"
#include "server/render/path/render.h"

#include <string>
#include <vector>

namespace chamfer {

struct ShownPicture {
  Image image;               ///< linear, opaque
  unsigned factor = 1;       ///< pixels of the picture that became one, a side
  std::size_t notFinite = 0; ///< values of the picture; such pixels are drawn in kNotFiniteColor
};

/// How many pixels must become one (a side) so that the longer side has at most `most`.
unsigned reductionFor(unsigned width, unsigned height, unsigned most);

/// RGB or grey, alpha left out; means of factor x factor pixels, of linear light. Values are not clamped.
ShownPicture shownPicture(const Picture& picture, unsigned factor);

/// Decades below the largest difference that the heat map tells apart.
inline constexpr double kHeatDecades = 3;

struct HeatMap {
  ShownPicture picture;
  double largest = 0;      ///< of the pixels that count, over all channels; what is drawn brightest
  bool hasLeftOut = false; ///< pixels that the region leaves out, which are drawn grey
};

/// Of the largest |a - b| over the channels, on a logarithmic scale; of factor x factor pixels the largest.
/// Both pictures of one size and number of channels.
HeatMap heatMapOf(const Picture& a, const Picture& b, const Region& region, unsigned factor);

/// "data:image/png;base64,...".
std::string pngUri(const Image& image);

/// Sides, in pixels, to which pictures are reduced so that a report stays usable: those of cases that are the
/// same are the first to lose.
struct MostSides {
  unsigned same, other;
};
MostSides mostSidesFor(const SuiteResult& result);

} // namespace chamfer
