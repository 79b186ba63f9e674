#include "tests/http/http_client.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <stdexcept>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace chamfer::test {
namespace {

std::string lower(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

} // namespace

Connection::Connection(int port, const char* local)
    : socket_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  if (local && ::inet_pton(AF_INET, local, &address.sin_addr) == 1)
    ::bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address);
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  if (socket_ < 0 || ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) {
    ::close(socket_);
    throw std::runtime_error("cannot connect to port " + std::to_string(port));
  }
}

Connection::~Connection() { ::close(socket_); }

bool Connection::send(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (n <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(n));
  }
  return true;
}

bool Connection::fill(std::chrono::milliseconds patience) {
  pollfd waiting{socket_, POLLIN, 0};
  if (::poll(&waiting, 1, static_cast<int>(patience.count())) <= 0) return false;
  char bytes[65536];
  const ssize_t n = ::recv(socket_, bytes, sizeof bytes, 0);
  if (n <= 0) return false;
  buffer_.append(bytes, static_cast<std::size_t>(n));
  if (bytesPerSecond_ > 0)
    std::this_thread::sleep_for(
        std::chrono::microseconds(1'000'000 * n / static_cast<ssize_t>(bytesPerSecond_)));
  return true;
}

std::optional<Reply> Connection::receiveSlowly(std::size_t bytesPerSecond) {
  bytesPerSecond_ = bytesPerSecond;
  auto reply = receive();
  bytesPerSecond_ = 0;
  return reply;
}

bool Connection::readable(std::chrono::milliseconds patience) const {
  pollfd waiting{socket_, POLLIN, 0};
  return ::poll(&waiting, 1, static_cast<int>(patience.count())) > 0;
}

std::optional<Reply> Connection::receive(bool head, std::chrono::milliseconds patience) {
  std::size_t end = 0;
  while ((end = buffer_.find("\r\n\r\n")) == std::string::npos)
    if (!fill(patience)) return std::nullopt;
  Reply reply;
  const std::string lines = buffer_.substr(0, end + 2);
  buffer_.erase(0, end + 4);
  reply.status = std::stoi(lines.substr(9, 3));
  for (std::size_t at = lines.find("\r\n") + 2; at < lines.size();) {
    const std::size_t lineEnd = lines.find("\r\n", at), colon = lines.find(':', at);
    reply.headers[lower(lines.substr(at, colon - at))] = lines.substr(colon + 2, lineEnd - colon - 2);
    at = lineEnd + 2;
  }
  if (head || reply.status == 204 || reply.status == 304 || reply.status == 100) return reply;
  const std::size_t length = std::stoul(reply.header("content-length"));
  while (buffer_.size() < length)
    if (!fill(patience)) return std::nullopt;
  reply.body = buffer_.substr(0, length);
  buffer_.erase(0, length);
  return reply;
}

bool Connection::closedWithin(std::chrono::milliseconds patience) {
  pollfd waiting{socket_, POLLIN, 0};
  char byte = 0;
  return ::poll(&waiting, 1, static_cast<int>(patience.count())) > 0 && ::recv(socket_, &byte, 1, 0) <= 0;
}

void Connection::abort() {
  const linger now{1, 0};
  ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
  ::close(socket_);
  socket_ = -1;
}

void Connection::finishSending() { ::shutdown(socket_, SHUT_WR); }

std::string requestText(const std::string& method, const std::string& target, const std::string& headers,
                        const std::string& body) {
  std::string text = method + ' ' + target + " HTTP/1.1\r\nHost: localhost\r\n" + headers;
  if (!body.empty() || method == "POST") text += "Content-Length: " + std::to_string(body.size()) + "\r\n";
  return text + "\r\n" + body;
}

Reply raw(int port, const std::string& bytes) {
  Connection connection(port);
  connection.send(bytes); // the server may answer and close before it has all of it
  return connection.receive().value_or(Reply{});
}

Reply get(int port, const std::string& target, const std::string& headers) {
  return raw(port, requestText("GET", target, headers));
}

Reply head(int port, const std::string& target, const std::string& headers) {
  Connection connection(port);
  connection.send(requestText("HEAD", target, headers));
  return connection.receive(true).value_or(Reply{});
}

Reply post(int port, const std::string& target, const std::string& body, const std::string& contentType) {
  return raw(port, requestText("POST", target, "Content-Type: " + contentType + "\r\n", body));
}

} // namespace chamfer::test
