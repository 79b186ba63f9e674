// The readers behind readMesh, one a format, and what they share: the builder of the arrays.
#pragma once

#include "preprocess/mesh.h"
#include "preprocess/read/read_text.h"
#include "preprocess/read/read_warnings.h"

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace chamfer {

/// `path` is the file's name: material libraries lie beside it, and in `top` (empty: the same folder).
TriangleMesh readObj(std::string_view text, const std::filesystem::path& path,
                     const std::filesystem::path& top = {});
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

/// Warns where a corner is the one before it, around the polygon: its triangles without area are dropped
/// later.
void warnRepeats(std::span<const std::uint32_t> corners, const TextPlace& place, ReadWarnings& warnings);

/// Takes texture coordinates that are NaN from the corners that have them, and all away where no corner has
/// any left.
void settleTextureCoordinates(TriangleMesh& mesh);

/// Throws Error(Malformed) when the mesh has more vertices or triangles than 32-bit indices can name.
void checkSize(const TriangleMesh& mesh, const TextPlace& place);

} // namespace chamfer
