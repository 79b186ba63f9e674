// Media types of pictures.
#pragma once

#include "server/render/request/tile_request.h"

namespace chamfer::http {

const char* contentTypeOf(ImageFormat format);

} // namespace chamfer::http
