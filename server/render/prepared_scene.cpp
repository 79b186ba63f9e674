#include "server/render/prepared_scene.h"

#include "common/error.h"

#include <sstream>

namespace chamfer {
namespace {

std::string shown(double v) {
  std::ostringstream s;
  s.precision(9);
  s << v;
  return s.str();
}

std::shared_ptr<const Rounding> buildRounding(const SceneMesh& mesh, double radius, unsigned threads) {
  PreprocessOptions options;
  options.radius = {radius, false};
  options.onNonConvex = mesh.onNonConvex;
  options.threads = threads;
  try {
    return preprocess(*mesh.mesh, options).rounding;
  } catch (const Error& e) {
    throw Error(e.kind(), "mesh \"" + mesh.name + "\": " + e.what());
  }
}

std::vector<std::shared_ptr<const Rounding>> chooseRoundings(const Scene& scene, const RoundingChoice& choice,
                                                             unsigned threads) {
  std::vector<std::shared_ptr<const Rounding>> roundings(scene.meshes.size());
  if (choice.mode == RoundingMode::Mesh || choice.mode == RoundingMode::Bevel)
    throw Error(ErrorKind::OutOfRange,
                "this version renders rounding=analytic and rounding=none; mesh:K and bevel:N "
                "are not available yet");
  if (choice.mode == RoundingMode::None) return roundings;
  if (!choice.radius) {
    for (std::size_t i = 0; i < roundings.size(); ++i)
      roundings[i] = scene.meshes[i].rounding;
    return roundings;
  }
  const double radius = *choice.radius;
  if (!std::isfinite(radius) || !(radius > 0))
    throw Error(ErrorKind::OutOfRange, "the radius must be above 0, is " + shown(radius));
  const SceneMesh* smallest = nullptr;
  for (const SceneMesh& m : scene.meshes)
    if (!m.staysSharp && m.maxRadius > 0 && (!smallest || m.maxRadius < smallest->maxRadius)) smallest = &m;
  if (smallest && radius >= smallest->maxRadius)
    throw Error(ErrorKind::RadiusTooLarge,
                "the radius " + shown(radius) + " is too large: it must be below " +
                    shown(smallest->maxRadius) + ", the inradius of mesh \"" + smallest->name + "\"");
  for (std::size_t i = 0; i < roundings.size(); ++i)
    if (!scene.meshes[i].staysSharp) roundings[i] = buildRounding(scene.meshes[i], radius, threads);
  return roundings;
}

} // namespace

PreparedScene::PreparedScene(std::shared_ptr<const Scene> scene,
                             std::vector<std::shared_ptr<const Rounding>> roundings)
    : scene_(std::move(scene)), roundings_(std::move(roundings)) {
  const SceneData& data = *scene_->data;
  std::vector<TracedInstance> all = ownInstances();
  all.insert(all.end(), data.extraInstances.begin(), data.extraInstances.end());
  Emitters emitters(*scene_, all);
  tracer_ = makeTracer(std::move(all));
  lights_ = std::make_unique<Lights>(data.environment, data.distantLights, data.pointLights,
                                     std::move(emitters), scene_->bounds, tracer_->bounds().diagonal());
}

std::vector<TracedInstance> PreparedScene::ownInstances() const {
  std::vector<TracedInstance> own = scene_->instances;
  for (std::size_t i = 0; i < own.size(); ++i)
    own[i].rounding = roundings_[scene_->data->instanceSource[i].mesh];
  return own;
}

const Tracer& PreparedScene::ownTracer() const {
  if (scene_->data->extraInstances.empty()) return *tracer_;
  std::call_once(ownOnce_, [&] { ownTracer_ = makeTracer(ownInstances()); });
  return *ownTracer_;
}

std::size_t PreparedScene::memoryBytes() const {
  std::size_t bytes = tracer_->memoryBytes() + lights_->memoryBytes();
  for (const SceneMesh& m : scene_->meshes)
    bytes += m.mesh->positions.size() * sizeof(Point3) + m.mesh->triangles.size() * 3 * sizeof(std::uint32_t);
  for (const Texture& t : scene_->data->textures)
    bytes += t.memoryBytes();
  return bytes;
}

std::size_t PreparedScene::tracedTriangles() const {
  const std::size_t own = scene_->meshes.size();
  std::size_t sum = 0;
  for (const InstanceSource& i : scene_->data->instanceSource) {
    const SceneMesh& m = i.mesh < own ? scene_->meshes[i.mesh] : scene_->data->extraMeshes[i.mesh - own];
    sum += m.mesh->triangles.size();
  }
  return sum;
}

std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene, const RoundingChoice& choice,
                                             unsigned threads) {
  auto roundings = chooseRoundings(*scene, choice, threads);
  return std::make_shared<PreparedScene>(std::move(scene), std::move(roundings));
}

const Tracer& ownTracer(const PreparedScene& prepared) { return prepared.ownTracer(); }
const Scene& sceneOf(const PreparedScene& prepared) { return prepared.scene(); }
std::size_t memoryBytes(const PreparedScene& prepared) { return prepared.memoryBytes(); }
std::size_t tracedTriangles(const PreparedScene& prepared) { return prepared.tracedTriangles(); }

} // namespace chamfer
