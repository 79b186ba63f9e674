#include "common/error.h"

#include <iterator>

namespace chamfer {
namespace {

struct Row {
  ErrorKind kind;
  int exit;
  int http;
  const char* word;
};

constexpr Row kTable[] = {
    {ErrorKind::Internal, 1, 500, "internal"},
    {ErrorKind::Usage, 2, 400, "usage"},
    {ErrorKind::OutOfRange, 2, 422, "out-of-range"},
    {ErrorKind::Malformed, 3, 400, "malformed"},
    {ErrorKind::NotFound, 3, 404, "not-found"},
    {ErrorKind::NotConvexSolid, 4, 422, "not-convex-solid"},
    {ErrorKind::RadiusTooLarge, 5, 422, "radius-too-large"},
    {ErrorKind::CannotWrite, 6, 500, "cannot-write"},
    {ErrorKind::StaleSidecar, 3, 409, "stale-sidecar"},
    {ErrorKind::DamagedSidecar, 3, 409, "damaged-sidecar"},
    {ErrorKind::PayloadTooLarge, 3, 413, "payload-too-large"},
    {ErrorKind::Unsupported, 2, 415, "unsupported"},
    {ErrorKind::Busy, 1, 503, "busy"},
    {ErrorKind::Cancelled, 1, 503, "cancelled"},
};

const Row& row(ErrorKind kind) {
  for (const Row& r : kTable)
    if (r.kind == kind) return r;
  return kTable[0];
}

} // namespace

int exitStatus(ErrorKind kind) { return row(kind).exit; }
int httpStatus(ErrorKind kind) { return row(kind).http; }
const char* errorWord(ErrorKind kind) { return row(kind).word; }

} // namespace chamfer
