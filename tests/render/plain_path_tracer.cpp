#include "tests/render/plain_path_tracer.h"

#include "server/render/path/camera.h"
#include "server/render/path/media.h"
#include "server/render/path/pixel_filter.h"
#include "tests/render/direction_chi_squared.h"

#include <thread>

namespace chamfer::test {
namespace {

Color plainRadiance(const PreparedScene& prepared, Ray ray, unsigned maxBounces, UniformNumbers& u) {
  const Media media(prepared.surfaces(), prepared.tracer());
  Arrival arrival{prepared.tracer().stateAt(ray.origin), {}};
  Color sum, throughput = grey(1);
  for (unsigned bounce = 0;;) {
    const auto met = prepared.tracer().intersect(ray, arrival.state, 0, INFINITY, &arrival);
    if (!met) return sum + throughput * prepared.lights().escaped(Vector3f(ray.direction), 0);
    const Crossing crossing = media.crossing(*met, arrival, ray.direction);
    const TraceHit& hit = *crossing.hit;
    throughput *= transmittance(crossing.before, hit.t);
    if (crossing.nothing) {
      ray.origin = hit.position;
      continue;
    }
    sum += throughput * crossing.place.material->emission;
    if (bounce++ == maxBounces) return sum;
    const Vector3 normal = dot(ray.direction, hit.normal) > 0 ? -hit.normal : hit.normal;
    const Frame frame{Vector3f(normal)};
    const Vector3f wo = frame.toLocal(Vector3f(-ray.direction));
    if (!(wo.z > 0)) return sum;
    const float lobe = u();
    const BsdfSample s =
        Bsdf(prepared.surfaces().values(hit, crossing.place), wo, crossing.eta).sample(lobe, u.pair());
    if (!s.valid) return sum;
    throughput *= s.weight;
    ray = {hit.position, normalize(Vector3(frame.toWorld(s.wi)))};
    if ((dot(ray.direction, normal) > 0) != (s.wi.z > 0)) return sum;
  }
}

} // namespace

Image renderPlainly(const PreparedScene& prepared, unsigned width, unsigned height, unsigned samples,
                    unsigned maxBounces, unsigned seed) {
  Image image{width, height, std::vector<float>(std::size_t(width) * height * 4, 1)};
  const CameraRays camera(prepared.scene().camera, width, height);
  const auto row = [&](unsigned y) {
    for (unsigned x = 0; x < width; ++x) {
      UniformNumbers u(mixBits(mixBits(seed + 1ull) + std::uint64_t(y) * width + x));
      Color sum;
      for (unsigned i = 0; i < samples; ++i) {
        const Float2 offset = PixelFilter::instance().sample(u.pair());
        const Ray ray = camera.ray(x + 0.5 + double(offset.x), y + 0.5 + double(offset.y), u.pair());
        sum += plainRadiance(prepared, ray, maxBounces, u) * (1 / float(samples));
      }
      float* out = image.rgba.data() + 4 * (std::size_t(y) * width + x);
      out[0] = sum.r, out[1] = sum.g, out[2] = sum.b;
    }
  };
  std::vector<std::jthread> threads;
  const unsigned count = std::max(1u, std::thread::hardware_concurrency());
  for (unsigned t = 0; t < count; ++t)
    threads.emplace_back([&, t] {
      for (unsigned y = t; y < height; y += count)
        row(y);
    });
  threads.clear(); // joins
  return image;
}

} // namespace chamfer::test
