#include "server/render/tracing/embree_mesh.h"

#include "common/error.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <string>
#include <thread>

namespace chamfer {
namespace {

/// Bytes that Embree has allocated, by its own count.
std::atomic<std::ptrdiff_t> embreeBytes{0};

/// Fixed: AVX-512 answers with other bits than AVX2, and is no faster here.
constexpr const char* kInstructionSet = "avx2";

constexpr const char* kCancelled = "cancelled while a bounding volume hierarchy was built";

void checkDevice(const char* step) {
  const RTCError error = rtcGetDeviceError(embreeDevice());
  if (error == RTC_ERROR_CANCELLED) throw Error(ErrorKind::Cancelled, kCancelled);
  if (error != RTC_ERROR_NONE)
    throw Error(ErrorKind::Internal, std::string("Embree failed to ") + step + " (error " +
                                         std::to_string(error) +
                                         (error == RTC_ERROR_OUT_OF_MEMORY ? ", out of memory)" : ")"));
}

} // namespace

RTCDevice embreeDevice() {
  static const RTCDevice shared = [] {
    const RTCDevice made = rtcNewDevice((std::string("isa=") + kInstructionSet).c_str());
    if (!made)
      throw Error(ErrorKind::Internal, "Embree cannot start on this machine; it needs a processor with AVX2");
    rtcSetDeviceMemoryMonitorFunction(
        made,
        [](void*, ssize_t bytes, bool) {
          embreeBytes += bytes;
          return true;
        },
        nullptr);
    return made;
  }();
  return shared;
}

std::string_view rayInstructionSet() { return kInstructionSet; }

EmbreeScene::EmbreeScene() : scene_(rtcNewScene(embreeDevice())) {
  rtcSetSceneFlags(scene_, RTCSceneFlags(RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION));
}
EmbreeScene::~EmbreeScene() { rtcReleaseScene(scene_); }

void EmbreeScene::attach(RTCGeometry geometry) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::build(const std::function<bool()>& cancelled) {
  static std::mutex oneAtATime; // so that the bytes counted are this scene's
  std::unique_lock lock(oneAtATime, std::defer_lock);
  while (!lock.try_lock()) {
    if (cancelled && cancelled()) throw Error(ErrorKind::Cancelled, kCancelled);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::ptrdiff_t before = embreeBytes;
  if (cancelled)
    rtcSetSceneProgressMonitorFunction(
        scene_, [](void* ask, double) { return !(*static_cast<const std::function<bool()>*>(ask))(); },
        const_cast<std::function<bool()>*>(&cancelled));
  rtcCommitScene(scene_);
  rtcSetSceneProgressMonitorFunction(scene_, nullptr, nullptr);
  checkDevice("build a bounding volume hierarchy");
  const std::ptrdiff_t after = embreeBytes;
  bytes_ = after > before ? std::size_t(after - before) : 0;
}

TracedMesh::TracedMesh(std::shared_ptr<const TriangleMesh> mesh, const std::function<bool()>& cancelled)
    : mesh_(std::move(mesh)) {
  for (const auto& t : mesh_->triangles)
    for (const std::uint32_t v : t)
      bounds_.extend(mesh_->positions[v]);
  centre_ = bounds_.empty() ? Vector3() : Vector3(bounds_.centre());
  const RTCGeometry geometry = rtcNewGeometry(embreeDevice(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh_->positions.size()));
  auto* indices = static_cast<std::uint32_t*>(
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t),
                              mesh_->triangles.size()));
  if (!positions || !indices) checkDevice("hold a mesh");
  for (const Point3& p : mesh_->positions) {
    const Vector3 local = Vector3(p) - centre_;
    for (std::size_t k = 0; k < 3; ++k)
      *positions++ = float(local[k]);
  }
  for (const auto& t : mesh_->triangles)
    for (const std::uint32_t v : t)
      *indices++ = v;
  scene_.attach(geometry);
  scene_.build(cancelled);
}

const ClosedSolids& TracedMesh::closed() const {
  std::call_once(closedOnce_, [this] { closed_ = closedSolids(*mesh_); });
  return closed_;
}

std::shared_ptr<const TracedMesh> makeTracedMesh(std::shared_ptr<const TriangleMesh> mesh,
                                                 const std::function<bool()>& cancelled) {
  return std::make_shared<TracedMesh>(std::move(mesh), cancelled);
}

std::size_t memoryBytes(const TracedMesh& mesh) { return mesh.bytes(); }

namespace {

struct ProbeQuery {
  RTCIntersectContext context; // first, so that Embree's pointer to it is ours
  std::span<MeshHit> hits;
  std::size_t count;
};

/// Notes the triangle and lets the ray go on.
void probeFilter(const RTCFilterFunctionNArguments* args) {
  auto& q = *reinterpret_cast<ProbeQuery*>(args->context);
  const auto& ray = *reinterpret_cast<const RTCRay*>(args->ray);
  const auto& hit = *reinterpret_cast<const RTCHit*>(args->hit);
  args->valid[0] = 0;
  const auto kept = q.hits.first(std::min(q.count, q.hits.size()));
  for (const MeshHit& seen : kept)
    if (seen.triangle == hit.primID) return; // Embree may offer a triangle several times
  if (q.count < q.hits.size()) q.hits[q.count] = {double(ray.tfar), hit.primID};
  ++q.count;
}

} // namespace

std::size_t allHits(const TracedMesh& mesh, const Ray& ray, double tfar, std::span<MeshHit> hits) {
  ProbeQuery q;
  rtcInitIntersectContext(&q.context);
  q.context.filter = &probeFilter;
  q.hits = hits;
  q.count = 0;
  RTCRayHit rayHit;
  const Vector3 origin = Vector3(ray.origin) - mesh.centre();
  rayHit.ray = {float(origin.x),
                float(origin.y),
                float(origin.z),
                0,
                float(ray.direction.x),
                float(ray.direction.y),
                float(ray.direction.z),
                0,
                above(tfar),
                ~0u,
                0,
                0};
  rayHit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rayHit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(mesh.scene(), &q.context, &rayHit);
  return q.count;
}

} // namespace chamfer
