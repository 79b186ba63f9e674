#include "server/http/connection/accept.h"

#include <cerrno>
#include <sys/socket.h>

namespace chamfer::http {
namespace {

constexpr int kMostFailed = 1024; ///< in a row; then others have their turn

} // namespace

Accepted acceptNext(int listener) {
  for (int failed = 0; failed < kMostFailed; ++failed) {
    const int socket = ::accept4(listener, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
    if (socket >= 0) return {socket, false};
    switch (errno) {
    case EAGAIN:
#if EWOULDBLOCK != EAGAIN
    case EWOULDBLOCK:
#endif
      return {};
    // Of this one connection, or of a signal; accept(2) asks to treat the network's errors as EAGAIN, for
    // the next to come may be sound.
    case EINTR:
    case ECONNABORTED:
    case EPROTO:
    case EPERM:
    case ENETDOWN:
    case ENOPROTOOPT:
    case EHOSTDOWN:
    case ENONET:
    case EHOSTUNREACH:
    case EOPNOTSUPP:
    case ENETUNREACH:
    case ETIMEDOUT:
      continue;
    // EMFILE, ENFILE, ENOBUFS, ENOMEM, and whatever else there may be: none ends the listener.
    default:
      return {{}, true};
    }
  }
  return {{}, true};
}

} // namespace chamfer::http
