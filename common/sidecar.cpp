// The file, all little-endian:
//
//   offset  size  what
//        0     8  "CHAMFER" and a zero byte
//        8     4  version of this layout (kVersion)
//       12     4  number of sections (kSections)
//       16    16  digest of the mesh geometry (high, low)
//       32    48  the options that it was made with (OptionsRecord)
//       80  16*k  section table: for each section its element count (u64) and the XXH3-64 of its bytes (u64)
//        +     8  XXH3-64 of everything before it
//        +     -  the sections in table order, each padded with zeros to a multiple of 8 bytes
//
// The sections are the spans of RoundingView in order, element for element as they are used in memory, so a
// mapped file needs no parsing. Element sizes are fixed by the version, offsets follow from the counts: a
// reader has nothing to believe but the counts, and the file's size checks those.
#include "common/sidecar.h"

#include "common/atomic_file.h"
#include "common/error.h"

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <iterator>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <tuple>
#include <unistd.h>

namespace chamfer {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the sidecar is mapped as it is: little-endian only");

constexpr char kMagic[8] = "CHAMFER";
constexpr std::uint32_t kVersion = 2; // 1 had no options
constexpr std::uint32_t kSections = 8;
constexpr std::size_t kPrefix = 80, kTable = kPrefix + 16 * kSections, kHeader = kTable + 8;

struct Prefix {
  char magic[8];
  std::uint32_t version, sections;
  std::uint64_t digestHigh, digestLow;
  struct OptionsRecord {
    double radius, weld, planarity, convexity, clamp;
    std::uint8_t relative, onNonConvex, unused[6];
  } options;
};
static_assert(sizeof(Prefix) == kPrefix && offsetof(Prefix, options) == 32);

/// Calls `f` with a reference to each span of the view, in the order of the file.
template <class View, class F>
void eachSection(View& view, F&& f) {
  f(view.solids);
  f(view.facets);
  f(view.spheres);
  f(view.packed);
  f(view.wide);
  f(view.treeRoots);
  f(view.treeNodes);
  f(view.facetOfTriangle);
}

constexpr std::size_t padded(std::size_t bytes) { return (bytes + 7) / 8 * 8; }

[[noreturn]] void damaged(const std::string& what) {
  throw Error(ErrorKind::DamagedSidecar,
              "the sidecar is damaged: " + what + "; run chamferprep on the mesh again");
}

Prefix::OptionsRecord packOptions(const RoundingOptions& o) {
  return {o.radius, o.weld, o.planarity, o.convexity, o.clamp, o.relative, std::uint8_t(o.onNonConvex), {}};
}

/// Refuses what chamferprep would not have taken.
RoundingOptions unpackOptions(const Prefix::OptionsRecord& r) {
  const auto within = [](double v, double most) { return v >= 0 && v <= most; };
  const std::uint8_t zeros[6] = {};
  if (!(std::isfinite(r.radius) && r.radius > 0 && within(r.weld, kMostWeld) &&
        within(r.planarity, kMostPlanarity) && within(r.convexity, kMostConvexity) &&
        within(r.clamp, kMostClamp)) ||
      r.relative > 1 || r.onNonConvex > std::uint8_t(OnNonConvex::Hull) ||
      std::memcmp(r.unused, zeros, sizeof zeros) != 0)
    damaged("its options are out of range");
  return {r.radius, r.relative == 1, OnNonConvex(r.onNonConvex), r.weld, r.planarity, r.convexity, r.clamp};
}

/// Refuses files of version 1, which had no options, by that name: its header's checksum stood before them.
void refuseOlder(std::span<const std::byte> bytes, const std::string& mesh) {
  constexpr std::size_t kOldTable = 32 + 16 * kSections;
  std::uint32_t version = 0;
  std::uint64_t sum = 0;
  if (bytes.size() < kOldTable + sizeof sum) return;
  std::memcpy(&version, bytes.data() + sizeof kMagic, sizeof version);
  std::memcpy(&sum, bytes.data() + kOldTable, sizeof sum);
  if (version == 1 && sum == checksumOf(bytes.first(kOldTable)))
    throw Error(
        ErrorKind::StaleSidecar,
        "the sidecar was written by an older chamferprep (version 1 of its layout, this program reads "
        "version " +
            std::to_string(kVersion) + "); make it anew: chamferprep " + mesh +
            " --radius R, with the radius and options that it was made with");
}

/// Points the view's spans into `bytes`, which must outlive it and be aligned to 8. `mesh` stands in
/// messages.
void mapView(std::span<const std::byte> bytes, const Digest* expected, const std::string& mesh,
             RoundingView& view, Digest& digest, RoundingOptions& options) {
  Prefix prefix{};
  if (bytes.size() < sizeof kMagic || std::memcmp(bytes.data(), kMagic, sizeof kMagic) != 0)
    damaged("it does not begin with the sidecar's mark");
  refuseOlder(bytes, mesh);
  if (bytes.size() < kHeader)
    damaged("it has " + std::to_string(bytes.size()) + " bytes, fewer than its header");
  std::memcpy(&prefix, bytes.data(), sizeof prefix);
  if (prefix.version != kVersion)
    damaged("it has version " + std::to_string(prefix.version) + ", this program reads version " +
            std::to_string(kVersion));
  std::uint64_t headerSum = 0;
  std::memcpy(&headerSum, bytes.data() + kTable, sizeof headerSum);
  if (prefix.sections != kSections || headerSum != checksumOf(bytes.first(kTable)))
    damaged("its header does not match its checksum");
  digest = {prefix.digestHigh, prefix.digestLow};
  if (expected && digest != *expected)
    throw Error(ErrorKind::StaleSidecar, "the sidecar belongs to another version of the mesh (digest " +
                                             digest.hex() + ", the mesh has " + expected->hex() +
                                             "); run chamferprep on the mesh again");
  options = unpackOptions(prefix.options);
  std::size_t offset = kHeader, row = kPrefix;
  eachSection(view, [&]<class T>(std::span<const T>& section) {
    std::uint64_t entry[2];
    std::memcpy(entry, bytes.data() + row, sizeof entry);
    row += sizeof entry;
    const std::string name = "section " + std::to_string((row - kPrefix) / 16);
    if (entry[0] > (bytes.size() - offset) / sizeof(T)) damaged(name + " reaches past the end of the file");
    const std::size_t size = std::size_t(entry[0]) * sizeof(T);
    if (padded(size) > bytes.size() - offset) damaged(name + " reaches past the end of the file");
    const auto content = bytes.subspan(offset, padded(size));
    if (checksumOf(content) != entry[1]) damaged(name + " does not match its checksum");
    section = {reinterpret_cast<const T*>(content.data()), std::size_t(entry[0])};
    offset += padded(size);
  });
  if (offset != bytes.size()) damaged("it is longer than its sections");
  validate(view);
}

/// The mesh's name, as commands on it are shown: sidecars are named after it.
std::string meshOf(const std::filesystem::path& sidecar) { return sidecar.stem().string(); }

class OwnedRounding final : public Rounding {
public:
  OwnedRounding(RoundingArrays arrays, const Digest& digest, const RoundingOptions& options)
      : arrays_(std::move(arrays)) {
    meshDigest_ = digest;
    options_ = options;
    view_ = {arrays_.solids, arrays_.facets,    arrays_.spheres,   arrays_.packed,
             arrays_.wide,   arrays_.treeRoots, arrays_.treeNodes, arrays_.facetOfTriangle};
    eachSection(view_, [&](const auto& section) { bytes_ += section.size_bytes(); });
  }

private:
  RoundingArrays arrays_;
};

class ParsedRounding final : public Rounding {
public:
  ParsedRounding(std::span<const std::byte> bytes, const Digest* expected, const std::string& mesh)
      : words_((bytes.size() + 7) / 8) {
    if (!bytes.empty()) std::memcpy(words_.data(), bytes.data(), bytes.size());
    bytes_ = bytes.size();
    mapView(std::as_bytes(std::span(words_)).first(bytes.size()), expected, mesh, view_, meshDigest_,
            options_);
  }

private:
  std::vector<std::uint64_t> words_;
};

class MappedRounding final : public Rounding {
public:
  MappedRounding(const std::filesystem::path& path, const Digest* expected) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) throw Error(ErrorKind::NotFound, "no sidecar " + path.filename().string());
    struct stat status {};
    const bool known = ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0;
    bytes_ = known ? std::size_t(status.st_size) : 0;
    void* const address = known ? ::mmap(nullptr, bytes_, PROT_READ, MAP_PRIVATE, file, 0) : MAP_FAILED;
    ::close(file);
    if (address == MAP_FAILED) damaged("it is empty or not a regular file");
    address_ = address;
    const std::string mesh = meshOf(path);
    try {
      mapView({static_cast<const std::byte*>(address_), bytes_}, expected, mesh, view_, meshDigest_,
              options_);
    } catch (...) {
      ::munmap(address_, bytes_);
      throw;
    }
  }
  ~MappedRounding() override { ::munmap(address_, bytes_); }
  MappedRounding(const MappedRounding&) = delete;
  MappedRounding& operator=(const MappedRounding&) = delete;

