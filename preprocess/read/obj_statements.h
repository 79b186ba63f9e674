// Every statement of OBJ (Wavefront's Advanced Visualizer, appendix B1, with the superseded ones) and what
// becomes of it here. A newcomer finds the treatment of each word in the one table of obj_statements.cpp.
#pragma once

#include <cstdint>
#include <string_view>

namespace chamfer {

enum class ObjTreatment : std::uint8_t {
  Vertex,            ///< v: read; weights and colours behind it are warned of
  TextureCoordinate, ///< vt: read; what is no finite number is warned of and leaves the corner without
  Face,              ///< f, fo: read strictly
  Library,           ///< mtllib: read
  Material,          ///< usemtl: read
  Silent,    ///< groups, names, normals and smoothing: nothing of the surface or its rounding depends on them
  Display,   ///< how other programs display: warned of unless it switches something off
  NoSurface, ///< points and lines: warned of
  FreeForm,  ///< curves and surfaces: warned of
  OtherFile, ///< names another file, which is not opened, or a command, which is not run: warned of
  Unknown,   ///< no word of OBJ: warned of
};

ObjTreatment treatmentOf(std::string_view word);

/// Why a statement of this treatment is not used, as the end of a sentence that begins with the statement.
const char* whyNotUsed(ObjTreatment treatment);

} // namespace chamfer
