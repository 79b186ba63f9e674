#include "tests/oracle/agreement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <numbers>
#include <thread>

namespace chamfer::oracle {
namespace {

constexpr std::size_t kChunk = 512;  // rays a thread takes at a time
constexpr std::size_t kExamples = 4; // kept of each thread's disagreements
constexpr double kDegrees = 180 / std::numbers::pi;

bool finite(const Answer& a) { return std::isfinite(a.t) && a.normal.allFinite(); }

double degreesBetween(const Eigen::Vector3d& a, const Vec3& b) {
  const Vec3 wide = a.cast<Real>();
  return double(std::atan2(wide.cross(b).norm(), wide.dot(b))) * kDegrees;
}

/// See Tolerances::noise; here as a share of the radius.
double noiseDegrees(double ofRadius, bool atSeam) {
  return (ofRadius + (atSeam ? std::sqrt(2 * ofRadius) : 0)) * kDegrees;
}

class Judge {
public:
  Judge(const UnionOracle& truth, const Tolerances& tolerances) : truth_(truth), tolerances_(tolerances) {}

  void judge(const Ray& ray, const std::optional<Answer>& answer, AgreementReport& report) const {
    ++report.rays;
    const std::optional<Hit> hit = truth_.firstHit(ray);
    if (hit) ++report.hits;
    if (hit && hit->feature != Feature::Flat) ++report.roundedHits;
    if (answer && !finite(*answer)) return blame(Fault::NotFinite, 0, ray, answer, hit, report);
    if (answer.has_value() != hit.has_value()) {
      const double ambiguity = double(truth_.ambiguity(ray));
      if (ambiguity <= tolerances_.silhouette)
        ++report.excused;
      else
        blame(Fault::HitMiss, ambiguity, ray, answer, hit, report);
      return;
    }
    if (hit) judgeHit(ray, *answer, *hit, report);
  }

private:
  void judgeHit(const Ray& ray, const Answer& answer, const Hit& hit, AgreementReport& report) const {
    const RoundedOracle& solid = truth_.part(hit.part);
    const NearestShare at = truth_.nearest(hit.part, ray.at(answer.t));
    const Vec3 direction = ray.direction.cast<Real>();
    const double across = double(std::abs(at.offSurface));
    const double along = double(std::abs(Real(answer.t) - hit.t) * direction.norm()) / solid.diagonal();
    // Where the ray grazes, an error e across the surface is one of e / cosine along it, and up to twice that
    // next to the silhouette, where the chord's ends move towards each other.
    const double cosine = double(std::abs(hit.normal.dot(direction.normalized())));
    const double position = std::max(across, along * cosine / 2);
    const double ofRadius = solid.diagonal() / solid.radius();
    const double normal = degreesBetween(answer.normal, at.normal);
    const double length = std::abs(answer.normal.norm() - 1);
    const double noise = tolerances_.noise;
    const bool clear = at.seamDistance > tolerances_.seam + noise * at.seamMotion;

    const bool atSeam = at.seamDistance < noise * at.seamMotion + std::sqrt(2 * noise / ofRadius);
    const double normalLimit = tolerances_.normalDegrees + noiseDegrees(noise * ofRadius, atSeam);
    std::optional<Fault> fault;
    double measure = 0;
    if (position > tolerances_.position)
      fault = Fault::Position, measure = position;
    else if (normal > normalLimit || length > 1e-5)
      fault = Fault::Normal, measure = normal;
    else if (clear && answer.feature != at.feature)
      fault = Fault::Feature, measure = double(at.seamDistance);
    // At its own point an answer's normal and feature are always judged, but for points shared by two solids.
    const bool excusable = fault == Fault::Position || truth_.size() > 1;
    if (fault && excusable && double(truth_.ambiguity(ray)) <= tolerances_.silhouette) {
      ++report.excused;
      return;
    }
    report.across.add(across);
    report.along.add(along);
    report.normalDegrees.add(normal);
    if (hit.feature != Feature::Flat) {
      report.acrossOfRadius.add(across * ofRadius);
      report.alongOfRadius.add(along * ofRadius);
    }
    if (fault) blame(*fault, measure, ray, answer, hit, report);
  }