private:
  void* address_ = nullptr;
};

std::vector<std::byte> serialize(const Rounding& rounding) {
  const RoundingView& view = rounding.view();
  std::vector<std::byte> bytes(kHeader);
  Prefix prefix{{},
                kVersion,
                kSections,
                rounding.meshDigest().high,
                rounding.meshDigest().low,
                packOptions(rounding.options())};
  std::memcpy(prefix.magic, kMagic, sizeof kMagic);
  std::memcpy(bytes.data(), &prefix, sizeof prefix);
  std::size_t row = kPrefix;
  eachSection(view, [&](const auto& section) {
    const std::size_t offset = bytes.size(), size = section.size_bytes();
    bytes.resize(offset + padded(size));
    if (size > 0) std::memcpy(bytes.data() + offset, section.data(), size);
    const std::uint64_t entry[2] = {section.size(), checksumOf(std::span(bytes).subspan(offset))};
    std::memcpy(bytes.data() + row, entry, sizeof entry);
    row += sizeof entry;
  });
  const std::uint64_t sum = checksumOf(std::span(bytes).first(kTable));
  std::memcpy(bytes.data() + kTable, &sum, sizeof sum);
  return bytes;
}

} // namespace

std::shared_ptr<const Rounding> makeRounding(RoundingArrays arrays, const Digest& meshDigest,
                                             const RoundingOptions& options) {
  return std::make_shared<OwnedRounding>(std::move(arrays), meshDigest, options);
}

std::shared_ptr<const Rounding> readSidecar(const std::filesystem::path& path, const Digest* expected) {
  return std::make_shared<MappedRounding>(path, expected);
}

std::shared_ptr<const Rounding> loadSidecar(const std::filesystem::path& path, const Digest* expected) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw Error(ErrorKind::NotFound, "no sidecar " + path.filename().string());
  const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
  return std::make_shared<ParsedRounding>(std::as_bytes(std::span(bytes)), expected, meshOf(path));
}

std::shared_ptr<const Rounding> parseSidecar(std::span<const std::byte> bytes, const Digest* expected) {
  return std::make_shared<ParsedRounding>(bytes, expected, "MESH");
}

std::size_t serializedSize(const Rounding& rounding) {
  std::size_t size = kHeader;
  eachSection(rounding.view(), [&](const auto& section) { size += padded(section.size_bytes()); });
  return size;
}

std::size_t writeSidecar(const std::filesystem::path& path, const Rounding& rounding) {
  const std::vector<std::byte> bytes = serialize(rounding);
  writeAtomically(path, bytes);
  return bytes.size();
}

} // namespace chamfer
