// What can go wrong, by kind, and what each kind means to the outside. One table (error.cpp) turns a kind
// into chamferprep's exit status and chamferd's HTTP status; nothing else in the project decides either.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace chamfer {

enum class ErrorKind : std::uint8_t {
  Internal,        ///< a defect of ours
  Usage,           ///< command line or request syntax
  OutOfRange,      ///< well formed, but a value is outside its limits
  Malformed,       ///< input file cannot be read or parsed
  NotFound,        ///< no such file, scene or route
  NotConvexSolid,  ///< open, non-manifold, flat, self-intersecting or concave
  RadiusTooLarge,  ///< rounding radius at or above the inradius
  CannotWrite,     ///< output file
  StaleSidecar,    ///< sidecar does not belong to the mesh as it is now
  DamagedSidecar,  ///< sidecar truncated, changed or of another version
  PayloadTooLarge, ///< request larger than its limit
  Unsupported,     ///< media type or encoding
  Busy,            ///< queue full or shutting down; try again
  Cancelled,       ///< client gone or deadline passed
};

/// Exit status of a program that ends with an error of this kind (0 done, 1 internal, 2 usage, 3 unreadable
/// or malformed, 4 not a convex solid, 5 radius too large, 6 cannot write).
int exitStatus(ErrorKind kind);
/// HTTP status for an error of this kind.
int httpStatus(ErrorKind kind);
/// Short stable word for JSON and metrics, e.g. "not-convex-solid".
const char* errorWord(ErrorKind kind);

/// The project's exception. The message is for the user who caused it: what, where, measured how, and the
/// fix.
class Error : public std::runtime_error {
public:
  Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
  ErrorKind kind() const { return kind_; }

  /// Adds a number for programs, under a snake_case key: what the message says in words.
  Error& with(const std::string& key, double value) {
    details_.emplace_back(key, value);
    return *this;
  }
  const std::vector<std::pair<std::string, double>>& details() const { return details_; }

private:
  ErrorKind kind_;
  std::vector<std::pair<std::string, double>> details_;
};

} // namespace chamfer
