#include "tests/preprocess/polygon_solid.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <sstream>

namespace chamfer {
namespace {

std::ostringstream exact() {
  std::ostringstream text;
  text.precision(17);
  return text;
}

template <class Polygons>
void writeCorners(std::ostream& out, const Polygons& loop, std::uint32_t base) {
  for (const std::uint32_t v : loop)
    out << ' ' << v + base;
  out << '\n';
}

/// Vertices and faces as OFF and PLY have them.
void writeTables(std::ostream& out, const PolygonSolid& solid) {
  for (const auto& v : solid.vertices)
    out << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& loop : solid.faces) {
    out << loop.size();
    writeCorners(out, loop, 0);
  }
}

} // namespace

void PolygonSolid::insertEdgeVertices(double chance, oracle::Random& random) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> side; // which sides of an edge get vertices: bits
  for (auto& loop : faces) {
    std::vector<std::uint32_t> grown;
    for (std::size_t i = 0; i < loop.size(); ++i) {
      const std::uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
      grown.push_back(a);
      const auto [entry, added] = side.try_emplace(std::minmax(a, b), 0);
      if (added && random.uniform() < chance) entry->second = 1 + int(random.below(3));
      if (!(entry->second >> (added ? 0 : 1) & 1)) continue;
      std::vector<double> places(1 + random.below(3));
      for (double& t : places)
        t = 0.05 + 0.9 * random.uniform();
      std::sort(places.begin(), places.end());
      for (const double t : places) {
        grown.push_back(std::uint32_t(vertices.size()));
        vertices.push_back(vertices[a] + (vertices[b] - vertices[a]) * t);
      }
    }
    loop = std::move(grown);
  }
}

void PolygonSolid::repeatFaces(bool all, bool otherSide, bool ownVertices, oracle::Random& random) {
  std::vector<std::vector<std::uint32_t>> again;
  if (all)
    again = faces;
  else
    again.push_back(faces[random.below(faces.size())]);
  std::map<std::uint32_t, std::uint32_t> copy;
  for (auto& loop : again) {
    if (otherSide) std::reverse(loop.begin(), loop.end());
    std::rotate(loop.begin(), loop.begin() + std::ptrdiff_t(random.below(loop.size())), loop.end());
    for (std::uint32_t& v : loop) {
      if (!ownVertices) continue;
      const auto [entry, added] = copy.try_emplace(v, std::uint32_t(vertices.size()));
      if (added) vertices.push_back(vertices[v]);
      v = entry->second;
    }
    faces.push_back(loop);
  }
}

void PolygonSolid::joinFaces(std::size_t most, oracle::Random& random) {
  const auto convex = [&](const std::vector<std::uint32_t>& loop) {
    Eigen::Vector3d area(0, 0, 0);
    for (std::size_t i = 0; i < loop.size(); ++i)
      area += vertices[loop[i]].cross(vertices[loop[(i + 1) % loop.size()]]);
    for (std::size_t i = 0; i < loop.size(); ++i)
      for (std::size_t k = i + 1; k < loop.size(); ++k)
        for (std::size_t m = k + 1; m < loop.size(); ++m) // every three corners turn the same way
          if (!((vertices[loop[k]] - vertices[loop[i]])
                    .cross(vertices[loop[m]] - vertices[loop[i]])
                    .dot(area) > 0.05 * area.squaredNorm() / double(loop.size() * loop.size())))
            return false;
    return true;
  };
  for (std::size_t i = faces.size(); i > 1; --i)
    std::swap(faces[i - 1], faces[random.below(i)]);
  std::vector<std::vector<std::uint32_t>> joined;
  while (!faces.empty()) {
    std::vector<std::uint32_t> loop = std::move(faces.back());
    faces.pop_back();
    for (bool grown = true; grown && loop.size() < most;) {
      grown = false;
      for (std::size_t f = 0; f < faces.size() && !grown; ++f)
        for (std::size_t i = 0; i < loop.size() && !grown; ++i) {
          std::vector<std::uint32_t> other = faces[f];
          const auto at = std::find(other.begin(), other.end(), loop[(i + 1) % loop.size()]);
          if (at == other.end()) continue;
          std::rotate(other.begin(), at, other.end());
          if (other[1] != loop[i] || loop.size() + other.size() - 2 > most) continue; // b a ...
          std::vector<std::uint32_t> both = loop;
          both.insert(both.begin() + std::ptrdiff_t(i) + 1, other.begin() + 2, other.end());
          if (!convex(both)) continue;
          loop = std::move(both);
          faces.erase(faces.begin() + std::ptrdiff_t(f));
          grown = true;
        }
    }
    joined.push_back(std::move(loop));
  }
  faces = std::move(joined);
}

void PolygonSolid::beginFacesAnywhere(oracle::Random& random) {
  for (auto& loop : faces)
    std::rotate(loop.begin(), loop.begin() + std::ptrdiff_t(random.below(loop.size())), loop.end());
}

std::string PolygonSolid::obj() const {
  std::ostringstream out = exact();
  for (const auto& v : vertices)
    out << "v " << v.x() << ' ' << v.y() << ' ' << v.z() << '\n';
  for (const auto& loop : faces) {
    out << 'f';
    writeCorners(out, loop, 1);
  }
  return out.str();
}

std::string PolygonSolid::off() const {
  std::ostringstream out = exact();
  out << "OFF\n" << vertices.size() << ' ' << faces.size() << " 0\n";
  writeTables(out, *this);
  return out.str();
}

std::string PolygonSolid::ply() const {
  std::ostringstream out = exact();
  out << "ply\nformat ascii 1.0\nelement vertex " << vertices.size()
      << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << faces.size()
      << "\nproperty list int int vertex_indices\nend_header\n";
  writeTables(out, *this);
  return out.str();
}

std::string PolygonSolid::stl() const {
  std::ostringstream out = exact();
  out << "solid s\n";
  for (const auto& loop : faces)
    for (std::size_t i = 1; i + 1 < loop.size(); ++i) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (const std::uint32_t c : {loop[0], loop[i], loop[i + 1]})
        out << "vertex " << vertices[c].x() << ' ' << vertices[c].y() << ' ' << vertices[c].z() << '\n';
      out << "endloop\nendfacet\n";
    }
  out << "endsolid s\n";
  return out.str();
}

std::string PolygonSolid::text(const std::string& format) const {
  return format == "obj" ? obj() : format == "off" ? off() : format == "ply" ? ply() : stl();
}

} // namespace chamfer
