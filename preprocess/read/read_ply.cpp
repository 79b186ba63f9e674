// PLY (Turk's): ASCII, binary little-endian and big-endian. Elements in any order; polygons of any size,
// triangle strips; texture coordinates of vertices or of corners ("texcoord"). Properties and elements of
// other names are read over by their declared type, with a warning; normals without one. A reader of our own:
// CGAL's lets vertex indices out of range pass and names no place, OpenMesh's returns true for files that end
// early or hold words for numbers.
#include "common/rounding.h"
#include "preprocess/read/read_formats.h"
#include "preprocess/read/read_ply_body.h"

#include <algorithm>
#include <cmath>

namespace chamfer {
namespace {

using ply::Body, ply::Element, ply::Header, ply::Property;

class PlyReader {
public:
  PlyReader(std::string_view bytes, std::string_view name)
      : header_(ply::readHeader(bytes, name)), body_(bytes, header_, name), name_(name) {}

  TriangleMesh run() {
    const auto& all = header_.elements;
    const auto vertices =
        std::find_if(all.begin(), all.end(), [](const Element& e) { return e.name == "vertex"; });
    if (vertices == all.end()) malformed({name_}, "the header declares no element named vertex");
    if (vertices->count > kNone)
      malformed({name_, vertices->line}, "more vertices than 32-bit indices can name");
    vertices_ = std::uint32_t(vertices->count);
    vertexUv_ =
        vertices->find(kU) < vertices->properties.size() && vertices->find(kV) < vertices->properties.size();
    for (const Element& element : all) {
      checkCount(element);
      if (&element == &*vertices)
        readVertices(element);
      else if (element.name == "face")
        readFaces(element);
      else if (element.name == "tristrips")
        readStrips(element);
      else
        skip(element);
    }
    if (const std::size_t behind = body_.finish(); behind > 0)
      warnings_.add("behind", {}, std::to_string(behind) + " bytes behind the last element are not read");
    if (header_.textureLine > 0)
      warnings_.add("texture", {{}, header_.textureLine},
                    "the texture that the comment names is not used: name it in a scene file");
    settleTextureCoordinates(mesh_);
    mesh_.warnings = warnings_.texts();
    return std::move(mesh_);
  }

private:
  static constexpr std::initializer_list<const char*> kU{"u", "s", "texture_u", "texcoord_u", "tx", "tu"},
      kV{"v", "t", "texture_v", "texcoord_v", "ty", "tv"}, kIndices{"vertex_indices", "vertex_index"},
      kWedges{"texcoord", "texcoords"}, kNormals{"nx", "ny", "nz", "normal_x", "normal_y", "normal_z"};

  /// Every property takes a byte at least, so larger counts are wrong whatever follows.
  void checkCount(const Element& element) const {
    const std::size_t least = std::max<std::size_t>(1, element.properties.size());
    if (element.count > (body_.left() + 1) / least)
      malformed({name_, element.line}, std::to_string(element.count) + " elements " + inQuotes(element.name) +
                                           " are declared, but only " + std::to_string(body_.left()) +
                                           " bytes follow");
  }

  /// Names the properties that are read over.
  void warnUnused(const Element& e, std::initializer_list<std::size_t> used) {
    constexpr std::size_t kMost = 20;
    std::string list;
    std::size_t count = 0;
    for (std::size_t p = 0; p < e.properties.size(); ++p) {
      const auto is = [&](const char* name) { return e.properties[p].name == name; };
      if (std::find(used.begin(), used.end(), p) != used.end()) continue;
      if (std::any_of(kNormals.begin(), kNormals.end(), is)) continue;
      if (count++ < kMost) list += (list.empty() ? "" : ", ") + inQuotes(e.properties[p].name);
    }
    if (count > kMost) list += " and " + std::to_string(count - kMost) + " more";
    if (count > 0 && e.count > 0)
      warnings_.add("unused " + e.name, {{}, e.line},
                    "properties of " + inQuotes(e.name) + " that are not used: " + list);
  }

  void readVertices(const Element& e) {
    const std::size_t none = e.properties.size();
    const std::size_t at[5] = {e.find({"x"}), e.find({"y"}), e.find({"z"}), vertexUv_ ? e.find(kU) : none,
                               vertexUv_ ? e.find(kV) : none};
    for (int i = 0; i < 3; ++i)
      if (at[i] == none || e.properties[at[i]].countKind)
        malformed({name_, e.line}, "the vertices have no properties x, y and z that are numbers");
    warnUnused(e, {at[0], at[1], at[2], at[3], at[4]});
    mesh_.positions.reserve(e.count);
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      double values[5] = {};
      for (std::size_t p = 0; p < none; ++p) {
        const auto slot = std::size_t(std::find(at, at + 5, p) - at);
        if (e.properties[p].countKind || slot >= 5)
          skip(e.properties[p]);
        else
          values[slot] = body_.value(e.properties[p].kind, e.properties[p].name.c_str(), slot < 3);
      }
      body_.end();
      mesh_.positions.emplace_back(values[0], values[1], values[2]);
      if (vertexUv_) addCoordinate(values[3], values[4]);
    }
  }

  void addCoordinate(double u, double v) {
    std::array<float, 2> uv{float(u), float(v)};
    if (!std::isfinite(uv[0]) || !std::isfinite(uv[1])) {
      warnings_.add("bad uv", warned(), "a texture coordinate is not finite; what names it has none");
      uv[0] = NAN;
    }
    mesh_.uvs.push_back(uv);
  }

  TextPlace warned() const { return {{}, body_.ascii() ? body_.place().line : 0}; }

