// What paths go through: absorption along known lengths, the index on either side of a crossing, and that
// clear glass in a white room is not to be seen, in any arrangement.
#include "server/render/path/media.h"
#include "server/render/path/prepared_scene.h"
#include "tests/render/scene_files_fixture.h"

#include <cmath>
#include <gmock/gmock.h>
#include <iterator>
#include <sstream>

namespace chamfer {
namespace {

using test::loadText;
using test::TemporaryFolder;

constexpr const char* kWhiteRoom = R"("lights":[{"type":"environment","color":1}])";

/// Cubes from -0.5 to 0.5; `rounded`: with a radius of 0.1.
std::string scene(const std::string& materials, const std::string& instances, bool rounded,
                  const std::string& lights = kWhiteRoom) {
  return R"({"meshes":[{"name":"cube","file":"cube.obj")" +
         std::string(rounded ? R"(,"radius":0.1)" : R"(,"rounding":false)") +
         R"(},{"name":"floor","file":"floor.obj"}],"materials":[)" + materials + R"(],"instances":[)" +
         instances + "]," + lights + "}";
}

struct Extremes {
  double least, most, mean;
};

Extremes render(const std::shared_ptr<const Scene>& scene, const Camera& camera, unsigned size,
                unsigned samples, const RoundingChoice& choice = {}) {
  RenderSettings s;
  s.width = s.height = size;
  s.endSample = samples;
  s.maxBounces = 64;
  s.camera = camera;
  const RenderResult r = renderTile(*prepare(scene, choice), s, {0, 0, size, size});
  Extremes e{INFINITY, -INFINITY, 0};
  for (std::size_t i = 1; i < r.image.rgba.size(); i += 4) {
    const double v = r.image.rgba[i];
    e.least = std::min(e.least, v);
    e.most = std::max(e.most, v);
    e.mean += v / (double(size) * size);
  }
  return e;
}

Camera lookAt(const Point3& eye, const Point3& target, double vfov) {
  Camera c;
  c.eye = eye;
  c.target = target;
  c.vfovDegrees = vfov;
  c.up = {0.1, 0.2, 1};
  return c;
}

// A medium of index 1 bends nothing: a ray along the x axis goes through known lengths of it.
constexpr const char* kHaze =
    R"({"name":"haze","base_color":1,"transmission":1,"ior":1,"absorption":[0.7,0.7,0.7]},
  {"name":"smoke","base_color":1,"transmission":1,"ior":1,"absorption":[2,2,2]},
  {"name":"stone","base_color":0,"specular":0},
  {"name":"lamp","base_color":0,"specular":0,"emission":[1,1,1]})";

struct AbsorptionCase {
  const char* name;
  const char* instances;
  double eye;       ///< on the x axis, looking along it
  double hazeTotal; ///< lengths along the axis
  double smokeTotal;
};
void PrintTo(const AbsorptionCase& c, std::ostream* out) { *out << c.name; }

class Absorption : public testing::TestWithParam<AbsorptionCase> {};

TEST_P(Absorption, IsByTheLengthInside) {
  const AbsorptionCase& c = GetParam();
  const TemporaryFolder folder;
  for (const bool rounded : {false, true}) {
    const auto loaded = loadText(folder, scene(kHaze, c.instances, rounded));
    const Extremes e = render(loaded, lookAt({c.eye, 0.01, 0.02}, {c.eye + 1, 0.01, 0.02}, 1e-2), 4, 4096);
    const double truth = std::exp(-0.7 * c.hazeTotal - 2 * c.smokeTotal);
    // Roulette ends some of the paths that go through more than three surfaces.
    EXPECT_NEAR(e.mean, truth, 1e-5 + 5 * std::sqrt(truth * (1 - truth) / (16 * 4096))) << rounded;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arrangements, Absorption,
    testing::Values(
        AbsorptionCase{"alone", R"({"mesh":"cube","material":"haze"})", -3, 1, 0},
        AbsorptionCase{"the eye inside", R"({"mesh":"cube","material":"haze"})", 0.2, 0.3, 0},
        AbsorptionCase{
            "touching",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"haze","translate":[1,0,0]})", -3,
            2, 0},
        AbsorptionCase{
            "touching, two media",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"smoke","translate":[1,0,0]})", -3,
            1, 1},
        AbsorptionCase{
            "sunk in",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"haze","translate":[0.6,0,0]})",
            -3, 1.6, 0},
        AbsorptionCase{
            "the eye where both are",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"haze","translate":[0.6,0,0]})",
            0.3, 0.8, 0},
        AbsorptionCase{
            "sunk in, two media of one size: the later counts",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"smoke","translate":[0.6,0,0]})",
            -3, 0.6, 1},
        AbsorptionCase{
            "the same, listed the other way",
            R"({"mesh":"cube","material":"smoke","translate":[0.6,0,0]},{"mesh":"cube","material":"haze"})",
            -3, 1, 0.6},
        AbsorptionCase{"nested: the smaller counts, wherever it is listed",
                       R"({"mesh":"cube","material":"smoke","scale":0.5},{"mesh":"cube","material":"haze"})",
                       -3, 0.5, 0.5},
        AbsorptionCase{"nested, the eye in both",
                       R"({"mesh":"cube","material":"smoke","scale":0.5},{"mesh":"cube","material":"haze"})",
                       0, 0.25, 0.25},
        AbsorptionCase{"one on the other's face from within",
                       R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"smoke","scale":0.5,
                         "translate":[0.25,0,0]})",
                       -3, 0.5, 0.5},
        AbsorptionCase{"twice in one place",
                       R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"haze"})", -3, 1, 0},
        AbsorptionCase{"mirrored", R"({"mesh":"cube","material":"haze","scale":[-1,1,2]},
                         {"mesh":"cube","material":"smoke","scale":[2,-1,1],"translate":[1.5,0,0]})",
                       -3, 1, 2},
        AbsorptionCase{
            "far from the origin of the scene",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"haze","translate":[1,0,0]},
                         {"mesh":"cube","material":"stone","translate":[-2000,900,1000]})",
            -3, 2, 0},
        AbsorptionCase{
            "on a lamp that it touches",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"lamp","translate":[1,0,0]})", -3,
            1, 0},
        AbsorptionCase{
            "sunk into a lamp",
            R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"lamp","translate":[0.7,0,0]})",
            -3, 0.7, 0},
        AbsorptionCase{"a lamp inside",
                       R"({"mesh":"cube","material":"haze"},{"mesh":"cube","material":"lamp","scale":0.2})",
                       -3, 0.4, 0}));

