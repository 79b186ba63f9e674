#include "server/http/routes/content_type.h"

namespace chamfer::http {

const char* contentTypeOf(ImageFormat format) {
  switch (format) {
  case ImageFormat::F16:
    return "application/vnd.chamfer.f16";
  case ImageFormat::Exr:
    return "image/x-exr";
  case ImageFormat::Png:
    return "image/png";
  }
  return "";
}

} // namespace chamfer::http
