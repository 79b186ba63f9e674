// The readers behind readMesh, one a format, and what they share: the builder of the arrays.
#pragma once

#include "preprocess/mesh.h"
#include "preprocess/read/read_text.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace chamfer {

/// `text` is the file's content (changed while it is read), `path` its name: material libraries lie beside
/// it.
TriangleMesh readObj(std::string text, const std::filesystem::path& path);
/// Binary, or ASCII. The result is a soup: three positions a facet.
TriangleMesh readStl(std::string_view bytes, std::string_view name);
/// ASCII, binary little-endian and big-endian.
TriangleMesh readPly(std::string_view bytes, std::string_view name);
TriangleMesh readOff(std::string_view text, std::string_view name);

/// The whole file. Throws Error(NotFound), Error(Malformed).
std::string readFile(const std::filesystem::path& path);

/// Appends a polygon to `mesh` as a fan from its first corner, in order, and counts it as the next face of
/// the file. `uvs` is empty or as long as `corners`. Indices must be valid, `corners` at least three, not
/// more than limits allow.
void appendPolygon(TriangleMesh& mesh, std::uint32_t face, std::span<const std::uint32_t> corners,
                   std::span<const std::uint32_t> uvs = {});

/// Throws Error(Malformed) when the mesh has more vertices or triangles than 32-bit indices can name.
void checkSize(const TriangleMesh& mesh, const TextPlace& place);

} // namespace chamfer
