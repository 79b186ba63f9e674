#include "preprocess/read/obj_statements.h"

#include <algorithm>
#include <iterator>

namespace chamfer {
namespace {

using T = ObjTreatment;

constexpr struct {
  const char* word;
  ObjTreatment treatment;
} kStatements[] = {
    {"v", T::Vertex},
    {"vt", T::TextureCoordinate},
    {"f", T::Face},
    {"fo", T::Face}, // superseded by f
    {"mtllib", T::Library},
    {"usemtl", T::Material},
    // Normals: the rounding has its own, exact ones.
    {"vn", T::Silent},
    {"g", T::Silent},
    {"o", T::Silent},
    {"s", T::Silent},
    {"mg", T::Silent}, // merging group of free-form surfaces
    {"bevel", T::Display},
    {"c_interp", T::Display},
    {"d_interp", T::Display},
    {"lod", T::Display},
    {"p", T::NoSurface},
    {"l", T::NoSurface},
    {"vp", T::FreeForm},
    {"cstype", T::FreeForm},
    {"deg", T::FreeForm},
    {"bmat", T::FreeForm},
    {"step", T::FreeForm},
    {"curv", T::FreeForm},
    {"curv2", T::FreeForm},
    {"surf", T::FreeForm},
    {"parm", T::FreeForm},
    {"trim", T::FreeForm},
    {"hole", T::FreeForm},
    {"scrv", T::FreeForm},
    {"sp", T::FreeForm},
    {"end", T::FreeForm},
    {"con", T::FreeForm},
    {"ctech", T::FreeForm},
    {"stech", T::FreeForm},
    // Superseded free-form statements.
    {"bsp", T::FreeForm},
    {"bzp", T::FreeForm},
    {"cdc", T::FreeForm},
    {"cdp", T::FreeForm},
    {"res", T::FreeForm},
    {"call", T::OtherFile},
    {"csh", T::OtherFile},
    {"shadow_obj", T::OtherFile},
    {"trace_obj", T::OtherFile},
    {"maplib", T::OtherFile},
    {"usemap", T::OtherFile},
};

} // namespace

ObjTreatment treatmentOf(std::string_view word) {
  const auto* found = std::find_if(std::begin(kStatements), std::end(kStatements),
                                   [&](const auto& s) { return s.word == word; });
  return found == std::end(kStatements) ? T::Unknown : found->treatment;
}

const char* whyNotUsed(ObjTreatment treatment) {
  switch (treatment) {
  case T::Display:
    return "is not used: it sets how other programs display the mesh";
  case T::NoSurface:
    return "is no part of a surface and not read";
  case T::FreeForm:
    return "belongs to a free-form curve or surface and is not read; export it as polygons";
  case T::OtherFile:
    return "is not followed: no other file is read for it and no command run";
  case T::Unknown:
    return "is no statement of OBJ and not read";
  default:
    return "is read";
  }
}

} // namespace chamfer
