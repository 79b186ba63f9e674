#include "preprocess/mesh.h"

#include "common/error.h"
#include "common/rounding.h"
#include "preprocess/components/diagonals.h"
#include "preprocess/read/read_formats.h"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace chamfer {

std::string readFile(const std::filesystem::path& path) {
  const std::string name = path.filename().string();
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(ErrorKind::NotFound, name + ": no such file");
  if (!std::filesystem::is_regular_file(path, error)) throw Error(ErrorKind::NotFound, name + ": not a file");
  std::ifstream file(path, std::ios::binary);
  const auto size = std::filesystem::file_size(path, error);
  if (!file || error) throw Error(ErrorKind::NotFound, name + ": cannot be opened");
  std::string bytes(size, '\0');
  file.read(bytes.data(), std::streamsize(size));
  if (file.gcount() != std::streamsize(size))
    throw Error(ErrorKind::Malformed, name + ": cannot be read to its end");
  return bytes;
}

void appendPolygon(TriangleMesh& mesh, std::uint32_t face, std::span<const std::uint32_t> corners,
                   std::span<const std::uint32_t> uvs) {
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    mesh.triangles.push_back({corners[0], corners[i], corners[i + 1]});
    mesh.faceOfTriangle.push_back(face);
    if (!uvs.empty()) mesh.uvTriangles.push_back({uvs[0], uvs[i], uvs[i + 1]});
  }
}

void checkSize(const TriangleMesh& mesh, const TextPlace& place) {
  // Three half-edges a triangle must be countable, and kNone is no index.
  constexpr std::size_t kMostTriangles = kNone / 3, kMostPositions = kNone;
  if (mesh.triangles.size() >= kMostTriangles || mesh.positions.size() >= kMostPositions)
    malformed(place, "more than " + std::to_string(kMostTriangles) + " triangles or " +
                         std::to_string(kMostPositions) + " vertices; split the mesh");
}

void warnRepeats(std::span<const std::uint32_t> corners, const TextPlace& place, ReadWarnings& warnings) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    if (corners[i] == corners[(i + 1) % corners.size()]) {
      warnings.add("repeats", place, "a face names the same vertex twice in a row; the repeat is dropped");
      return;
    }
}

void settleTextureCoordinates(TriangleMesh& mesh) {
  for (auto& triangle : mesh.uvTriangles)
    for (std::uint32_t& uv : triangle)
      if (uv != kNone && std::isnan(mesh.uvs[uv][0])) uv = kNone;
  for (std::array<float, 2>& uv : mesh.uvs)
    if (std::isnan(uv[0])) uv = {0, 0};
  const auto any = [](const std::array<std::uint32_t, 3>& t) {
    return t[0] != kNone || t[1] != kNone || t[2] != kNone;
  };
  if (std::any_of(mesh.uvTriangles.begin(), mesh.uvTriangles.end(), any)) return;
  mesh.uvTriangles.clear();
  mesh.uvs.clear();
}

TriangleMesh readMesh(const std::filesystem::path& path, const std::filesystem::path& top) {
  const std::string name = path.filename().string(), extension = lowerCase(path.extension().string());
  TriangleMesh mesh;
  if (extension == ".obj")
    mesh = readObj(readFile(path), path, top);
  else if (extension == ".stl")
    mesh = readStl(readFile(path), name);
  else if (extension == ".ply")
    mesh = readPly(readFile(path), name);
  else if (extension == ".off")
    mesh = readOff(readFile(path), name);
  else
    malformed({name}, "the name ends in " + inQuotes(extension) + "; .obj, .stl, .ply and .off are read");
  if (mesh.triangles.empty())
    malformed({name},
              "no faces (" + std::to_string(mesh.positions.size()) + " vertices); nothing can be rounded");
  chooseDiagonals(mesh);
  return mesh;
}

std::string placeOfTriangle(const TriangleMesh& mesh, std::size_t triangle) {
  const std::size_t face = triangle < mesh.faceOfTriangle.size() ? mesh.faceOfTriangle[triangle] : triangle;
  std::string place = "face " + std::to_string(face + 1);
  if (face < mesh.lineOfFace.size()) place += " (line " + std::to_string(mesh.lineOfFace[face]) + ")";
  return place;
}

Digest geometryDigest(const TriangleMesh& mesh) {
  struct Part {
    std::uint64_t high, low, count;
  };
  const Digest p = digestOf(std::as_bytes(std::span(mesh.positions)));
  const Digest t = digestOf(std::as_bytes(std::span(mesh.triangles)));
  const Part parts[] = {{p.high, p.low, mesh.positions.size()}, {t.high, t.low, mesh.triangles.size()}};
  return digestOf(std::as_bytes(std::span(parts)));
}

} // namespace chamfer
