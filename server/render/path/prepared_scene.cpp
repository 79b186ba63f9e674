#include "server/render/path/prepared_scene.h"

#include "common/error.h"
#include "common/text.h"

#include <map>
#include <set>

namespace chamfer {
namespace {

std::shared_ptr<const Rounding> buildRounding(const SceneMesh& mesh, const RoundingOptions& wanted,
                                              unsigned threads) {
  PreprocessOptions options = optionsOf(wanted);
  options.keepTriangles = true; // the mesh is what is traced: hulls are in it already
  options.threads = threads;
  try {
    return preprocess(*mesh.mesh, options).rounding;
  } catch (const Error& e) {
    throw Error(e.kind(), "mesh \"" + mesh.name + "\": " + e.what());
  }
}

/// As the mesh was rounded, but for what the choice names.
RoundingOptions wantedOptions(const SceneMesh& mesh, const RoundingChoice& choice) {
  RoundingOptions options = mesh.options;
  if (choice.radius) options.radius = *choice.radius / mesh.radiusUnit, options.relative = false;
  if (choice.radiusClamp) options.clamp = *choice.radiusClamp;
  return options;
}

void checkChoice(const Scene& scene, const RoundingChoice& choice) {
  if (choice.radiusClamp && !(*choice.radiusClamp >= 0 && *choice.radiusClamp <= kMostClamp))
    throw Error(ErrorKind::OutOfRange, "the radius clamp must be from 0 to " + numberText(kMostClamp) +
                                           ", is " + numberText(*choice.radiusClamp));
  if (!choice.radius) return;
  const double radius = *choice.radius;
  if (!std::isfinite(radius) || !(radius > 0))
    throw Error(ErrorKind::OutOfRange, "the radius must be above 0, is " + numberText(radius));
  const SceneMesh* smallest = nullptr;
  for (const SceneMesh& m : scene.meshes)
    if (!m.staysSharp && m.maxRadius > 0 && wantedOptions(m, choice).clamp == 0 &&
        (!smallest || m.maxRadius < smallest->maxRadius))
      smallest = &m;
  if (smallest && radius >= smallest->maxRadius)
    throw Error(ErrorKind::RadiusTooLarge,
                "the radius " + numberText(radius) + " is too large: it must be below " +
                    numberText(smallest->maxRadius) + ", the inradius of mesh \"" + smallest->name + "\"");
}

std::vector<std::shared_ptr<const Rounding>> chooseRoundings(const Scene& scene, const RoundingChoice& choice,
                                                             unsigned threads,
                                                             const std::function<bool()>& cancelled) {
  std::vector<std::shared_ptr<const Rounding>> roundings(scene.meshes.size());
  if (choice.mode == RoundingMode::None) return roundings;
  checkChoice(scene, choice);
  for (std::size_t i = 0; i < roundings.size(); ++i) {
    if (cancelled && cancelled()) throw Error(ErrorKind::Cancelled, "cancelled while its rounding was built");
    const SceneMesh& mesh = scene.meshes[i];
    const RoundingOptions wanted = wantedOptions(mesh, choice);
    if (mesh.staysSharp || !(wanted.radius > 0)) continue; // sharp
    roundings[i] =
        mesh.rounding && wanted == mesh.options ? mesh.rounding : buildRounding(mesh, wanted, threads);
  }
  return roundings;
}

std::vector<MeshForm> chooseForms(const Scene& scene, const RoundingChoice& choice,
                                  const std::vector<std::shared_ptr<const Rounding>>& roundings,
                                  const std::function<bool()>& cancelled, const MeshBudget& budget) {
  std::vector<MeshForm> forms(roundings.size());
  if (choice.mode == RoundingMode::Mesh) {
    const std::uint64_t bytes = explicitBytes(roundings, choice.count, budget.bytes);
    if (budget.reserve) budget.reserve(bytes);
  }
  // Meshes of one file and radius share what is made of them.
  using Key = std::pair<const TriangleMesh*, const Rounding*>;
  std::map<Key, MeshForm> made;
  for (std::size_t i = 0; i < forms.size(); ++i) {
    if (!roundings[i]) continue;
    const auto& mesh = scene.meshes[i].mesh;
    const auto [entry, added] = made.try_emplace({mesh.get(), roundings[i].get()});
    MeshForm& form = entry->second;
    if (added) {
      form.mode = choice.mode;
      form.rounding = roundings[i];
      if (choice.mode == RoundingMode::Mesh)
        form.explicitMesh =
            std::make_shared<RoundedMesh>(*mesh, roundings[i]->view(), choice.count, cancelled);
      if (choice.mode != RoundingMode::Bevel && OriginalSurface::matters(*mesh))
        form.original = std::make_shared<OriginalSurface>(mesh, roundings[i]);
    }
    forms[i] = form;
  }
  return forms;
}

} // namespace

PreparedScene::PreparedScene(std::shared_ptr<const Scene> scene, std::vector<MeshForm> forms, unsigned probes)
    : surfaces_(std::move(scene), std::move(forms), probes) {
  const SceneData& data = *this->scene().data;
  std::vector<TracedInstance> all = surfaces_.ownInstances();
  all.insert(all.end(), data.extraInstances.begin(), data.extraInstances.end());
  Emitters emitters(surfaces_, all);
  tracer_ = makeTracer(std::move(all));
  lights_ = std::make_unique<Lights>(data.environment, data.distantLights, data.pointLights,
                                     std::move(emitters), this->scene().bounds, tracer_->bounds().diagonal());
}

const Tracer& PreparedScene::ownTracer() const {
  if (scene().data->extraInstances.empty()) return *tracer_;
  std::call_once(ownOnce_, [&] { ownTracer_ = makeTracer(surfaces_.ownInstances()); });
  return *ownTracer_;
}

std::size_t PreparedScene::memoryBytes() const {
  std::size_t bytes = tracer_->memoryBytes() + lights_->memoryBytes() + surfaces_.memoryBytes();
  for (const SceneMesh& m : scene().meshes)
    bytes += m.mesh->positions.size() * sizeof(Point3) + m.mesh->triangles.size() * 3 * sizeof(std::uint32_t);
  std::set<const void*> images;
  for (const Texture& t : scene().data->textures)
    if (images.insert(t.pixels()).second) bytes += t.memoryBytes();
  return bytes;
}

std::size_t PreparedScene::tracedTriangles() const {
  std::size_t sum = 0;
  for (const InstanceSource& i : scene().data->instanceSource)
    sum += surfaces_.tracedMesh(i.mesh).triangles.size();
  return sum;
}

std::shared_ptr<const PreparedScene> prepare(std::shared_ptr<const Scene> scene, const RoundingChoice& choice,
                                             unsigned threads, const std::function<bool()>& cancelled,
                                             const MeshBudget& budget) {
  if (choice.mode == RoundingMode::Bevel && (choice.count < 1 || choice.count > kMostBevelProbes))
    throw Error(ErrorKind::OutOfRange, "a bevel takes 1 to " + std::to_string(kMostBevelProbes) +
                                           " probes, not " + std::to_string(choice.count));
  auto forms =
      chooseForms(*scene, choice, chooseRoundings(*scene, choice, threads, cancelled), cancelled, budget);
  return std::make_shared<PreparedScene>(std::move(scene), std::move(forms), choice.count);
}

const Tracer& ownTracer(const PreparedScene& prepared) { return prepared.ownTracer(); }
const Scene& sceneOf(const PreparedScene& prepared) { return prepared.scene(); }
std::size_t memoryBytes(const PreparedScene& prepared) { return prepared.memoryBytes(); }
std::size_t tracedTriangles(const PreparedScene& prepared) { return prepared.tracedTriangles(); }

} // namespace chamfer