struct GlassCase {
  const char* name;
  const char* instances;
};
void PrintTo(const GlassCase& c, std::ostream* out) { *out << c.name; }

constexpr const char* kGlasses = R"({"name":"crown","base_color":1,"roughness":0,"transmission":1,"ior":1.5},
  {"name":"flint","base_color":1,"roughness":0,"transmission":1,"ior":1.8},
  {"name":"water","base_color":1,"roughness":0,"transmission":1,"ior":1.33},
  {"name":"white","base_color":1,"specular":0})";

class WhiteRoom : public testing::TestWithParam<GlassCase> {};

TEST_P(WhiteRoom, HidesClearGlass) {
  const TemporaryFolder folder;
  for (const bool rounded : {true, false}) {
    const auto loaded = loadText(folder, scene(kGlasses, GetParam().instances, rounded));
    const Extremes e = render(loaded, lookAt({2.4, -2.9, 1.7}, {0.3, 0, 0.2}, 40), 64, 16);
    // Light that total reflection keeps inside longer than the limit on bounces is lost.
    EXPECT_GE(e.mean, 0.995) << rounded;
    EXPECT_LE(e.most, 1 + 1e-4) << rounded;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Arrangements, WhiteRoom,
    testing::Values(
        GlassCase{"alone", R"({"mesh":"cube","material":"crown"})"},
        GlassCase{"touching", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"crown",
          "translate":[1,0,0]},{"mesh":"cube","material":"crown","translate":[0,0,1]})"},
        GlassCase{"touching, three kinds",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint",
          "translate":[1,0,0]},{"mesh":"cube","material":"water","translate":[0,0,1]})"},
        GlassCase{"four about an edge",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint",
          "translate":[1,0,0]},{"mesh":"cube","material":"water","translate":[0,0,1]},
          {"mesh":"cube","material":"crown","translate":[1,0,1]})"},
        GlassCase{"askew on a face", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint",
          "rotate":[{"axis":[0,0,1],"degrees":30}],"translate":[0.2,0.1,1]})"},
        GlassCase{"sunk in", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint",
          "translate":[0.6,0.3,0.2]})"},
        GlassCase{"sunk in by the touch of a hair", R"({"mesh":"cube","material":"crown"},
          {"mesh":"cube","material":"flint","translate":[0.9999999,0,0]})"},
        GlassCase{"apart by a hair", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"crown",
          "translate":[1.0000001,0,0]},{"mesh":"cube","material":"flint","translate":[0,0,1.00001]})"},
        GlassCase{"nested",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"water","scale":0.5},
          {"mesh":"cube","material":"flint","scale":0.2})"},
        GlassCase{"nested at a face", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"water",
          "scale":0.5,"translate":[0.25,0,0.25]})"},
        GlassCase{"twice in one place",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"crown"})"},
        GlassCase{"two kinds in one place",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint"})"},
        GlassCase{"mirrored and squeezed", R"({"mesh":"cube","material":"crown","scale":[-1,1,1]},
          {"mesh":"cube","material":"flint","scale":[1,1,-0.4],"translate":[0,0,0.7]})"},
        GlassCase{"on a white block", R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"white",
          "translate":[0,0,-1]},{"mesh":"cube","material":"crown","translate":[1,0,-1]})"},
        GlassCase{"sunk into a white block",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"white",
          "translate":[0.2,0.3,-0.7]})"},
        GlassCase{"a white block inside",
                  R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"white","scale":0.4})"},
        GlassCase{"on a white floor", R"({"mesh":"cube","material":"crown","translate":[0,0,-0.5]},
          {"mesh":"floor","material":"white"})"},
        GlassCase{"in a scene of large coordinates", R"({"mesh":"cube","material":"crown"},
          {"mesh":"cube","material":"flint","translate":[1,0,0]},
          {"mesh":"cube","material":"white","translate":[-2000,900,1000]})"}));

