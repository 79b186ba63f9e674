// Expectations about errors that become answers.
#pragma once

#include "server/http/routes/problem.h"

#include <gtest/gtest.h>

namespace chamfer::test {

/// Runs `action`, which must throw what is answered with this status; returns the problem.
template <class Action>
http::Problem problemFrom(Action&& action, int status) {
  try {
    action();
  } catch (const http::ProblemError& error) {
    EXPECT_EQ(error.problem().status, status) << error.problem().detail;
    EXPECT_FALSE(error.problem().detail.empty());
    return error.problem();
  } catch (const Error& error) {
    const http::Problem problem = http::problemOf(error, "");
    EXPECT_EQ(problem.status, status) << problem.detail;
    EXPECT_FALSE(problem.detail.empty());
    return problem;
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

} // namespace chamfer::test
