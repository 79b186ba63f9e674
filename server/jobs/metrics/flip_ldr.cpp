#include "server/jobs/metrics/flip_ldr.h"

#include "server/jobs/metrics/flip_filters.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

namespace chamfer {
namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

/// Linear sRGB to CIE XYZ (D65), each of X, Y, Z relative to white's.
constexpr Matrix whiteRelative() {
  Matrix m = {{{10135552. / 24577794, 8788810. / 24577794, 4435075. / 24577794},
               {2613072. / 12288897, 8788810. / 12288897, 887015. / 12288897},
               {1425312. / 73733382, 8788810. / 73733382, 70074185. / 73733382}}};
  for (auto& row : m) {
    const double white = row[0] + row[1] + row[2];
    for (double& v : row)
      v /= white;
  }
  return m;
}

constexpr Matrix inverseOf(const Matrix& m) {
  const auto minor = [&](std::size_t r, std::size_t c) {
    const std::size_t r1 = (r + 1) % 3, r2 = (r + 2) % 3, c1 = (c + 1) % 3, c2 = (c + 2) % 3;
    return m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1];
  };
  const double determinant = m[0][0] * minor(0, 0) + m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
  Matrix result{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t c = 0; c < 3; ++c)
      result[r][c] = minor(c, r) / determinant;
  return result;
}

constexpr Matrix kXyz = whiteRelative(), kRgb = inverseOf(kXyz);

inline float dot(const std::array<double, 3>& row, float a, float b, float c) {
  return float(row[0]) * a + float(row[1]) * b + float(row[2]) * c;
}
inline float clamped(float v) { return v < 0 ? 0 : v > 1 ? 1 : v; }

/// For 0.008 to 1 and somewhat beyond; exact but for a float's last bits. std::cbrt is not vectorised.
inline float cubeRoot(float v) {
  float root = std::bit_cast<float>(std::bit_cast<std::uint32_t>(v) / 3 + 0x2a514067u);
  for (int i = 0; i < 2; ++i) { // Halley's iteration
    const float cube = root * root * root;
    root = root * ((cube + 2 * v) / (2 * cube + v));
  }
  return root;
}

/// The lightness curve of CIELAB.
inline float labCurve(float v) {
  constexpr float kDelta = 6.f / 29;
  constexpr float kLinear = kDelta * kDelta * kDelta;
  const float root = cubeRoot(v > kLinear ? v : kLinear), line = v / (3 * kDelta * kDelta) + 4.f / 29;
  return v > kLinear ? root : line;
}

struct Lab {
  float l, a, b;
};
/// CIELAB, a and b scaled by the lightness (Hunt's effect), of linear RGB in 0..1.
inline Lab huntLab(float r, float g, float b) {
  const float x = labCurve(dot(kXyz[0], r, g, b)), y = labCurve(dot(kXyz[1], r, g, b)),
              z = labCurve(dot(kXyz[2], r, g, b));
  const float lightness = 116 * y - 16;
  return {lightness, 0.01f * lightness * 500 * (x - y), 0.01f * lightness * 200 * (y - z)};
}

/// HyAB: city-block in lightness, Euclidean in a and b.
inline float distance(const Lab& p, const Lab& q) {
  return std::abs(p.l - q.l) + std::sqrt((p.a - q.a) * (p.a - q.a) + (p.b - q.b) * (p.b - q.b));
}

/// HyAB's exponent; the share of the largest distance that is spread over most of the errors, and how much
/// that is; the exponent of features (HPG 2020, section 5).
constexpr float kColorExponent = 0.7f, kColorShare = 0.4f, kColorMost = 0.95f, kFeatureExponent = 0.5f;

float colorError(float hyab) {
  static const float largest = std::pow(distance(huntLab(0, 1, 0), huntLab(0, 0, 1)), kColorExponent);
  const float knee = kColorShare * largest, error = std::pow(hyab, kColorExponent);
  return error < knee ? error * (kColorMost / knee)
                      : kColorMost + (error - knee) / (largest - knee) * (1 - kColorMost);
}

/// Of one row of one picture: the colours that the eye sees, and how strong edges and points are.
struct SeenRow {
  std::vector<float> l, a, b, edge, point;
};

/// Filters a picture row by row. Rows filtered horizontally are kept as long as rows near them need them.
class Seeing {
public:
  Seeing(const Shown& shown, const FlipFilters& filters)
      : shown_(shown), filters_(filters), stride_((shown.width() + kFlipLanes - 1) / kFlipLanes * kFlipLanes),
        kept_(2 * filters.radius + 1) {
    for (Kept& kept : kept_)
      for (auto& plane : kept.planes)
        plane.resize(stride_);
    for (auto& row : rgb_)
      row.resize(stride_);
    for (auto& row : opponent_)
      row.resize(stride_ + 2 * filters.radius);
    for (auto& row : filtered_)
      row.resize(stride_);
    pointers_.resize(2 * filters.radius + 1);
  }

