// Expectations about ProblemErrors.
#pragma once

#include "server/http/routes/problem.h"

#include <gtest/gtest.h>

namespace chamfer::test {

/// Runs `action`, which must throw a ProblemError with this status; returns its problem.
template <class Action>
http::Problem problemFrom(Action&& action, int status) {
  try {
    action();
  } catch (const http::ProblemError& error) {
    EXPECT_EQ(error.problem().status, status) << error.problem().detail;
    EXPECT_FALSE(error.problem().detail.empty());
    return error.problem();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

} // namespace chamfer::test
