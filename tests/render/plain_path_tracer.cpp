#include "tests/render/plain_path_tracer.h"

#include "server/render/path/camera.h"
#include "server/render/path/pixel_filter.h"
#include "tests/render/direction_chi_squared.h"

#include <thread>

namespace chamfer::test {
namespace {

Color plainRadiance(const PreparedScene& prepared, Ray ray, unsigned maxBounces, UniformNumbers& u) {
  RayOrigin from;
  Color sum, throughput = grey(1);
  for (unsigned bounce = 0;; ++bounce) {
    const auto hit = prepared.tracer().intersect(ray, from);
    if (!hit) return sum + throughput * prepared.lights().escaped(Vector3f(ray.direction), 0);
    const SurfacePlace place = prepared.surfaces().place(*hit);
    const bool inside = dot(ray.direction, hit->normal) > 0;
    if (inside && place.material->transmission > 0) {
      const Color& a = place.material->absorption;
      const float d = float(hit->t);
      throughput *= Color{std::exp(-a.r * d), std::exp(-a.g * d), std::exp(-a.b * d)};
    }
    sum += throughput * place.material->emission;
    if (bounce == maxBounces) return sum;
    const Vector3 normal = inside ? -hit->normal : hit->normal;
    const Frame frame{Vector3f(normal)};
    const Vector3f wo = frame.toLocal(Vector3f(-ray.direction));
    if (!(wo.z > 0)) return sum;
    const float lobe = u();
    const SurfaceValues values = prepared.surfaces().values(*hit, place);
    const BsdfSample s = Bsdf(values, wo, inside ? 1 / values.ior : values.ior).sample(lobe, u.pair());
    if (!s.valid) return sum;
    throughput *= s.weight;
    ray = {hit->position, normalize(Vector3(frame.toWorld(s.wi)))};
    if ((dot(ray.direction, normal) > 0) != (s.wi.z > 0)) return sum;
    from = hit->leave(ray.direction);
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
