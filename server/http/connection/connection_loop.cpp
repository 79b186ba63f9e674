#include "server/http/connection/connection_loop.h"

#include "server/http/connection/connection.h"
#include "server/http/connection/worker_pool.h"
#include "server/http/schema/schema.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <mutex>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <unordered_map>
#include <vector>

namespace chamfer::http {
namespace {

constexpr std::chrono::milliseconds kSweep{100};    ///< how often deadlines are looked at
constexpr std::chrono::milliseconds kLinger{1'000}; ///< for the client to take the answer before the end
constexpr int kReadsPerEvent = 16;                  ///< of kReadBytes each; then others have their turn
constexpr std::size_t kReadBytes = 64u << 10;
constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

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

class ConnectionLoop::Loop {
public:
  Loop(const ConnectionLimits& limits, Dispatch dispatch)
      : limits_(limits), dispatch_(std::move(dispatch)), epoll_(::epoll_create1(EPOLL_CLOEXEC)),
        wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        pool_(std::make_unique<WorkerPool>(limits.workers, limits.pending)) {
    if (epoll_ < 0 || wake_ < 0) throw Error(ErrorKind::Internal, "no descriptors left for the event loop");
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.u64 = 0; // serials begin at 1
    ::epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_, &event);
    thread_ = std::thread([this] { run(); });
  }

  ~Loop() {
    stop();
    ::close(wake_);
    ::close(epoll_);
  }

  void stop() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    wake();
    thread_.join();
    for (auto& [serial, connection] : connections_)
      if (connection->clientGone) *connection->clientGone = true; // ends what is still rendered for it
    pool_.reset();
    connections_.clear();
    for (const int socket : adopted_)
      ::close(socket);
    adopted_.clear();
    open_ = busy_ = 0;
  }

  void adopt(int socket) {
    ++busy_;
    {
      const std::lock_guard lock(mutex_);
      adopted_.push_back(socket);
    }
    wake();
  }

  ConnectionCounts counts() const { return {open_, busy_, accepted_, dropped_}; }

private:
  struct Completion {
    std::uint64_t serial;
    RawAnswer answer;
  };

  void wake() {
    const std::uint64_t one = 1;
    // The only way to fail is a counter that is already far from zero: the loop is awake then.
    [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
  }

  void run() {
    std::array<epoll_event, 64> events;
    Clock::time_point nextSweep = Clock::now() + kSweep;
    while (!stopping_) {
      const int count = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()),
                                     static_cast<int>(kSweep.count()));
      for (int i = 0; i < count; ++i) {
        const epoll_event& event = events[static_cast<std::size_t>(i)];
        if (event.data.u64 == 0) {
          std::uint64_t drained = 0;
          [[maybe_unused]] const ssize_t read = ::read(wake_, &drained, sizeof drained);
        } else if (const auto found = connections_.find(event.data.u64); found != connections_.end()) {
          onEvent(*found->second, event.events);
        }
      }
      takeMessages();
      if (Clock::now() >= nextSweep) {
        sweep();
        nextSweep = Clock::now() + kSweep;
      }
    }
  }

  void takeMessages() {
    std::vector<int> sockets;
    std::vector<Completion> completions;
    {
      const std::lock_guard lock(mutex_);
      sockets.swap(adopted_);
      completions.swap(completions_);
    }
    for (const int socket : sockets) {
      open(socket);
      --busy_;
    }
    for (Completion& completion : completions)
      if (const auto found = connections_.find(completion.serial); found != connections_.end())
        beginWriting(*found->second, std::move(completion.answer));
  }

  // Opening and closing.

