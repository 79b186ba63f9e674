#include "server/http/connection/connection.h"

#include <algorithm>
#include <arpa/inet.h>
#include <linux/sockios.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

namespace chamfer::http {

Connection::~Connection() {
  if (socket >= 0) ::close(socket);
}

std::string addressOf(int socket) {
  sockaddr_storage storage{};
  socklen_t length = sizeof storage;
  char text[INET6_ADDRSTRLEN] = "";
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&storage), &length) != 0) return "unknown";
  if (storage.ss_family == AF_INET)
    ::inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in&>(storage).sin_addr, text, sizeof text);
  else if (storage.ss_family == AF_INET6)
    ::inet_ntop(AF_INET6, &reinterpret_cast<const sockaddr_in6&>(storage).sin6_addr, text, sizeof text);
  return text[0] != '\0' ? text : "unknown";
}

void Connection::progressed(std::size_t bytes, std::chrono::milliseconds patience,
                            std::size_t bytesPerSecond) {
  // More than `patience` is never earned, so that nobody may fall silent for long after a quick start.
  const auto longest = Clock::now() + patience;
  const std::chrono::duration<double> earned(static_cast<double>(bytes) /
                                             static_cast<double>(bytesPerSecond));
  if (earned >= patience)
    deadline = longest;
  else
    deadline = std::min(longest, deadline + std::chrono::duration_cast<Clock::duration>(earned));
}

void configureSocket(int socket) {
  const int on = 1, probeAfterSeconds = 15;
  ::setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  // A host that vanishes without a word is found out even while its request is handled.
  ::setsockopt(socket, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
  ::setsockopt(socket, IPPROTO_TCP, TCP_KEEPIDLE, &probeAfterSeconds, sizeof probeAfterSeconds);
}

std::size_t unconfirmedBytes(int socket) {
  int bytes = 0;
  return ::ioctl(socket, SIOCOUTQ, &bytes) == 0 && bytes > 0 ? static_cast<std::size_t>(bytes) : 0;
}

} // namespace chamfer::http