  void readFaces(const Element& e) {
    const std::size_t list = e.find(kIndices), wedges = e.find(kWedges), none = e.properties.size();
    if (e.count > 0 && (list == none || !e.properties[list].countKind))
      malformed({name_, e.line}, "the faces have no list vertex_indices");
    const bool wedgeUv = wedges != none && e.properties[wedges].countKind;
    warnUnused(e, {list, wedgeUv ? wedges : none});
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      if (body_.ascii()) mesh_.lineOfFace.push_back(std::uint32_t(body_.place().line));
      wedges_.clear();
      for (std::size_t p = 0; p < none; ++p)
        if (p == list)
          readCorners(e.properties[p]);
        else if (p == wedges && wedgeUv)
          readWedges(e.properties[p]);
        else
          skip(e.properties[p]);
      body_.end();
      addFace();
    }
  }

  void readCorners(const Property& property) {
    const std::uint32_t count = length(property, "the number of corners");
    if (count < 3) body_.fail("a face has at least 3 corners, here are " + std::to_string(count));
    corners_.clear();
    for (std::uint32_t k = 0; k < count; ++k)
      corners_.push_back(index(property));
    warnRepeats(corners_, warned(), warnings_);
  }

  void readWedges(const Property& property) {
    const std::uint32_t count = length(property, "the length of a list");
    for (std::uint32_t k = 0; k < count; ++k)
      wedges_.push_back(body_.value(property.kind, property.name.c_str(), false));
  }

  std::uint32_t length(const Property& property, const char* what) {
    const std::uint32_t count = body_.whole(*property.countKind, what, kNone);
    if (count > body_.left())
      body_.fail(std::to_string(count) + " values do not fit in what is left of the file");
    return count;
  }

  std::uint32_t index(const Property& property) {
    if (vertices_ == 0) body_.fail("a face without vertices");
    return body_.whole(property.kind, "vertex index", vertices_ - 1);
  }

  /// The polygon of corners_, with the coordinates of its corners or of its vertices.
  void addFace() {
    uvs_.clear();
    if (wedges_.size() == 2 * corners_.size()) {
      for (std::size_t k = 0; k < corners_.size(); ++k) {
        uvs_.push_back(std::uint32_t(mesh_.uvs.size()));
        addCoordinate(wedges_[2 * k], wedges_[2 * k + 1]);
      }
    } else if (vertexUv_) {
      uvs_ = corners_;
    }
    if (!uvs_.empty() && mesh_.uvTriangles.empty())
      mesh_.uvTriangles.assign(mesh_.triangles.size(), {kNone, kNone, kNone});
    if (uvs_.empty() && !mesh_.uvTriangles.empty()) uvs_.assign(corners_.size(), kNone);
    appendPolygon(mesh_, faces_++, corners_, uvs_);
  }

  /// Lists of strips: every corner from the third on makes a triangle with the two before it, every second
  /// one turned; -1 begins a new strip.
  void readStrips(const Element& e) {
    const std::size_t list = e.find(kIndices), none = e.properties.size();
    if (e.count > 0 && (list == none || !e.properties[list].countKind))
      malformed({name_, e.line}, "the triangle strips have no list vertex_indices");
    warnUnused(e, {list});
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      for (std::size_t p = 0; p < none; ++p)
        if (p == list)
          readStrip(e.properties[p]);
        else
          skip(e.properties[p]);
      body_.end();
    }
  }

  void readStrip(const Property& property) {
    const std::uint32_t count = length(property, "the length of a strip");
    std::vector<std::uint32_t> strip;
    for (std::uint32_t k = 0; k < count; ++k) {
      const double v = body_.value(property.kind, "vertex index", true);
      if (v == -1) {
        strip.clear();
        continue;
      }
      if (v != std::floor(v) || v < 0 || v >= vertices_)
        body_.fail("vertex index " + numberText(v) + " is neither -1 nor one of " +
                   std::to_string(vertices_) + " vertices");
      strip.push_back(std::uint32_t(v));
      const std::size_t n = strip.size();
      if (n < 3) continue;
      const std::size_t turned = n % 2 == 0;
      corners_ = {strip[n - 3 + turned], strip[n - 2 - turned], strip[n - 1]};
      wedges_.clear();
      if (body_.ascii()) mesh_.lineOfFace.push_back(std::uint32_t(body_.place().line));
      addFace();
    }
  }

  void skip(const Property& property) {
    const std::uint32_t count = property.countKind ? length(property, "the length of a list") : 1;
    for (std::uint32_t k = 0; k < count; ++k)
      body_.value(property.kind, property.name.c_str(), false);
  }

  void skip(const Element& e) {
    if (e.count > 0)
      warnings_.add("element " + e.name, {{}, e.line},
                    std::to_string(e.count) + " elements " + inQuotes(e.name) + " are not used");
    for (std::size_t i = 0; i < e.count; ++i) {
      body_.begin(e, i);
      for (const Property& property : e.properties)
        skip(property);
      body_.end();
    }
  }

  Header header_;
  Body body_;
  std::string_view name_;
  ReadWarnings warnings_;
  std::uint32_t vertices_ = 0, faces_ = 0;
  bool vertexUv_ = false;
  std::vector<std::uint32_t> corners_, uvs_;
  std::vector<double> wedges_;
  TriangleMesh mesh_;
};

} // namespace

TriangleMesh readPly(std::string_view bytes, std::string_view name) {
  TriangleMesh mesh = PlyReader(withoutByteOrderMark(bytes, name), name).run();
  checkSize(mesh, {name});
  return mesh;
}

} // namespace chamfer