  void open(int socket) {
    auto connection = std::make_unique<Connection>();
    connection->socket = socket;
    ++accepted_;
    if (connections_.size() >= 2 * limits_.connections) { // not even room to refuse it
      ++dropped_;
      return;
    }
    configureSocket(socket);
    connection->serial = ++lastSerial_;
    connection->peer = addressOf(socket);
    connection->deadline = Clock::now() + limits_.idle;
    epoll_event event{};
    event.events = EPOLLONESHOT;
    event.data.u64 = connection->serial;
    if (::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event) != 0) return;
    const bool full = connections_.size() >= limits_.connections && !closeLongestIdle();
    Connection& c = *connections_.emplace(connection->serial, std::move(connection)).first->second;
    open_ = connections_.size();
    if (full)
      refuse(c, overloaded(Scarcity::Connections, "every connection of the server is in use"));
    else
      readMore(c);
  }

  void close(Connection& c) {
    enter(c, State::Lingering); // leaves the count of busy ones
    bodyBytes_ -= c.reserved;
    answerBytes_ -= c.out.size();
    connections_.erase(c.serial);
    open_ = connections_.size();
  }

  /// Closes what the client would have kept open.
  void drop(Connection& c) {
    ++dropped_;
    close(c);
  }

  /// Clients that leave their answers unread must not fill the memory. False: `but` is the only one.
  bool closeOldestWriting(const Connection& but) {
    Connection* oldest = nullptr;
    for (const auto& [serial, c] : connections_)
      if (c->state == State::Writing && c.get() != &but && (!oldest || c->deadline < oldest->deadline))
        oldest = c.get();
    if (oldest) drop(*oldest);
    return oldest != nullptr;
  }

  bool closeLongestIdle() {
    Connection* longest = nullptr;
    for (const auto& [serial, c] : connections_)
      if (c->state == State::ReadingHead && c->in.empty() && (!longest || c->deadline < longest->deadline))
        longest = c.get();
    if (longest) drop(*longest);
    return longest != nullptr;
  }

  void enter(Connection& c, State state) {
    const auto isBusy = [](State s) { return s != State::ReadingHead && s != State::Lingering; };
    if (isBusy(state) && !isBusy(c.state)) ++busy_;
    if (!isBusy(state) && isBusy(c.state)) --busy_;
    c.state = state;
  }

  void arm(Connection& c, std::uint32_t events) {
    epoll_event event{};
    event.events = events | EPOLLONESHOT;
    event.data.u64 = c.serial;
    ::epoll_ctl(epoll_, EPOLL_CTL_MOD, c.socket, &event);
  }

  Clock::time_point transferDeadline(std::size_t bytes) const {
    return Clock::now() + limits_.transfer + std::chrono::milliseconds(bytes * 1000 / limits_.bytesPerSecond);
  }

  void sweep() {
    const Clock::time_point now = Clock::now();
    std::vector<Connection*> late;
    for (const auto& [serial, c] : connections_)
      if (c->state != State::Handling && now >= c->deadline) late.push_back(c.get());
    for (Connection* c : late) {
      const bool reading =
          c->state == State::ReadingBody || (c->state == State::ReadingHead && !c->in.empty());
      if (reading)
        refuse(*c, closing(408, "timeout", "the request did not arrive in time"));
      else if (c->state == State::Writing)
        drop(*c);
      else
        close(*c);
    }
  }

  // Events. Each of these may close the connection and is the last thing done with it.

  void onEvent(Connection& c, std::uint32_t events) {
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

  void readMore(Connection& c) {
    std::array<char, kReadBytes> buffer;
    for (int i = 0; i < kReadsPerEvent; ++i) {
      const ssize_t n = ::recv(c.socket, buffer.data(), buffer.size(), 0);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (n <= 0) return close(c);
      if (c.state == State::ReadingHead && c.in.empty()) c.deadline = Clock::now() + limits_.head;
      c.in.append(buffer.data(), static_cast<std::size_t>(n));
      if (c.state == State::ReadingHead || c.in.size() >= c.head.contentLength) return advance(c);
    }
    arm(c, EPOLLIN | EPOLLRDHUP);
  }

  /// Uses what has been read.
  void advance(Connection& c) {
    if (c.state == State::ReadingHead) {
      if (c.in.starts_with("\r\n")) c.in.erase(0, 2); // RFC 9112, 2.2
      if (c.in.empty()) return arm(c, EPOLLIN | EPOLLRDHUP);
      if (c.in[0] < 'A' || c.in[0] > 'Z')
        return refuse(c, closing(400, errorWord(ErrorKind::Usage), "this is not an HTTP/1.1 request"));
      const std::size_t from = c.scanned > 3 ? c.scanned - 3 : 0;
      const auto end = findHeadEnd(std::string_view(c.in).substr(from));
      if ((end ? from + *end : c.in.size()) > kMaxHeadBytes)
        return refuse(
            c, closing(431, errorWord(ErrorKind::PayloadTooLarge),
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
      if (!beginBody(c)) return;
    }
    if (c.in.size() >= c.head.contentLength) return handle(c);
    arm(c, EPOLLIN | EPOLLRDHUP);
  }

  /// False when the body is refused.
  bool beginBody(Connection& c) {
    const std::size_t length = c.head.contentLength;
    if (length > kMaxBodyBytes) {
      refuse(c, closing(413, errorWord(ErrorKind::PayloadTooLarge),
                        "the body has " + std::to_string(length) + " bytes, at most " +
                            std::to_string(kMaxBodyBytes) + " are read"));
      return false;
    }
    if (bodyBytes_ + length > limits_.bodyBytes) {
      refuse(c, overloaded(Scarcity::Bodies, "the server holds as many request bodies as it can"));
      return false;
    }
    bodyBytes_ += c.reserved = length;
    enter(c, State::ReadingBody);
    c.deadline = transferDeadline(length);
    // Small enough for the socket's buffer; a client that cannot even take this is not worth waiting for.
    if (c.head.expectContinue && c.in.size() < length &&
        ::send(c.socket, kContinue.data(), kContinue.size(), MSG_NOSIGNAL) !=
            static_cast<ssize_t>(kContinue.size())) {
      close(c);
      return false;
    }
    return true;
  }

  void handle(Connection& c) {
    auto request = std::make_shared<RawRequest>();
    const std::size_t length = c.head.contentLength;
    request->head = std::move(c.head);
    c.head = {};
    if (c.in.size() == length) {
      request->body = std::move(c.in);
      c.in.clear();
    } else {
      request->body = c.in.substr(0, length);
      c.in.erase(0, length);
    }
    request->peer = c.peer;
    request->clientGone = c.clientGone = std::make_shared<std::atomic<bool>>(false);
    enter(c, State::Handling);
    const std::uint64_t serial = c.serial;
    const bool taken = pool_->submit([this, serial, request] {
      Completion completion{serial, dispatch_(*request)};
      {
        const std::lock_guard lock(mutex_);
        completions_.push_back(std::move(completion));
      }
      wake();
    });
    if (!taken) return refuse(c, overloaded(Scarcity::Workers, "too many requests are waiting"));
    arm(c, EPOLLRDHUP);
  }

  void refuse(Connection& c, const Problem& problem) {
    RawRequest request;
    request.head = c.head;
    request.peer = c.peer;
    request.clientGone = std::make_shared<std::atomic<bool>>(false);
    request.refusal = problem;
    RawAnswer answer = dispatch_(request);
    answer.close = true;
    beginWriting(c, std::move(answer));
  }

  void beginWriting(Connection& c, RawAnswer answer) {
    bodyBytes_ -= c.reserved;
    c.reserved = 0;
    c.out = std::move(answer.bytes);
    answerBytes_ += c.out.size();
    c.sent = 0;
    c.closeAfter = answer.close;
    c.deadline = transferDeadline(c.out.size());
    enter(c, State::Writing);
    while (answerBytes_ > limits_.answerBytes && closeOldestWriting(c)) {
    }
    writeMore(c);
  }

  void writeMore(Connection& c) {
    while (c.sent < c.out.size()) {
      const ssize_t n = ::send(c.socket, c.out.data() + c.sent, c.out.size() - c.sent, MSG_NOSIGNAL);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return arm(c, EPOLLOUT);
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

  void discardMore(Connection& c) {
    std::array<char, kReadBytes> buffer;
    for (int i = 0; i < kReadsPerEvent; ++i) {
      const ssize_t n = ::recv(c.socket, buffer.data(), buffer.size(), 0);
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (n <= 0) return close(c);
    }
    arm(c, EPOLLIN | EPOLLRDHUP);
  }

  const ConnectionLimits limits_;
  const Dispatch dispatch_;
  const int epoll_, wake_;
  std::atomic<bool> stopping_ = false;
  std::atomic<std::size_t> busy_ = 0, open_ = 0;
  std::atomic<std::uint64_t> accepted_ = 0, dropped_ = 0;
  std::mutex mutex_; ///< guards adopted_ and completions_
  std::vector<int> adopted_;
  std::vector<Completion> completions_;
  std::unordered_map<std::uint64_t, std::unique_ptr<Connection>> connections_; ///< the loop's thread only
  std::uint64_t lastSerial_ = 0;
  std::size_t bodyBytes_ = 0, answerBytes_ = 0;
  std::unique_ptr<WorkerPool> pool_;
  std::thread thread_;
};

ConnectionLoop::ConnectionLoop(const ConnectionLimits& limits, Dispatch dispatch)
    : loop_(std::make_unique<Loop>(limits, std::move(dispatch))) {}
ConnectionLoop::~ConnectionLoop() = default;
void ConnectionLoop::stop() { loop_->stop(); }
void ConnectionLoop::adopt(int socket) { loop_->adopt(socket); }
ConnectionCounts ConnectionLoop::counts() const { return loop_->counts(); }

} // namespace chamfer::http
