#include "server/render/light/environment.h"

#include "server/render/path/warp.h"

namespace chamfer {
namespace {

/// Horizontal axes of a frame about `up`: x is the world's x axis as near as it goes (z where up is x).
void horizontalAxes(const Vector3& up, Vector3f& x, Vector3f& y, Vector3f& z) {
  const Vector3 u = normalize(up);
  const Vector3 reference = std::abs(u.x) < 0.9 ? Vector3(1, 0, 0) : Vector3(0, 0, 1);
  const Vector3 a = normalize(reference - u * dot(reference, u));
  x = Vector3f(a);
  y = Vector3f(cross(u, a));
  z = Vector3f(u);
}

} // namespace

Environment::Environment(const Vector3& up) { horizontalAxes(up, x_, y_, up_); }

Environment Environment::constant(const Color& radiance) {
  Environment e({0, 0, 1});
  e.gradient_ = {radiance, radiance, radiance};
  e.tabulate(1, 16); // rows only: equal areas need no columns
  return e;
}

Environment Environment::sky(const SkyGradient& gradient, const Vector3& up) {
  Environment e(up);
  e.gradient_ = gradient;
  e.tabulate(1, 64);
  return e;
}

Environment Environment::image(std::shared_ptr<const Texture> image, float strength, double rotationDegrees,
                               const Vector3& up) {
  Environment e(up);
  e.image_ = std::move(image);
  e.strength_ = strength;
  e.turn_ = float(rotationDegrees / 360);
  e.tabulate(std::min(e.image_->width(), 1024u), std::min(e.image_->height(), 512u));
  return e;
}

Float2 Environment::mapFromDirection(const Vector3f& local) const {
  const float u = std::atan2(local.y, local.x) / (2 * kPi) + 0.5f - turn_;
  // atan2 keeps its digits near the poles, where acos loses them.
  const float v = std::atan2(std::sqrt(local.x * local.x + local.y * local.y), local.z) * kInvPi;
  return {std::min(u - std::floor(u), 0x1.fffffep-1f), std::clamp(v, 0.f, 1.f)};
}

Color Environment::radiance(const Vector3f& d) const {
  if (image_) {
    const Float2 m = mapFromDirection({dot(d, x_), dot(d, y_), dot(d, up_)});
    return image_->at(m.x, 1 - m.y) * strength_;
  }
  const float height = dot(d, up_);
  if (height < 0) return gradient_.ground;
  return lerp(gradient_.horizon, gradient_.zenith, std::sqrt(std::min(height, 1.f)));
}

void Environment::tabulate(unsigned width, unsigned height) {
  // Mean over each cell: a cell whose centre happens to be dark must not lose its light.
  const unsigned nx = image_ ? (image_->width() + width - 1) / width : 1;
  const unsigned ny = image_ ? (image_->height() + height - 1) / height : 4;
  std::vector<float> values(std::size_t(width) * height);
  double sum = 0, largest = 0;
  for (unsigned y = 0; y < height; ++y)
    for (unsigned x = 0; x < width; ++x) {
      double cell = 0;
      for (unsigned j = 0; j < ny; ++j)
        for (unsigned i = 0; i < nx; ++i) {
          const double u = (x + (i + 0.5) / nx) / width, v = (y + (j + 0.5) / ny) / height;
          const double theta = v * std::numbers::pi;
          Color c;
          if (image_)
            c = image_->at(float(u), float(1 - v)) * strength_;
          else
            c = radiance(up_ * float(std::cos(theta)) + x_ * float(std::sin(theta)));
          cell += luminance(c) * std::sin(theta);
          largest = std::max(largest, double(luminance(c)));
        }
      values[std::size_t(y) * width + x] = float(cell / (nx * ny));
      sum += cell / (nx * ny);
    }
  meanLuminance_ = float(sum / (double(width) * height) * std::numbers::pi / 2);
  if (meanLuminance_ > 0) contrast_ = float(largest / meanLuminance_);
  table_ = Distribution2D(width, height, values);
}

Environment::Sample Environment::sample(const Float2& u) const {
  const Distribution2D::Point p = table_.sample(u);
  const float theta = p.y * kPi, phi = (p.x - 0.5f + turn_) * 2 * kPi;
  const float sine = std::sin(theta);
  if (!(sine > 0)) return {up_, 0};
  const Vector3f d =
      normalize(x_ * (sine * std::cos(phi)) + y_ * (sine * std::sin(phi)) + up_ * std::cos(theta));
  return {d, p.density / (2 * kPi * kPi * sine)};
}

float Environment::pdf(const Vector3f& d) const {
  const Vector3f local{dot(d, x_), dot(d, y_), dot(d, up_)};
  const float sine = std::sqrt(local.x * local.x + local.y * local.y);
  if (!(sine > 0)) return 0;
  const Float2 m = mapFromDirection(local);
  return table_.density(m.x, m.y) / (2 * kPi * kPi * sine);
}

std::size_t Environment::memoryBytes() const {
  return table_.memoryBytes() + (image_ ? image_->memoryBytes() : 0);
}

} // namespace chamfer
