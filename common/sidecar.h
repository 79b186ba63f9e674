// The sidecar: the file that carries a mesh's rounding. Layout in sidecar.cpp's head comment.
#pragma once

#include "common/digest.h"
#include "common/rounding.h"

#include <filesystem>
#include <memory>
#include <vector>

namespace chamfer {

/// What is done with a component that is not a closed convex solid.
enum class OnNonConvex : std::uint8_t { Error, Sharp, Hull };

/// How a rounding was asked for (preprocess.h has the meaning of each), so that it can be made again with
/// another radius.
struct RoundingOptions {
  double radius = 0;     ///< mesh units, or with `relative` a share of each solid's diagonal; 0: none
  bool relative = false; ///< as above
  OnNonConvex onNonConvex = OnNonConvex::Error;
  double weld = 1e-7, planarity = 1e-6, convexity = 1e-4, clamp = 0;
  bool operator==(const RoundingOptions&) const = default;
};
/// Largest values that these may have.
inline constexpr double kMostWeld = 0.01, kMostPlanarity = 0.01, kMostConvexity = 0.1, kMostClamp = 0.999;

/// Immutable owner of a rounding: vectors, or a mapped sidecar file. Share it by `std::shared_ptr<const
/// Rounding>`.
class Rounding {
public:
  virtual ~Rounding() = default;
  const RoundingView& view() const { return view_; }
  /// Digest of the mesh geometry that it belongs to (preprocess/mesh.h: geometryDigest).
  const Digest& meshDigest() const { return meshDigest_; }
  const RoundingOptions& options() const { return options_; }
  /// Bytes that it holds in memory or maps.
  std::size_t bytes() const { return bytes_; }

protected:
  RoundingView view_;
  Digest meshDigest_;
  RoundingOptions options_;
  std::size_t bytes_ = 0;
};

/// Rounding held in vectors, as preprocessing makes it.
struct RoundingArrays {
  std::vector<SolidRecord> solids;
  std::vector<FacetRecord> facets;
  std::vector<SphereRecord> spheres;
  std::vector<PackedHalfEdge> packed;
  std::vector<WideHalfEdge> wide;
  std::vector<TreeRoot> treeRoots;
  std::vector<TreeNode> treeNodes;
  std::vector<std::uint32_t> facetOfTriangle;
};
std::shared_ptr<const Rounding> makeRounding(RoundingArrays arrays, const Digest& meshDigest,
                                             const RoundingOptions& options);

/// Writes the whole file or nothing (atomic_file.h). Same rounding, same bytes. Returns the file's size.
/// Throws Error(CannotWrite).
std::size_t writeSidecar(const std::filesystem::path& path, const Rounding& rounding);

/// The size that writeSidecar would write.
std::size_t serializedSize(const Rounding& rounding);

/// Maps and checks a sidecar: sizes, section table, checksums, options, every index, every float. Throws
/// Error(DamagedSidecar), Error(NotFound), or Error(StaleSidecar) when `expected` is given and is not the
/// file's mesh digest, or when the file is of an older layout.
std::shared_ptr<const Rounding> readSidecar(const std::filesystem::path& path,
                                            const Digest* expected = nullptr);
/// The same, read into memory: for whoever must outlive a file that is truncated or overwritten in place.
std::shared_ptr<const Rounding> loadSidecar(const std::filesystem::path& path,
                                            const Digest* expected = nullptr);
/// The same from bytes in memory (fuzzing, tests); they are copied.
std::shared_ptr<const Rounding> parseSidecar(std::span<const std::byte> bytes,
                                             const Digest* expected = nullptr);

/// Throws Error(DamagedSidecar), naming the first fault, unless every invariant of rounding.h holds.
void validate(const RoundingView& view);

} // namespace chamfer