TEST(WhiteRoom, IsIndexSquaredInsideGlass) {
  // Radiance in glass is squeezed into fewer directions. Of these indices no cube traps light for good.
  constexpr const char* kLight = R"({"name":"a","base_color":1,"roughness":0,"transmission":1,"ior":1.2},
    {"name":"b","base_color":1,"roughness":0,"transmission":1,"ior":1.1},
    {"name":"c","base_color":1,"roughness":0,"transmission":1,"ior":1.15})";
  struct Eye {
    Point3 at;
    double index;
    bool alike; ///< also all about it, within 0.005
  };
  const TemporaryFolder folder;
  for (const bool rounded : {true, false}) {
    const auto loaded = loadText(folder, scene(kLight, R"({"mesh":"cube","material":"a"},
      {"mesh":"cube","material":"b","translate":[1,0,0]},{"mesh":"cube","material":"c","scale":0.5})",
                                               rounded));
    for (const Eye& eye :
         {Eye{{0.4, 0.1, -0.3}, 1.2, true}, Eye{{0.1, 0.1, 0}, 1.15, true}, Eye{{0.8, 0, 0}, 1.1, true},
          Eye{{0.49, 0.49, 0.48}, rounded ? 1 : 1.2, false}, Eye{{-0.501, 0, 0}, 1, false}}) {
      Camera camera = lookAt(eye.at, eye.at + Vector3(0.2, 0.9, 0.4), 60);
      for (const double aperture : {0.0, 0.01}) {
        if (aperture > 0 && !eye.alike) continue;
        camera.apertureDiameter = aperture;
        const Extremes e = render(loaded, camera, 32, 64);
        const double truth = eye.index * eye.index;
        EXPECT_NEAR(e.mean, truth, 5e-3) << eye.at.x << " " << rounded << " " << aperture;
        EXPECT_LE(e.most, truth + 1e-4) << eye.at.x << " " << rounded << " " << aperture;
      }
    }
  }
}

TEST(WhiteRoom, ALensAcrossASurfaceSeesBothSides) {
  const TemporaryFolder folder;
  const auto loaded =
      loadText(folder, scene(R"({"name":"a","base_color":1,"roughness":0,"transmission":1,"ior":1.2})",
                             R"({"mesh":"cube","material":"a"})", true));
  Camera camera = lookAt({0.5, 0, 0}, {0.5, 0, -1}, 20); // on the face, along it: half of the lens is inside
  camera.up = {0, 1, 0};
  camera.apertureDiameter = 0.05;
  const Extremes e = render(loaded, camera, 8, 1024);
  EXPECT_NEAR(e.mean, (1 + 1.2 * 1.2) / 2, 0.02);
}

std::string turnedInsideOut(const std::string& obj) {
  std::istringstream in(obj);
  std::string line, out;
  while (std::getline(in, line)) {
    if (line.starts_with("f ")) {
      std::istringstream words(line.substr(2));
      std::vector<std::string> corners{std::istream_iterator<std::string>(words), {}};
      line = "f";
      for (auto c = corners.rbegin(); c != corners.rend(); ++c)
        line += " " + *c;
    }
    out += line + "\n";
  }
  return out;
}