  void row(unsigned y, SeenRow& seen);

private:
  /// What is filtered horizontally by which filter.
  enum Plane { Achromatic, RedGreen, BlueYellow0, BlueYellow1, Gauss, First, Second, kPlanes };
  struct Kept {
    long row = -1;
    std::array<std::vector<float>, kPlanes> planes;
  };

  unsigned rowNear(unsigned y, long offset) const;
  void keep(unsigned y);
  void across(const std::vector<float>& padded, const FlipFilter& filter, std::vector<float>& to);
  void down(unsigned y, Plane plane, const FlipFilter& filter, std::vector<float>& to);

  const Shown& shown_;
  const FlipFilters& filters_;
  std::size_t stride_;
  std::vector<Kept> kept_; ///< row y in place y mod their number
  std::array<std::vector<float>, 3> rgb_, opponent_;
  std::array<std::vector<float>, 8> filtered_;
  std::vector<const float*> pointers_;
};

void Seeing::across(const std::vector<float>& padded, const FlipFilter& filter, std::vector<float>& to) {
  const std::size_t first = filters_.radius - filter.radius();
  for (std::size_t k = 0; k < filter.weights.size(); ++k)
    pointers_[k] = padded.data() + first + k;
  weightedSum(pointers_.data(), filter, to.data(), shown_.width());
}

/// Beyond the picture its border goes on, as in the papers' own program.
unsigned Seeing::rowNear(unsigned y, long offset) const {
  return unsigned(std::clamp(long(y) + offset, 0l, long(shown_.height()) - 1));
}

/// The rows must be kept.
void Seeing::down(unsigned y, Plane plane, const FlipFilter& filter, std::vector<float>& to) {
  for (std::size_t k = 0; k < filter.weights.size(); ++k)
    pointers_[k] = kept_[rowNear(y, long(k) - long(filter.radius())) % kept_.size()].planes[plane].data();
  weightedSum(pointers_.data(), filter, to.data(), shown_.width());
}

void Seeing::keep(unsigned y) {
  Kept& kept = kept_[y % kept_.size()];
  if (kept.row == long(y)) return;
  kept.row = long(y);
  const std::size_t width = shown_.width(), pad = filters_.radius;
  shown_.row(y, rgb_[0].data(), rgb_[1].data(), rgb_[2].data());
  // YCxCz of the paper but for constant factors, which filters do not mind.
  for (std::size_t i = 0; i < width; ++i) {
    const float r = rgb_[0][i], g = rgb_[1][i], b = rgb_[2][i];
    const float lightness = dot(kXyz[1], r, g, b);
    opponent_[0][pad + i] = lightness;
    opponent_[1][pad + i] = dot(kXyz[0], r, g, b) - lightness;
    opponent_[2][pad + i] = lightness - dot(kXyz[2], r, g, b);
  }
  for (auto& row : opponent_) {
    std::fill_n(row.begin(), pad, row[pad]);
    std::fill(row.begin() + std::ptrdiff_t(pad + width), row.end(), row[pad + width - 1]);
  }
  std::array<std::vector<float>, kPlanes>& to = kept.planes;
  across(opponent_[0], filters_.achromatic, to[Achromatic]);
  across(opponent_[1], filters_.redGreen, to[RedGreen]);
  across(opponent_[2], filters_.blueYellow[0], to[BlueYellow0]);
  across(opponent_[2], filters_.blueYellow[1], to[BlueYellow1]);
  across(opponent_[0], filters_.gauss, to[Gauss]);
  across(opponent_[0], filters_.first, to[First]);
  across(opponent_[0], filters_.second, to[Second]);
}

