#include "server/http/connection/loop.h"

#include "server/http/schema/limits.h"

#include <array>
#include <cerrno>
#include <map>
#include <sys/epoll.h>
#include <sys/socket.h>

namespace chamfer::http {
namespace {

constexpr std::chrono::milliseconds kLinger{1'000}; ///< for the client to take the answer before the end
constexpr int kReadsPerEvent = 16;                  ///< of kReadBytes each; then others have their turn
constexpr std::size_t kReadBytes = 64u << 10;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

bool wouldBlock() { return errno == EAGAIN || errno == EWOULDBLOCK; }

Problem closing(int status, const char* kind, const std::string& detail) {
  Problem problem;
  problem.status = status;
  problem.kind = kind;
  problem.detail = detail;
  problem.close = true;
  return problem;
}

Problem overloaded(Scarcity scarcity, const std::string& detail) {
  Problem problem = busy(detail, 1, scarcity);
  problem.close = true;
  return problem;
}

} // namespace

void ConnectionLoop::Loop::enter(Connection& c, State state) {
  const auto isBusy = [](State s) { return s != State::ReadingHead && s != State::Lingering; };
  if (isBusy(state) && !isBusy(c.state)) ++busy_;
  if (!isBusy(state) && isBusy(c.state)) --busy_;
  c.state = state;
}

void ConnectionLoop::Loop::arm(Connection& c, std::uint32_t events) {
  epoll_event event{};
  event.events = events | EPOLLONESHOT;
  event.data.u64 = c.serial;
  ::epoll_ctl(epoll_, EPOLL_CTL_MOD, c.socket, &event);
}

void ConnectionLoop::Loop::onEvent(Connection& c, std::uint32_t events) {
  switch (c.state) {
  case State::ReadingHead:
  case State::ReadingBody:
    return readMore(c);
  case State::Handling:
    // Closed, or half closed: nobody waits for an image then. The answer is still written if it comes.
    if (events & (EPOLLRDHUP | EPOLLHUP | EPOLLERR)) *c.clientGone = true;
    return;
  case State::Writing:
    return writeMore(c);
  case State::Lingering:
    return discardMore(c);
  }
}

void ConnectionLoop::Loop::onDeadline(Connection& c) {
  if (c.reading() && !c.idle())
    refuse(c, closing(408, "timeout", "the request did not arrive in time"));
  else if (c.state == State::Writing)
    drop(c);
  else
    close(c);
}

void ConnectionLoop::Loop::readMore(Connection& c) {
  std::array<char, kReadBytes> buffer;
  for (int i = 0; i < kReadsPerEvent; ++i) {
    const ssize_t n = ::recv(c.socket, buffer.data(), buffer.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && wouldBlock()) break;
    if (n <= 0) return close(c);
    if (c.idle()) c.deadline = Clock::now() + limits_.head;
    c.in.append(buffer.data(), static_cast<std::size_t>(n));
    if (c.state == State::ReadingHead) return advance(c);
    c.progressed(static_cast<std::size_t>(n), limits_.transfer, limits_.bytesPerSecond);
    if (!holdBody(c)) return;
    if (c.in.size() >= c.head.contentLength) return advance(c);
  }
  arm(c, EPOLLIN | EPOLLRDHUP);
}

/// Uses what has been read.
void ConnectionLoop::Loop::advance(Connection& c) {
  if (c.state == State::ReadingHead) {
    if (c.in.starts_with("\r\n")) c.in.erase(0, 2); // RFC 9112, 2.2
    if (c.in.empty()) return arm(c, EPOLLIN | EPOLLRDHUP);
    if (c.in[0] < 'A' || c.in[0] > 'Z')
      return refuse(c, closing(400, errorWord(ErrorKind::Usage), "this is not an HTTP/1.1 request"));
    const std::size_t from = c.scanned > 3 ? c.scanned - 3 : 0;
    const auto end = findHeadEnd(std::string_view(c.in).substr(from));
    if ((end ? from + *end : c.in.size()) > kMaxHeadBytes)
      return refuse(c,
                    closing(431, errorWord(ErrorKind::PayloadTooLarge),
                            "the request's head is longer than " + std::to_string(kMaxHeadBytes) + " bytes"));
    if (!end) {
      c.scanned = c.in.size();
      return arm(c, EPOLLIN | EPOLLRDHUP);
    }
    auto parsed = parseRequestHead(std::string_view(c.in).substr(0, from + *end));
    c.in.erase(0, from + *end);
    c.scanned = 0;
    if (const Problem* problem = std::get_if<Problem>(&parsed)) return refuse(c, *problem);
    c.head = std::get<RequestHead>(std::move(parsed));
    c.client = c.peer;
    if (!beginBody(c)) return;
  }
  if (c.in.size() >= c.head.contentLength) return handle(c);
  arm(c, EPOLLIN | EPOLLRDHUP);
}

/// False when the body is refused.
bool ConnectionLoop::Loop::beginBody(Connection& c) {
  const std::size_t length = c.head.contentLength;
  if (length == 0) return true;
  if (std::optional<Problem> unwanted = screen_(c.head, c.client)) {
    unwanted->close = true; // what follows on the line is the body
    refuse(c, *unwanted);
    return false;
  }
  if (length > kMaxBodyBytes) {
    refuse(c, closing(413, errorWord(ErrorKind::PayloadTooLarge),
                      "the body has " + std::to_string(length) + " bytes, at most " +
                          std::to_string(kMaxBodyBytes) + " are read"));
    return false;
  }
  enter(c, State::ReadingBody);
  c.deadline = Clock::now() + limits_.transfer;
  if (!holdBody(c)) return false;
  // Small enough for the socket's buffer; a client that cannot even take this is not worth waiting for.
  if (c.head.expectContinue && c.in.size() < length &&
      ::send(c.socket, kContinue.data(), kContinue.size(), MSG_NOSIGNAL) !=
          static_cast<ssize_t>(kContinue.size())) {
    close(c);
    return false;
  }
  return true;
}

/// Counts what has arrived of the body. Where that is more than all bodies may have, those that arrive of the
/// client with the most give way. False when this is one of them.
bool ConnectionLoop::Loop::holdBody(Connection& c) {
  const std::size_t here = std::min(c.in.size(), c.head.contentLength);
  bodyBytes_ += here - c.held;
  c.held = here;
  while (bodyBytes_ > limits_.bodyBytes) {
    Connection* largest = largestHolder(); // never none: `c` is one
    refuse(*largest, overloaded(Scarcity::Bodies, "the server holds as many request bodies as it can"));
    if (largest == &c) return false;
  }
  return true;
}

/// Of the client that holds the most, among those of whom a body is arriving, the largest that is.
Connection* ConnectionLoop::Loop::largestHolder() {
  std::map<std::string_view, std::size_t> holds;
  for (const auto& [serial, c] : connections_)
    holds[c->client] += c->held;
  Connection* largest = nullptr;
  for (const auto& [serial, c] : connections_) {
    if (c->state != State::ReadingBody) continue;
    if (!largest || std::pair(holds[c->client], c->held) > std::pair(holds[largest->client], largest->held))
      largest = c.get();
  }
  return largest;
}

void ConnectionLoop::Loop::handle(Connection& c) {
  auto exchange = std::make_shared<std::list<Exchange>>(1);
  RawRequest& request = exchange->front().request;
  exchange->front().serial = c.serial;
  const std::size_t length = c.head.contentLength;
  request.head = std::move(c.head);
  c.head = {};
  if (c.in.size() == length) {
    request.body = std::move(c.in);
    c.in.clear();
  } else {
    request.body = c.in.substr(0, length);
    c.in.erase(0, length);
  }
  request.peer = c.peer;
  request.clientGone = c.clientGone = std::make_shared<std::atomic<bool>>(false);
  enter(c, State::Handling);
  const bool taken = pool_->submit([this, exchange] {
    exchange->front().answer = dispatch_(exchange->front().request);
    exchange->front().request = {}; // the body, which has done its work
    {
      const std::lock_guard lock(mutex_);
      completions_.splice(completions_.end(), *exchange);
    }
    wake();
  });
  if (!taken) {
    c.head = std::move(request.head); // for the log
    return refuse(c, overloaded(Scarcity::Workers, "too many requests are waiting"));
  }
  arm(c, EPOLLRDHUP);
}

void ConnectionLoop::Loop::refuse(Connection& c, const Problem& problem) {
  RawRequest request;
  request.head = c.head;
  request.peer = c.peer;
  request.clientGone = std::make_shared<std::atomic<bool>>(false);
  request.refusal = problem;
  RawAnswer answer = dispatch_(request);
  answer.close = true;
  beginWriting(c, std::move(answer));
}

void ConnectionLoop::Loop::beginWriting(Connection& c, RawAnswer answer) {
  bodyBytes_ -= c.held;
  c.held = 0;
  c.out = std::move(answer.bytes);
  answerBytes_ += c.out.size();
  c.sent = c.delivered = 0;
  c.closeAfter = answer.close;
  if (c.closeAfter) std::string().swap(c.in); // half a body, perhaps: nothing of it is used any more
  c.deadline = Clock::now() + limits_.transfer;
  enter(c, State::Writing);
  while (answerBytes_ > limits_.answerBytes && closeOldestWriting(c)) {
  }
  writeMore(c);
}

void ConnectionLoop::Loop::writeMore(Connection& c) {
  while (c.sent < c.out.size()) {
    const ssize_t n = ::send(c.socket, c.out.data() + c.sent, c.out.size() - c.sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && wouldBlock()) return arm(c, EPOLLOUT);
    if (n < 0) return close(c);
    c.sent += static_cast<std::size_t>(n);
  }
  answerBytes_ -= c.out.size();
  c.out = {};
  if (c.closeAfter) {
    // Closing with bytes unread would reset the connection and could take the answer with it.
    ::shutdown(c.socket, SHUT_WR);
    enter(c, State::Lingering);
    c.deadline = Clock::now() + kLinger;
    return discardMore(c);
  }
  enter(c, State::ReadingHead);
  c.deadline = Clock::now() + (c.in.empty() ? limits_.idle : limits_.head);
  if (c.in.empty())
    arm(c, EPOLLIN | EPOLLRDHUP);
  else
    advance(c); // the next request came along with this one
}

void ConnectionLoop::Loop::discardMore(Connection& c) {
  std::array<char, kReadBytes> buffer;
  for (int i = 0; i < kReadsPerEvent; ++i) {
    const ssize_t n = ::recv(c.socket, buffer.data(), buffer.size(), 0);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0 && wouldBlock()) break;
    if (n <= 0) return close(c);
  }
  arm(c, EPOLLIN | EPOLLRDHUP);
}

} // namespace chamfer::http