TEST(WhiteRoom, HidesGlassThatIsWoundInsideOut) {
  const TemporaryFolder folder;
  folder.write("turned.obj", turnedInsideOut(test::cubeObj()));
  const auto loaded =
      loadText(folder, R"({"meshes":[{"name":"cube","file":"turned.obj","rounding":false}],"materials":[)" +
                           std::string(kGlasses) + R"(],"instances":[{"mesh":"cube","material":"crown"}],)" +
                           kWhiteRoom + "}");
  const Extremes e = render(loaded, lookAt({2.4, -2.9, 1.7}, {0, 0, 0}, 20), 32, 16);
  EXPECT_GE(e.mean, 0.995);
  EXPECT_LE(e.most, 1 + 1e-4);
}

TEST(Absorption, OfAHollowSolidIsThatOfItsWalls) {
  const TemporaryFolder folder;
  // A box in a box, wound inside out: a hole. Its faces' indices follow those of the outer box.
  std::string inner = turnedInsideOut(test::boxObj({-0.4, -0.4, -0.4}, {0.4, 0.4, 0.4})), shifted;
  std::istringstream lines(inner);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("f ")) {
      std::istringstream words(line.substr(2));
      line = "f";
      for (int corner; words >> corner;)
        line += " " + std::to_string(corner + 8);
    }
    shifted += line + "\n";
  }
  folder.write("hollow.obj", test::cubeObj() + shifted);
  const auto loaded =
      loadText(folder, R"({"meshes":[{"name":"cube","file":"hollow.obj","rounding":false}],"materials":[)" +
                           std::string(kHaze) + R"(],"instances":[{"mesh":"cube","material":"haze"}],)" +
                           kWhiteRoom + "}");
  const Extremes e = render(loaded, lookAt({-3, 0.01, 0.02}, {0, 0.01, 0.02}, 1e-2), 4, 4096);
  EXPECT_NEAR(e.mean, std::exp(-0.7 * 0.2), 2e-3);
}

TEST(Absorption, ReachesLightThatIsSampledAcrossSurfacesBetweenEqualMedia) {
  // A point light cannot be met by chance: one body of water, or two that touch or overlap, must not differ.
  const TemporaryFolder folder;
  const auto mean = [&](const char* instances) {
    const auto loaded = loadText(folder, scene(std::string(kGlasses) + "," + kHaze, instances, true,
                                               R"("lights":[{"type":"environment","color":0},
                                                  {"type":"point","position":[1,0.1,0.3],"intensity":1}])"));
    Camera camera = lookAt({-0.45, 0.1, 0.3}, {0, 0, -0.4}, 60);
    return render(loaded, camera, 16, 64).mean;
  };
  const std::string block = R"(,{"mesh":"cube","material":"white","scale":0.2,"translate":[0,0,-0.3]})";
  const double one =
      mean((R"({"mesh":"cube","material":"haze","scale":[3,3,3],"translate":[1,0,0]})" + block).c_str());
  const double touching = mean(
      (R"({"mesh":"cube","material":"haze","scale":[1,3,3]},{"mesh":"cube","material":"haze","scale":[2,3,3],
             "translate":[1.5,0,0]})" +
       block)
          .c_str());
  const double sunk = mean(
      (R"({"mesh":"cube","material":"haze","scale":[1,3,3]},{"mesh":"cube","material":"haze","scale":[2.4,3,3],
             "translate":[1.3,0,0]})" +
       block)
          .c_str());
  EXPECT_GT(one, 0.0005);
  EXPECT_NEAR(touching, one, 1e-4 * one);
  EXPECT_NEAR(sunk, one, 1e-4 * one);
}

TEST(Absorption, OfWhatStaysSharpBesideARadius) {
  // An L cannot be rounded and stays as it is: a body of its own medium all the same.
  const TemporaryFolder folder;
  folder.write("l.obj", R"(v 0 0 0
v 2 0 0
v 2 1 0
v 1 1 0
v 1 2 0
v 0 2 0
v 0 0 1
v 2 0 1
v 2 1 1
v 1 1 1
v 1 2 1
v 0 2 1
f 6 5 4 3 2 1
f 7 8 9 10 11 12
f 1 2 8 7
f 2 3 9 8
f 3 4 10 9
f 4 5 11 10
f 5 6 12 11
f 6 1 7 12
)");
  const auto loaded =
      loadText(folder, R"({"meshes":[{"name":"l","file":"l.obj","radius":0.05,"on_nonconvex":"sharp"}],
    "materials":[)" + std::string(kHaze) +
                           R"(],"instances":[{"mesh":"l","material":"haze"}],)" + kWhiteRoom + "}");
  for (const auto& [y, thickness] : {std::pair(0.52, 2.0), std::pair(1.52, 1.0)}) {
    const Extremes e = render(loaded, lookAt({-3, y, 0.53}, {0, y, 0.53}, 1e-2), 4, 4);
    EXPECT_NEAR(e.mean, std::exp(-0.7 * thickness), 1e-5) << y;
  }
}

