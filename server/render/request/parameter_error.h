// A value that was asked for and cannot be had.
#pragma once

#include "common/error.h"

#include <string>
#include <utility>

namespace chamfer {

/// Its kinds are Usage (syntax, unknown and repeated names) and OutOfRange. Beside the message it has in
/// parts what a program shows at the field that was filled in wrongly.
class ParameterError : public Error {
public:
  ParameterError(ErrorKind kind, const std::string& message, std::string parameter, std::string value = {},
                 std::string limits = {})
      : Error(kind, message), parameter_(std::move(parameter)), value_(std::move(value)),
        limits_(std::move(limits)) {}

  const std::string& parameter() const { return parameter_; } ///< its name, or its place in a document
  const std::string& value() const { return value_; }         ///< as it was given
  const std::string& limits() const { return limits_; }       ///< JSON text of an object; empty: none

private:
  std::string parameter_, value_, limits_;
};

} // namespace chamfer
