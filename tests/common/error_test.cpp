// What each kind of error means outside: statuses are what scripts and clients are written against.
#include "common/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <set>

namespace chamfer {
namespace {

TEST(ErrorKinds, HaveTheStatusesThatAreDocumented) {
  const struct {
    ErrorKind kind;
    int exit, http;
    const char* word;
  } table[] = {
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
  std::set<std::string> words;
  for (const auto& [kind, exit, http, word] : table) {
    EXPECT_EQ(exitStatus(kind), exit) << word;
    EXPECT_EQ(httpStatus(kind), http) << word;
    EXPECT_STREQ(errorWord(kind), word);
    EXPECT_TRUE(words.insert(word).second) << word;
  }
  EXPECT_EQ(words.size(), std::size_t(ErrorKind::Cancelled) + 1) << "a kind is missing here";
}

TEST(ErrorKinds, CarryNumbersForPrograms) {
  const Error e = Error(ErrorKind::RadiusTooLarge, "too large").with("solid", 2).with("max_radius", 0.25);
  EXPECT_STREQ(e.what(), "too large");
  EXPECT_THAT(e.details(),
              testing::ElementsAre(testing::Pair("solid", 2), testing::Pair("max_radius", 0.25)));
}

} // namespace
} // namespace chamfer