TEST(WhiteRoom, HidesTheGlassOfTheReports) {
  const std::filesystem::path folder = CHAMFER_SOURCE_DIR "/../shared/data/reports/glass-furnace";
  if (!std::filesystem::is_directory(folder)) GTEST_SKIP() << "the reports are not beside the project";
  unsigned scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".scene.json")) continue;
    const auto loaded = loadScene(entry.path(), folder, name);
    const Extremes e = render(loaded, loaded->camera, 64, 32);
    EXPECT_NEAR(e.mean, 1, 5e-3) << name;
    if (name != "rough.scene.json") {
      EXPECT_LE(e.most, 1 + 1e-4) << name;
    }
    ++scenes;
  }
  EXPECT_GE(scenes, 12u);
}

TEST(WhiteRoom, HidesGlassThatHasAnOpaqueFace) {
  const TemporaryFolder folder;
  folder.write("m.mtl", "newmtl glass\nKd 1 1 1\nd 0\nNi 1.2\nPr 0\nnewmtl white\nKd 1 1 1\nPr 1\n");
  std::string obj = "mtllib m.mtl\n" + test::cubeObj();
  const std::size_t first = obj.find("f "), second = obj.find("f ", first + 2);
  obj.insert(second, "usemtl glass\n");
  obj.insert(first, "usemtl white\n");
  folder.write("painted.obj", obj);
  for (const char* radius : {R"("radius":0.2)", R"("rounding":false)"}) {
    const auto loaded =
        loadText(folder, std::string(R"({"meshes":[{"name":"cube","file":"painted.obj",)") + radius +
                             R"(}],"instances":[{"mesh":"cube"}],)" + kWhiteRoom + "}");
    const Extremes e = render(loaded, lookAt({2.4, -2.9, 1.7}, {0, 0, 0}, 15), 32, 64);
    EXPECT_NEAR(e.mean, 1, 0.01) << radius; // plastic's coat is by a table
  }
}

/// The crossings along a ray, as media see them, with what passes unbent.
std::vector<Crossing> crossingsAlong(const PreparedScene& prepared, Ray ray) {
  const Media media(prepared.surfaces(), prepared.tracer());
  static std::vector<std::optional<TraceHit>> hits; // the crossings point to them
  hits.clear();
  hits.reserve(100);
  std::vector<Crossing> crossings;
  Arrival at{prepared.tracer().stateAt(ray.origin), {}};
  while (hits.size() < 100) {
    hits.push_back(prepared.tracer().intersect(ray, at.state, 0, INFINITY, &at));
    if (!hits.back()) break;
    crossings.push_back(media.crossing(*hits.back(), at, ray.direction));
    ray.origin = crossings.back().hit->position;
    crossings.back().hit = &*hits.back();
  }
  return crossings;
}

TEST(Media, TheIndexIsThatOfBothSides) {
  const TemporaryFolder folder;
  for (const bool rounded : {true, false}) {
    const auto indices = [&](const char* instances) {
      const auto prepared = prepare(loadText(folder, scene(kGlasses, instances, rounded)), {});
      std::vector<double> etas;
      for (const Crossing& c : crossingsAlong(*prepared, {{-3, 0.01, 0.02}, {1, 0, 0}}))
        if (!c.nothing) etas.push_back(std::round(double(c.eta) * 1e4) / 1e4);
      return etas;
    };
    using testing::ElementsAre;
    EXPECT_THAT(indices(R"({"mesh":"cube","material":"crown"})"), ElementsAre(1.5, 0.6667)) << rounded;
    EXPECT_THAT(
        indices(
            R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint","translate":[1,0,0]})"),
        ElementsAre(1.5, 1.2, 0.5556))
        << rounded;
    EXPECT_THAT(
        indices(
            R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"crown","translate":[1,0,0]})"),
        ElementsAre(1.5, 0.6667))
        << rounded;
    EXPECT_THAT(
        indices(
            R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"crown","translate":[1.001,0,0]})"),
        ElementsAre(1.5, 0.6667, 1.5, 0.6667))
        << rounded;
    EXPECT_THAT(
        indices(R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"water","scale":0.5})"),
        ElementsAre(1.5, 0.8867, 1.1278, 0.6667))
        << rounded;
    EXPECT_THAT(indices(R"({"mesh":"cube","material":"crown"},{"mesh":"cube","material":"flint"})"),
                ElementsAre(1.8, 0.5556))
        << rounded;
  }
}

} // namespace
} // namespace chamfer
