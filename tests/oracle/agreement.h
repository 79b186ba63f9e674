// Compares anything that answers rays with the oracle, and says how well it did.
#pragma once

#include "tests/oracle/union_oracle.h"

#include <array>
#include <functional>
#include <string>

namespace chamfer::oracle {

/// The answer of the code under test: the first hit beyond ray.tnear.
struct Answer {
  double t;
  Eigen::Vector3d normal;
  Feature feature;
};
/// Called from several threads at once.
using Subject = std::function<std::optional<Answer>(const Ray&)>;

/// Lengths are shares of the solid's diagonal.
struct Tolerances {
  double silhouette = 1e-5;   ///< rays this near to another answer are excused (UnionOracle::ambiguity)
  double position = 1e-5;     ///< across R's surface
  double seam = 1e-5;         ///< features are not judged this near to a border, plus what noise moves it
  double normalDegrees = 0.1; ///< against R's normal at the answer's own point, plus what noise turns it
  /// How far E's vertices and flats may be off in the program's storage. On a rounding this turns normals by
  /// noise / r; where a cylinder or sphere stands out by it over its neighbour, by sqrt(2 noise / r) at the
  /// seam.
  double noise = 4e-8;
  unsigned threads = 0; ///< 0: all
};

/// Distribution of an error over many decades; sums of histograms are exact, quantiles hold to 6 %.
class ErrorHistogram {
public:
  void add(double value);
  void merge(const ErrorHistogram& other);
  double quantile(double share) const; ///< upper bound of the bin; 0 when nothing was added
  double largest() const { return largest_; }
  std::size_t count() const { return count_; }

private:
  static constexpr int kPerDecade = 40, kLowest = -20, kDecades = 25;
  std::array<std::uint64_t, kPerDecade * kDecades + 1> bins_{};
  std::size_t count_ = 0;
  double largest_ = 0;
};

enum class Fault : std::uint8_t { HitMiss, Position, Normal, Feature, NotFinite };
const char* faultWord(Fault fault);

/// One disagreement, with everything that repeats it.
struct Disagreement {
  Fault fault;
  double measure; ///< share of the diagonal, or degrees
  Ray ray;
  std::optional<Answer> answer;
  std::optional<Hit> truth;
  std::string text() const;
};

struct AgreementReport {
  std::size_t rays = 0, hits = 0, roundedHits = 0, excused = 0;
  std::array<std::size_t, 5> faults{}; ///< by Fault
  ErrorHistogram across;               ///< distance of the answer from R's surface, share of the diagonal
  ErrorHistogram along;                ///< difference of t, share of the diagonal
  ErrorHistogram acrossOfRadius, alongOfRadius; ///< on cylinders and spheres, shares of the radius
  ErrorHistogram normalDegrees;
  std::vector<Disagreement> examples; ///< the first few of each part of the work

  std::size_t disagreements() const;
  /// No disagreement, and no more than this share of the rays excused (or one ray). Excuses are for rays that
  /// graze: a subject that needs more of them is wrong.
  bool agrees(double mostExcused) const;
  bool agrees() const;           ///< with the share that suits the mixed rays of one solid
  std::string summary() const;   ///< one line
  std::string complaint() const; ///< summary and examples
  void merge(const AgreementReport& other);
};

AgreementReport compare(const Subject& subject, const UnionOracle& truth, std::span<const Ray> rays,
                        const Tolerances& tolerances = {});

/// Cracks and creases: each ray and a copy of it moved sideways by `step` diagonals must both hit or both
/// miss, and their normals differ by no more than R's curvature allows over the distance of the two hits.
struct ContinuityReport {
  std::size_t pairs = 0, cracks = 0, creases = 0;
  std::size_t excused = 0; ///< pairs at the silhouette
  double worstCrease = 0;  ///< degrees beyond what curvature explains
  std::vector<std::string> examples;
};
ContinuityReport checkContinuity(const Subject& subject, const RoundedOracle& truth,
                                 std::span<const Ray> rays, double step, const Tolerances& tolerances = {});

} // namespace chamfer::oracle
