#include "server/render/surface/tangent_frame.h"

namespace chamfer {

bool holdsNormals(const Texture& texture) {
  Color mean;
  for (unsigned y = 0; y < texture.height(); ++y)
    for (unsigned x = 0; x < texture.width(); ++x)
      mean += texture.pixel(x, y) * (1 / (float(texture.width()) * float(texture.height())));
  return mean.b > 0.5f && mean.b > mean.r && mean.b > mean.g;
}

Vector3 TangentFrame::turned(const Color& texel, const std::array<double, 2>& strength) const {
  const Vector3 n = tangent * (strength[0] * (2 * double(texel.r) - 1)) +
                    bitangent * (strength[1] * (2 * double(texel.g) - 1)) +
                    normal * (2 * double(texel.b) - 1);
  const double size = length(n);
  return size > 0 ? n / size : normal;
}

std::optional<TangentFrame> tangentFrame(const TriangleMesh& mesh, std::uint32_t triangle,
                                         const Vector3& normal, const Transform& worldFromObject) {
  const auto uv = uvCorners(mesh, triangle);
  if (!uv) return {};
  const double u1 = double((*uv)[1][0]) - double((*uv)[0][0]), v1 = double((*uv)[1][1]) - double((*uv)[0][1]);
  const double u2 = double((*uv)[2][0]) - double((*uv)[0][0]), v2 = double((*uv)[2][1]) - double((*uv)[0][1]);
  const double area = u1 * v2 - u2 * v1;
  if (area == 0 || !std::isfinite(area)) return {};
  const auto& corners = mesh.triangles[triangle];
  const Point3& a = mesh.positions[corners[0]];
  const Vector3 e1 = worldFromObject(mesh.positions[corners[1]] - a);
  const Vector3 e2 = worldFromObject(mesh.positions[corners[2]] - a);
  // Both up to a positive factor: only their directions count.
  const double sign = area > 0 ? 1 : -1;
  const Vector3 alongU = (e1 * v2 - e2 * v1) * sign, alongV = (e2 * u1 - e1 * u2) * sign;
  const Vector3 t = alongU - normal * dot(alongU, normal);
  const double size = length(t);
  if (!(size > 1e-6 * length(alongU))) return {}; // no direction left in the plane
  TangentFrame f{t / size, {}, normal};
  f.bitangent = cross(normal, f.tangent);
  if (dot(f.bitangent, alongV) < 0) f.bitangent = -f.bitangent;
  return f;
}

} // namespace chamfer
