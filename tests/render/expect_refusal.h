// Expectations about what the readers of requests refuse.
#pragma once

#include "server/render/request/parameter_error.h"

#include <gtest/gtest.h>

namespace chamfer::test {

/// Runs `action`, which must throw an Error that stands for this HTTP status; returns it, with an empty
/// parameter where it names none.
template <class Action>
ParameterError refusalOf(Action&& action, int status) {
  const auto check = [&](const Error& error) {
    EXPECT_EQ(httpStatus(error.kind()), status) << error.what();
    EXPECT_STRNE(error.what(), "");
  };
  try {
    action();
  } catch (const ParameterError& error) {
    check(error);
    return error;
  } catch (const Error& error) {
    check(error);
    return {error.kind(), error.what(), ""};
  }
  ADD_FAILURE() << "nothing was refused";
  return {ErrorKind::Internal, "nothing", ""};
}

} // namespace chamfer::test
