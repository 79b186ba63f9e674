#include "server/http/routes/content_type.h"

#include "server/http/routes/problem.h"
#include "server/http/routes/routes.h"

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

void requireJson(const Request& request) {
  const std::string* type = request.header("content-type");
  std::string_view word = type ? std::string_view(*type) : std::string_view();
  word = word.substr(0, word.find(';'));
  while (word.ends_with(' '))
    word.remove_suffix(1);
  if (word != "application/json")
    throw ProblemError(unsupportedMedia("the body must be JSON and say so: Content-Type: application/json"));
}

} // namespace chamfer::http