  static void blame(Fault fault, double measure, const Ray& ray, const std::optional<Answer>& answer,
                    const std::optional<Hit>& hit, AgreementReport& report) {
    ++report.faults[std::size_t(fault)];
    if (report.examples.size() < kExamples) report.examples.push_back({fault, measure, ray, answer, hit});
  }

  const UnionOracle& truth_;
  const Tolerances& tolerances_;
};

template <class Work>
void inThreads(unsigned threads, std::size_t count, const Work& work) {
  if (threads == 0) threads = std::max(1u, std::thread::hardware_concurrency());
  threads = unsigned(std::min<std::size_t>(threads, count / kChunk + 1));
  std::atomic<std::size_t> next{0};
  std::vector<std::thread> pool;
  const auto run = [&](unsigned thread) {
    for (std::size_t first; (first = next.fetch_add(kChunk)) < count;)
      work(thread, first, std::min(count, first + kChunk));
  };
  for (unsigned i = 1; i < threads; ++i)
    pool.emplace_back(run, i);
  run(0);
  for (std::thread& thread : pool)
    thread.join();
}

unsigned threadCount(unsigned threads) {
  return threads ? threads : std::max(1u, std::thread::hardware_concurrency());
}

} // namespace

AgreementReport compare(const Subject& subject, const UnionOracle& truth, std::span<const Ray> rays,
                        const Tolerances& tolerances) {
  const unsigned threads = threadCount(tolerances.threads);
  const Judge judge(truth, tolerances);
  std::vector<AgreementReport> reports(threads);
  inThreads(threads, rays.size(), [&](unsigned thread, std::size_t first, std::size_t end) {
    for (std::size_t i = first; i < end; ++i)
      judge.judge(rays[i], subject(rays[i]), reports[thread]);
  });
  for (unsigned i = 1; i < threads; ++i)
    reports[0].merge(reports[i]);
  return reports[0];
}

ContinuityReport checkContinuity(const Subject& subject, const RoundedOracle& truth,
                                 std::span<const Ray> rays, double step, const Tolerances& tolerances) {
  ContinuityReport report;
  const double noise = tolerances.noise * truth.diagonal() / truth.radius();
  for (const Ray& ray : rays) {
    const Eigen::Vector3d sideways = ray.direction.unitOrthogonal() * (step * truth.diagonal());
    Ray pair[2] = {ray, ray};
    pair[0].origin += sideways;
    pair[1].origin -= sideways;
    const auto near = [&](const Ray& r) {
      return std::abs(double(truth.silhouetteMargin(r))) / truth.diagonal();
    };
    const std::optional<Answer> a = subject(pair[0]), b = subject(pair[1]);
    ++report.pairs;
    if (!a || !b) {
      if (!a && !b) continue;
      if (std::min(near(pair[0]), near(pair[1])) <= tolerances.silhouette + 2 * step) {
        ++report.excused;
        continue;
      }
      ++report.cracks;
      if (report.examples.size() < kExamples)
        report.examples.push_back("crack: " +
                                  Disagreement{Fault::HitMiss, 0, a ? pair[1] : pair[0], {}, {}}.text());
      continue;
    }
    const double distance = double((pair[0].at(a->t) - pair[1].at(b->t)).norm());
    const double turn = degreesBetween(a->normal, b->normal.cast<Real>());
    // The normal map of R has Lipschitz constant 1 / r.
    const double allowed = distance * 1.001 / truth.radius() * kDegrees + tolerances.normalDegrees +
                           2 * noiseDegrees(noise, true);
    if (turn <= allowed) continue;
    if (std::min(near(pair[0]), near(pair[1])) <= tolerances.silhouette) {
      ++report.excused;
      continue;
    }
    ++report.creases;
    report.worstCrease = std::max(report.worstCrease, turn - allowed);
    if (report.examples.size() < kExamples)
      report.examples.push_back("crease: " +
                                Disagreement{Fault::Normal, turn - allowed, pair[0], a, {}}.text());
  }
  return report;
}

} // namespace chamfer::oracle
