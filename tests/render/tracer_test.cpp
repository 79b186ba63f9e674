// The tracer, Embree and filters included, against the oracle: placed instances under every affine map,
// solids that touch and interpenetrate, rays from inside and from slivers, and paths that leave the surface
// they hit.
#include "server/render/tracing/tracer.h"

#include "preprocess/preprocess.h"
#include "tests/oracle/agreement.h"
#include "tests/oracle/convex_families.h"
#include "tests/oracle/ray_samples.h"
#include "tests/support/mesh_of.h"

#include <gtest/gtest.h>
#include <iostream>
#include <random>

namespace chamfer {
namespace {

using oracle::ConvexSolid;

Ray toRay(const oracle::Ray& r) {
  return {{r.origin.x(), r.origin.y(), r.origin.z()}, {r.direction.x(), r.direction.y(), r.direction.z()}};
}

Transform toTransform(const oracle::Affine& a) {
  std::array<std::array<double, 4>, 3> rows{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j)
      rows[std::size_t(i)][std::size_t(j)] = j < 3 ? a.linear(i, j) : a.offset(i);
  return Transform(rows);
}

/// Solids, each an instance under its own map, and the truth about all of them.
struct Placed {
  /// Surfaces nearer to where a path leaves one than this share of what counts as close are one place with
  /// it: solids that touch are crossed once.
  static constexpr double kOnePlace = 1e-2;

  oracle::UnionOracle truth;
  std::vector<TracedInstance> instances;
  std::vector<oracle::Ray> rays;
  std::vector<std::pair<std::shared_ptr<const oracle::RoundedOracle>, oracle::Affine>> parts;

  void add(const ConvexSolid& solid, double radius, const oracle::Affine& map, std::size_t rayCount,
           std::uint64_t seed) {
    auto mesh = std::make_shared<TriangleMesh>(meshOf(solid));
    PreprocessOptions options;
    options.radius.value = radius;
    instances.push_back({makeTracedMesh(mesh), preprocess(*mesh, options).rounding, toTransform(map)});
    auto rounded = std::make_shared<oracle::RoundedOracle>(solid, radius);
    truth.add(rounded, map);
    parts.emplace_back(rounded, map);
    oracle::RaySampler sampler(solid, *rounded, seed);
    for (oracle::Ray ray : sampler.mixed(rayCount)) {
      ray.origin = map.linear * ray.origin + map.offset;
      ray.direction = map.linear * ray.direction;
      ray.tnear = std::max(ray.tnear, 0.0);
      rays.push_back(ray);
    }
  }

  /// The truth about all solids but one.
  oracle::UnionOracle without(std::size_t part) const {
    oracle::UnionOracle others;
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (i != part) others.add(parts[i].first, parts[i].second);
    return others;
  }

  static std::optional<oracle::Answer> answerOf(const std::optional<TraceHit>& hit) {
    if (!hit) return std::nullopt;
    return oracle::Answer{
        hit->t, {hit->normal.x, hit->normal.y, hit->normal.z}, oracle::Feature(hit->feature)};
  }

  oracle::AgreementReport check() const {
    const auto tracer = makeTracer(instances);
    const oracle::Subject subject = [&](const oracle::Ray& oracleRay) -> std::optional<oracle::Answer> {
      const Ray ray = toRay(oracleRay);
      const PathState from = tracer->stateAt(ray.at(oracleRay.tnear));
      const auto hit = tracer->intersect(ray, from, oracleRay.tnear);
      // The any-hit query must say the same as the closest-hit query.
      if (tracer->occluded(ray, from, oracleRay.tnear) != hit.has_value())
        return oracle::Answer{NAN, {0, 0, 0}, oracle::Feature::Flat};
      return answerOf(hit);
    };
    const auto report = oracle::compare(subject, truth, rays);
    std::cout << report.summary() << "\n";
    return report;
  }

  /// Segments of paths with what the tracer says of them.
  struct Segments {
    std::vector<oracle::Ray> rays;
    std::vector<std::optional<oracle::Answer>> answers;

    void add(const Ray& ray, double tnear, const std::optional<TraceHit>& hit) {
      rays.push_back({{ray.origin.x, ray.origin.y, ray.origin.z},
                      {ray.direction.x, ray.direction.y, ray.direction.z},
                      tnear});
      answers.push_back(answerOf(hit));
    }
    oracle::AgreementReport compareWith(const oracle::UnionOracle& wanted,
                                        const oracle::Tolerances& tolerances = {}) const {
      return oracle::compare([&](const oracle::Ray& ray) { return answers[std::size_t(&ray - rays.data())]; },
                             wanted, rays, tolerances);
    }
  };
  struct PathReport {
    oracle::AgreementReport all;   ///< but for those in:
    oracle::AgreementReport close; ///< segments that end, or should, next to where they begin
  };

