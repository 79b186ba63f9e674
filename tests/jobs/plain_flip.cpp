#include "tests/jobs/plain_flip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

namespace chamfer::test {
namespace {

using Vec = std::array<double, 3>;
constexpr double kPi = 3.14159265358979323846;

Vec times(const double (&m)[3][3], const Vec& v) {
  Vec r{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      r[i] += m[i][j] * v[j];
  return r;
}

constexpr double kToXyz[3][3] = {
    {0.4123866, 0.3575915, 0.1804505}, {0.2126368, 0.7151830, 0.0721802}, {0.0193306, 0.1191972, 0.9503726}};
constexpr double kToRgb[3][3] = {{3.241003275, -1.537398934, -0.498615861},
                                 {-0.969224334, 1.875930071, 0.041554224},
                                 {0.055639423, -0.204011202, 1.057148933}};
constexpr Vec kWhite = {0.950428545, 1.0, 1.088900371};

Vec yCxCz(const Vec& rgb) {
  const Vec xyz = times(kToXyz, rgb);
  const double x = xyz[0] / kWhite[0], y = xyz[1] / kWhite[1], z = xyz[2] / kWhite[2];
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Vec rgbOf(const Vec& c) {
  const double y = (c[0] + 16) / 116, x = y + c[1] / 500, z = y - c[2] / 200;
  Vec rgb = times(kToRgb, {x * kWhite[0], y * kWhite[1], z * kWhite[2]});
  for (double& v : rgb)
    v = std::clamp(v, 0., 1.);
  return rgb;
}

Vec huntLab(const Vec& rgb) {
  const Vec xyz = times(kToXyz, rgb);
  const auto f = [](double t) {
    const double d = 6. / 29;
    return t > d * d * d ? std::cbrt(t) : t / (3 * d * d) + 4. / 29;
  };
  const double x = f(xyz[0] / kWhite[0]), y = f(xyz[1] / kWhite[1]), z = f(xyz[2] / kWhite[2]);
  const double l = 116 * y - 16;
  return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
}

double hyab(const Vec& p, const Vec& q) {
  return std::abs(p[0] - q[0]) + std::hypot(p[1] - q[1], p[2] - q[2]);
}

double colorError(const Vec& labA, const Vec& labB) {
  const double most = std::pow(hyab(huntLab({0, 1, 0}), huntLab({0, 0, 1})), 0.7);
  const double error = std::pow(hyab(labA, labB), 0.7), knee = 0.4 * most;
  return error < knee ? 0.95 * error / knee : 0.95 + 0.05 * (error - knee) / (most - knee);
}

using Kernel = std::function<double(double x, double y)>;

struct Plane {
  int width, height;
  std::vector<double> values;
  double at(int x, int y) const {
    x = std::clamp(x, 0, width - 1);
    y = std::clamp(y, 0, height - 1);
    return values[std::size_t(y) * std::size_t(width) + std::size_t(x)];
  }
  /// Positive and negative weights are brought to sums of 1 and -1 (of kernels without negative ones: to 1).
  Plane filtered(const Kernel& kernel, int radius) const {
    double positive = 0, negative = 0;
    for (int dy = -radius; dy <= radius; ++dy)
      for (int dx = -radius; dx <= radius; ++dx) {
        const double w = kernel(dx, dy);
        (w > 0 ? positive : negative) += std::abs(w);
      }
    Plane result{width, height, {}};
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int dy = -radius; dy <= radius; ++dy)
          for (int dx = -radius; dx <= radius; ++dx) {
            const double w = kernel(dx, dy);
            sum += (w > 0 ? w / positive : w < 0 ? w / negative : 0) * at(x + dx, y + dy);
          }
        result.values.push_back(sum);
      }
    return result;
  }
};

struct Seen {
  std::vector<Vec> lab;
  std::vector<double> edge, point;
};

Seen seen(const Picture& picture, double ppd, std::optional<double> exposure) {
  const int width = int(picture.width), height = int(picture.height);
  Plane planes[3] = {{width, height, {}}, {width, height, {}}, {width, height, {}}};
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    Vec rgb;
    for (std::size_t c = 0; c < 3; ++c) {
      double v = std::max(0., double(picture.values[i * picture.channels + (picture.channels < 3 ? 0 : c)]));
      if (exposure) {
        v *= std::exp2(*exposure) * 0.6;
        v = v * (2.51 * v + 0.03) / (v * (2.43 * v + 0.59) + 0.14);
      }
      rgb[c] = std::min(v, 1.);
    }
    const Vec c = yCxCz(rgb);
    for (int k = 0; k < 3; ++k)
      planes[k].values.push_back(c[std::size_t(k)]);
  }
  const auto sensitivity = [&](double a1, double b1, double a2, double b2) {
    return [=](double x, double y) {
      const double d2 = (x * x + y * y) / (ppd * ppd);
      return a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * d2 / b1) +
             a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * d2 / b2);
    };
  };
  const int spatial = int(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
  const Plane y = planes[0].filtered(sensitivity(1, 0.0047, 0, 1e-5), spatial);
  const Plane cx = planes[1].filtered(sensitivity(1, 0.0053, 0, 1e-5), spatial);
  const Plane cz = planes[2].filtered(sensitivity(34.1, 0.04, 13.5, 0.025), spatial);

  const double s = 0.5 * 0.082 * ppd;
  const int radius = int(std::ceil(3 * s));
  const auto bell = [&](double u, double v) { return std::exp(-(u * u + v * v) / (2 * s * s)); };
  Plane grey = planes[0];
  for (double& v : grey.values)
    v = (v + 16) / 116;
  const Plane dx = grey.filtered([&](double u, double v) { return -u * bell(u, v); }, radius);
  const Plane dy = grey.filtered([&](double u, double v) { return -v * bell(u, v); }, radius);
  const Plane dxx =
      grey.filtered([&](double u, double v) { return (u * u / (s * s) - 1) * bell(u, v); }, radius);
  const Plane dyy =
      grey.filtered([&](double u, double v) { return (v * v / (s * s) - 1) * bell(u, v); }, radius);
  Seen result;
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    result.lab.push_back(huntLab(rgbOf({y.values[i], cx.values[i], cz.values[i]})));
    result.edge.push_back(std::hypot(dx.values[i], dy.values[i]));
    result.point.push_back(std::hypot(dxx.values[i], dyy.values[i]));
  }
  return result;
}

} // namespace

std::vector<double> plainFlip(const Picture& a, const Picture& b, double ppd, std::optional<double> exposure,
                              bool colorOnly) {
  const Seen sa = seen(a, ppd, exposure), sb = seen(b, ppd, exposure);
  std::vector<double> map;
  for (std::size_t i = 0; i < a.pixels(); ++i) {
    const double edge = std::abs(sa.edge[i] - sb.edge[i]), point = std::abs(sa.point[i] - sb.point[i]);
    const double feature = colorOnly ? 0 : std::sqrt(std::max(edge, point) / std::sqrt(2.));
    map.push_back(std::pow(colorError(sa.lab[i], sb.lab[i]), 1 - feature));
  }
  return map;
}

double plainColorError(const double (&a)[3], const double (&b)[3]) {
  return colorError(huntLab({a[0], a[1], a[2]}), huntLab({b[0], b[1], b[2]}));
}

} // namespace chamfer::test