void Seeing::row(unsigned y, SeenRow& seen) {
  for (auto* values : {&seen.l, &seen.a, &seen.b, &seen.edge, &seen.point})
    values->resize(stride_);
  auto& [achromatic, redGreen, blueYellow0, blueYellow1, firstX, firstY, secondX, secondY] = filtered_;
  for (long offset = -long(filters_.radius); offset <= long(filters_.radius); ++offset)
    keep(rowNear(y, offset));
  down(y, Achromatic, filters_.achromatic, achromatic);
  down(y, RedGreen, filters_.redGreen, redGreen);
  down(y, BlueYellow0, filters_.blueYellow[0], blueYellow0);
  down(y, BlueYellow1, filters_.blueYellow[1], blueYellow1);
  down(y, First, filters_.gauss, firstX);
  down(y, Gauss, filters_.first, firstY);
  down(y, Second, filters_.gauss, secondX);
  down(y, Gauss, filters_.second, secondY);
  // Whole lanes: what is behind the width is finite, and nobody's.
  for (std::size_t block = 0; block < stride_; block += kFlipLanes)
    for (std::size_t j = 0; j < kFlipLanes; ++j) {
      const std::size_t i = block + j;
      const float middle = achromatic[i], x = middle + redGreen[i],
                  z = middle - (blueYellow0[i] + blueYellow1[i]);
      const Lab lab = huntLab(clamped(dot(kRgb[0], x, middle, z)), clamped(dot(kRgb[1], x, middle, z)),
                              clamped(dot(kRgb[2], x, middle, z)));
      seen.l[i] = lab.l;
      seen.a[i] = lab.a;
      seen.b[i] = lab.b;
      seen.edge[i] = std::sqrt(firstX[i] * firstX[i] + firstY[i] * firstY[i]);
      seen.point[i] = std::sqrt(secondX[i] * secondX[i] + secondY[i] * secondY[i]);
    }
}

// The ACES curve in the form of the HDR paper: (a x^2 + b x) / (c x^2 + d x + e), 0.6 its own exposure.
constexpr double kToneA = 0.36 * 2.51, kToneB = 0.6 * 0.03, kToneC = 0.36 * 2.43, kToneD = 0.6 * 0.59,
                 kToneE = 0.14;

} // namespace

double toneCurveShoulder() {
  constexpr double kShoulder = 0.85;
  constexpr double a = kToneA - kShoulder * kToneC, b = kToneB - kShoulder * kToneD, c = -kShoulder * kToneE;
  return (-b + std::sqrt(b * b - 4 * a * c)) / (2 * a);
}

Shown::Shown(const Picture& picture, std::optional<double> exposure)
    : picture_(picture), toneMapped_(exposure.has_value()), scale_(std::exp2(exposure.value_or(0))) {}

float Shown::shown(float value) const {
  if (!(value > 0)) return 0;
  if (!toneMapped_) return value < 1 ? value : 1;
  constexpr double kAllWhite = 1e4; // the curve is above 1 from 12 on
  const double scaled = double(value) * scale_;
  const float x = float(scaled < kAllWhite ? scaled : kAllWhite);
  const float y =
      x * (float(kToneA) * x + float(kToneB)) / (x * (float(kToneC) * x + float(kToneD)) + float(kToneE));
  return y < 1 ? y : 1;
}

void Shown::row(unsigned y, float* r, float* g, float* b) const {
  const std::size_t channels = picture_.channels, green = channels < 3 ? 0 : 1, blue = channels < 3 ? 0 : 2;
  const float* v = picture_.values.data() + std::size_t(y) * picture_.width * channels;
  for (std::size_t i = 0; i < picture_.width; ++i, v += channels) {
    r[i] = shown(v[0]);
    g[i] = shown(v[green]);
    b[i] = shown(v[blue]);
  }
}

bool Shown::sameRow(const Shown& o, unsigned y) const {
  const std::size_t length = std::size_t(picture_.width) * picture_.channels;
  return std::memcmp(picture_.values.data() + y * length, o.picture_.values.data() + y * length,
                     length * sizeof(float)) == 0;
}

void raiseToLdrFlip(const Shown& a, const Shown& b, double pixelsPerDegree, std::vector<float>& map) {
  const FlipFilters filters(pixelsPerDegree);
  Seeing seeingA(a, filters), seeingB(b, filters);
  SeenRow seenA, seenB;
  const unsigned width = a.width(), height = a.height();
  long lastOther = -1; // of the rows up to y + radius, the last in which the pictures are not the same
  unsigned known = 0;
  for (unsigned y = 0; y < height; ++y) {
    for (; known < height && known <= y + filters.radius; ++known)
      if (!a.sameRow(b, known)) lastOther = long(known);
    if (lastOther < 0 || lastOther + long(filters.radius) < long(y)) continue; // no filter sees a difference
    seeingA.row(y, seenA);
    seeingB.row(y, seenB);
    for (unsigned x = 0; x < width; ++x) {
      const float hyab = distance({seenA.l[x], seenA.a[x], seenA.b[x]}, {seenB.l[x], seenB.a[x], seenB.b[x]});
      if (hyab == 0) continue; // 0 to any power: features alone are no error
      const float edges = std::abs(seenA.edge[x] - seenB.edge[x]),
                  points = std::abs(seenA.point[x] - seenB.point[x]);
      const float feature = std::pow(std::max(edges, points) / std::sqrt(2.f), kFeatureExponent);
      float& error = map[std::size_t(y) * width + x];
      error = std::max(error, std::min(1.f, std::pow(colorError(hyab), 1 - feature)));
    }
  }
}

} // namespace chamfer