  /// Paths that stay on their side of every surface, each ray with the state that the last hit gives it.
  PathReport checkPaths(unsigned bounces, std::uint64_t seed) const {
    const auto tracer = makeTracer(instances);
    std::mt19937_64 random(seed);
    std::normal_distribution<double> gauss;
    Segments all;
    // The convex solid that a segment leaves is not there for it, or is met again at its far side: what is
    // met right at the start is another's.
    std::vector<Segments> closeTo(parts.size());
    std::vector<oracle::UnionOracle> others;
    for (std::size_t i = 0; i < parts.size(); ++i)
      others.push_back(without(i));
    for (const oracle::Ray& start : rays) {
      Ray ray = toRay(start);
      if (start.tnear != 0) continue;
      Arrival at{tracer->stateAt(ray.origin), {}};
      std::uint32_t left = 0;
      for (unsigned bounce = 0; bounce <= bounces; ++bounce) {
        const auto hit = tracer->intersect(ray, at.state, 0, INFINITY, &at);
        // From the surface the oracle's ray begins a little later, so that it does not meet where it begins.
        const double close = bounce == 0 ? 0 : 1e-5 * truth.part(0).diagonal() / length(ray.direction);
        const auto isClose = [&](double t) { return t <= close; };
        if (bounce > 0) {
          const oracle::Ray leaving{{ray.origin.x, ray.origin.y, ray.origin.z},
                                    {ray.direction.x, ray.direction.y, ray.direction.z},
                                    kOnePlace * close};
          const auto first = others[left].firstHit(leaving);
          if ((hit && isClose(hit->t)) || (first && isClose(double(first->t))))
            closeTo[left].add(ray, 0, hit);
          else
            all.add(ray, close, hit);
        } else {
          all.add(ray, 0, hit);
        }
        if (!hit) break;
        left = hit->instance;
        const Vector3 scattered = normalize(Vector3(gauss(random), gauss(random), gauss(random))) * 0.99;
        const bool within = dot(ray.direction, hit->normal) > 0;
        ray = {hit->position, normalize((within ? -hit->normal : hit->normal) + scattered)};
      }
    }
    // The lengths are short themselves: only where another solid's surface goes through the start, for all
    // that storage can tell, may either answer be right.
    oracle::Tolerances tight;
    tight.silhouette = tight.position = 2 * tight.noise;
    PathReport report;
    report.all = all.compareWith(truth);
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (!closeTo[i].rays.empty()) report.close.merge(closeTo[i].compareWith(others[i], tight));
    std::cout << report.all.summary() << "\nclose: " << report.close.summary() << "\n";
    return report;
  }
};

oracle::Affine moved(oracle::Affine map, double x, double y, double z) {
  map.offset = {x, y, z};
  return map;
}

oracle::Affine product(const oracle::Affine& a, const oracle::Affine& b) {
  oracle::Affine c;
  c.linear = a.linear * b.linear;
  c.offset = a.linear * b.offset + a.offset;
  return c;
}

TEST(Tracer, PlacedInstancesAgreeWithTheOracle) {
  const oracle::Affine maps[] = {
      {},
      moved(oracle::randomRotation(3), 2, 0, 0),
      moved(oracle::scaling(-1, 1, 1), 0, 3, 0),
      moved(product(oracle::randomRotation(5), oracle::scaling(2, -0.5, 0.7)), -4, 0, 1),
      moved(product(oracle::scaling(1, 1, 3), oracle::randomRotation(8)), 0, -5, 0)};
  for (const auto& map : maps) {
    Placed scene;
    scene.add(oracle::hullOnSphere(30, 11), 0.15, map, oracle::rayBudget(12000), 1);
    const auto report = scene.check();
    EXPECT_TRUE(report.agrees()) << report.complaint();
  }
}

/// Solids that touch at a face and that sink into each other.
Placed heap() {
  Placed scene;
  scene.add(oracle::cube(), 0.1, {}, oracle::rayBudget(8000), 1);
  scene.add(oracle::cube(), 0.1, moved({}, 0.25, 0.1, 1), oracle::rayBudget(8000),
            2); // touches the first at a face
  scene.add(oracle::dodecahedron(), 0.2, moved(oracle::randomRotation(4), 0.9, 0.4, 0.3),
            oracle::rayBudget(8000), 3);
  scene.add(oracle::prism(7, 0.9), 0.08, moved(oracle::scaling(-0.7, 0.7, 0.7), -0.8, 0, 0.2),
            oracle::rayBudget(8000), 4);
  return scene;
}

/// Of the heap's rays: where two of its solids touch, the end of one is the start of the other (0.4 %).
constexpr double kExcusedInHeap = 0.01;

TEST(Tracer, ManyInstancesTogetherAreTheirUnion) {
  const auto report = heap().check();
  EXPECT_TRUE(report.agrees(kExcusedInHeap)) << report.complaint();
}

TEST(Tracer, PathsAmongSolidsInSlivers) {
  const auto report = heap().checkPaths(3, 5);
  EXPECT_TRUE(report.all.agrees(kExcusedInHeap)) << report.all.complaint();
  EXPECT_EQ(report.close.disagreements(), 0u) << report.close.complaint();
  EXPECT_GT(report.close.rays, report.close.excused) << "some are judged";
  // Rays in the plane where two solids touch are tangent to both: 31 of 71,000.
  EXPECT_LT(report.close.excused, 1e-3 * double(report.all.rays)) << report.close.summary();
}

TEST(Tracer, FarFromTheOriginNothingIsLost) {
  Placed scene;
  scene.add(oracle::icosahedron(), 0.1, moved(oracle::randomRotation(6), 2e4, -1e4, 3e4),
            oracle::rayBudget(12000), 1);
  const auto report = scene.check();
  EXPECT_TRUE(report.agrees()) << report.complaint();
}

TEST(Tracer, OneMeshOfManySolidsIsTheirUnion) {
  // Stacked so that faces and edges coincide, in one file.
  std::vector<ConvexSolid> solids;
  oracle::UnionOracle truth;
  const double radius = 0.07;
  for (int i = 0; i < 8; ++i)
    solids.push_back(oracle::transformed(oracle::cube(), moved({}, i & 1, (i >> 1) & 1, i >> 2)));
  for (const auto& s : solids)
    truth.add(std::make_shared<oracle::RoundedOracle>(s, radius));
  truth.fuse(1e-9);
  auto mesh = std::make_shared<TriangleMesh>(meshOf(solids));
  PreprocessOptions options;
  options.radius.value = radius;
  const auto tracer = makeTracer({{makeTracedMesh(mesh), preprocess(*mesh, options).rounding, {}}});
  std::vector<oracle::Ray> rays;
  for (std::size_t i = 0; i < solids.size(); ++i) {
    oracle::RaySampler sampler(solids[i], truth.part(i), 90 + i);
    for (const auto& ray : sampler.mixed(oracle::rayBudget(3000)))
      rays.push_back(ray);
  }
  const auto report = oracle::compare(
      [&](const oracle::Ray& ray) -> std::optional<oracle::Answer> {
        const auto hit = tracer->intersect(toRay(ray), tracer->stateAt(toRay(ray).at(ray.tnear)), ray.tnear);
        if (!hit) return std::nullopt;
        return oracle::Answer{
            hit->t, {hit->normal.x, hit->normal.y, hit->normal.z}, oracle::Feature(hit->feature)};
      },
      truth, rays);
  std::cout << report.summary() << "\n";
  // Some of the rays lie in planes where faces of two cubes coincide, or are tangent to their roundings: 0.5
  // %.
  EXPECT_TRUE(report.agrees(0.01)) << report.complaint();
}

/// Rays from inside a mesh of several solids, of one radius, in all directions.
oracle::AgreementReport checkFromWithin(const std::vector<ConvexSolid>& solids, double radius) {
  oracle::UnionOracle truth;
  for (const auto& s : solids)
    truth.add(std::make_shared<oracle::RoundedOracle>(s, radius));
  truth.fuse(1e-9);
  auto mesh = std::make_shared<TriangleMesh>(meshOf(solids));
  PreprocessOptions options;
  options.radius.value = radius;
  const auto tracer = makeTracer({{makeTracedMesh(mesh), preprocess(*mesh, options).rounding, {}}});
  oracle::Random random(17);
  std::vector<oracle::Ray> rays;
  for (std::size_t i = 0; i < solids.size(); ++i)
    for (std::size_t k = 0; k < oracle::rayBudget(4000); ++k) {
      // Points of the core, some at its border and beyond.
      const auto& core = truth.part(i).core();
      Eigen::Vector3d p = truth.part(i).centre();
      double left = random.uniform(0, 1.1);
      for (const auto& v : core.vertices) {
        const double share = random.uniform(0, left);
        p += share * v.template cast<double>();
        left -= share;
      }
      rays.push_back({p, {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, 0});
    }
  const auto report = oracle::compare(
      [&](const oracle::Ray& ray) -> std::optional<oracle::Answer> {
        const PathState from = tracer->stateAt(toRay(ray).origin);
        const auto hit = tracer->intersect(toRay(ray), from);
        if (hit.has_value() != tracer->occluded(toRay(ray), from))
          return oracle::Answer{NAN, {0, 0, 0}, oracle::Feature::Flat};
        return Placed::answerOf(hit);
      },
      truth, rays);
  std::cout << report.summary() << "\n";
  return report;
}

TEST(Tracer, AUnionSeenFromWithinHasNoWallsWithin) {
  std::vector<ConvexSolid> touching, sunk;
  for (int i = 0; i < 8; ++i)
    touching.push_back(oracle::transformed(oracle::cube(), moved({}, i & 1, (i >> 1) & 1, i >> 2)));
  sunk.push_back(oracle::box(3, 1, 1)); // a cross of rooms, and one askew
  sunk.push_back(oracle::box(1, 3, 0.9));
  sunk.push_back(oracle::transformed(oracle::prism(7, 0.9), moved(oracle::randomRotation(4), 0.8, 0.3, 0.2)));
  for (const auto& solids : {touching, sunk}) {
    const auto report = checkFromWithin(solids, 0.07);
    EXPECT_TRUE(report.agrees()) << report.complaint();
  }
}

TEST(Tracer, WhatStandsInARoomOfItsOwnMeshIsSeen) {
  const std::vector<ConvexSolid> solids{oracle::box(4, 4, 4),
                                        oracle::transformed(oracle::cube(), moved({}, 0, 0, -1.5))};
  auto mesh = std::make_shared<TriangleMesh>(meshOf(solids));
  PreprocessOptions options;
  options.radius.value = 0.1;
  const auto tracer = makeTracer({{makeTracedMesh(mesh), preprocess(*mesh, options).rounding, {}}});
  const Ray down{{0.1, 0.2, 1}, {0, 0, -1}};
  const auto hit = tracer->intersect(down, tracer->stateAt(down.origin));
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t, 2, 1e-6) << "the cube's top, not the floor below it";
}

TEST(Tracer, PathsLeaveAndCrossASolidWithoutMeetingWhereTheyStart) {
  const ConvexSolid solid = oracle::hullOnSphere(24, 5);
  const double radius = 0.2;
  const oracle::RoundedOracle truth(solid, radius);
  Placed scene;
  scene.add(solid, radius, moved(oracle::randomRotation(2), 1, 2, 3), 0, 1);
  const auto tracer = makeTracer(scene.instances);
  oracle::RaySampler sampler(solid, truth, 77);
  const oracle::Affine map = moved(oracle::randomRotation(2), 1, 2, 3);
  std::size_t crossed = 0;
  for (const auto& base : sampler.sample(oracle::RayKind::Far10, 4000)) {
    oracle::Ray ray = base;
    ray.origin = map.linear * ray.origin + map.offset;
    ray.direction = map.linear * ray.direction;
    Arrival at;
    const auto hit = tracer->intersect(toRay(ray), {}, 0, INFINITY, &at);
    if (!hit) continue;
    const Vector3 d(ray.direction.x(), ray.direction.y(), ray.direction.z());
    // Reflected, it never meets the convex solid again, also at grazing angles.
    const Vector3 reflected = d - hit->normal * (2 * dot(d, hit->normal));
    if (dot(reflected, hit->normal) > 0) {
      EXPECT_FALSE(tracer->intersect({hit->position, reflected}, at.state));
      EXPECT_FALSE(tracer->occluded({hit->position, reflected}, at.state));
    }
    // Straight on, it leaves where the oracle's interval ends.
    const auto interval = truth.interval(base);
    if (!interval || std::abs(double(truth.silhouetteMargin(base))) < 1e-5) continue;
    const auto out = tracer->intersect({hit->position, d}, at.state, 0, INFINITY, &at);
    ASSERT_TRUE(out);
    ++crossed;
    EXPECT_NEAR(hit->t + out->t, double(interval->out.t), 2e-6 * truth.diagonal() / length(d) / 0.01);
    EXPECT_GT(dot(out->normal, d), 0);
    // And is gone then.
    EXPECT_FALSE(tracer->intersect({out->position, d}, at.state));
  }
  EXPECT_GT(crossed, 2000u);
}

TEST(Tracer, AShadowRayInsideASolidIsStoppedBeforeALightInItsSliver) {
  auto mesh = std::make_shared<TriangleMesh>(meshOf(oracle::box(2, 2, 2)));
  PreprocessOptions options;
  options.radius.value = 0.5;
  const auto tracer = makeTracer({{makeTracedMesh(mesh), preprocess(*mesh, options).rounding, {}}});
  // From the room's floor, seen from inside, to a point between the rounded corner and the mesh's corner.
  Arrival at;
  const auto floor = tracer->intersect({{0, 0, 0}, {0, 0, -1}}, tracer->stateAt({0, 0, 0}), 0, INFINITY, &at);
  ASSERT_TRUE(floor);
  const Vector3 toLight = Point3(0.95, 0.95, 0.95) - floor->position;
  EXPECT_TRUE(tracer->occluded({floor->position, toLight}, at.state, 0, 1));
  const Vector3 toRoom = Point3(0.5, 0.5, 0.5) - floor->position;
  EXPECT_FALSE(tracer->occluded({floor->position, toRoom}, at.state, 0, 1));
}

TEST(Tracer, SharpTrianglesAreNotMetAgainAtTheirOwnPlane) {
  auto mesh = std::make_shared<TriangleMesh>(meshOf(oracle::box(200, 200, 1)));
  const auto tracer = makeTracer({{makeTracedMesh(mesh), nullptr, {}}});
  oracle::Random random(3);
  for (int i = 0; i < 4000; ++i) {
    const Ray down{{random.uniform(-90, 90), random.uniform(-90, 90), 30}, {0.1, 0.2, -1}};
    Arrival at;
    const auto hit = tracer->intersect(down, {}, 0, INFINITY, &at);
    ASSERT_TRUE(hit);
    const double angle = random.uniform(0, 6.28), rise = std::pow(10.0, -random.uniform(0, 4));
    const Vector3 along{std::cos(angle), std::sin(angle), rise};
    EXPECT_FALSE(tracer->intersect({hit->position, along}, at.state)) << rise;
  }
}

TEST(Tracer, MemoryCountsSharedThingsOnce) {
  PreprocessOptions options;
  options.radius.value = 0.05;
  const auto place = [&](const ConvexSolid& solid) {
    const auto mesh = std::make_shared<TriangleMesh>(meshOf(solid));
    return TracedInstance{makeTracedMesh(mesh), preprocess(*mesh, options).rounding, {}};
  };
  const auto row = [](const std::vector<TracedInstance>& kinds, int count) {
    std::vector<TracedInstance> instances;
    for (int i = 0; i < count; ++i) {
      instances.push_back(kinds[std::size_t(i) % kinds.size()]);
      instances.back().worldFromObject = Transform::translate({2.0 * i, 0, 0});
    }
    return makeTracer(instances)->memoryBytes();
  };
  const TracedInstance a = place(oracle::hullOnSphere(200, 1)), b = place(oracle::hullOnSphere(200, 2));
  const std::size_t own = memoryBytes(*a.mesh) + a.rounding->bytes();
  const std::size_t one = row({a}, 1), thousand = row({a}, 1000);
  EXPECT_GT(one, own);
  // What an instance needs: its record, Embree's geometry and its leaf in the scene's hierarchy.
  constexpr std::size_t kInstance = 600;
  ASSERT_GT(own, 10 * kInstance) << "or the bound below could not tell";
  EXPECT_LT(thousand - one, 999 * kInstance);
  // Another mesh counts, and in turn with the first each still counts once.
  EXPECT_GE(row({a, b}, 2), one + memoryBytes(*b.mesh) + b.rounding->bytes());
  EXPECT_LT(row({a, b}, 1000) - row({a, b}, 2), 998 * kInstance);
  // The mesh is shared where the roundings are not.
  TracedInstance thicker = a;
  options.radius.value = 0.1;
  thicker.rounding = preprocess(meshOf(oracle::hullOnSphere(200, 1)), options).rounding;
  const std::size_t two = row({a, thicker}, 2);
  EXPECT_GE(two, one + thicker.rounding->bytes());
  EXPECT_LT(two, one + thicker.rounding->bytes() + memoryBytes(*a.mesh));
}

} // namespace
} // namespace chamfer
