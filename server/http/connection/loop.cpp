#include "server/http/connection/loop.h"

#include "server/http/connection/accept.h"

#include <algorithm>
#include <array>
#include <map>
#include <new>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>
#include <utility>
#include <vector>

namespace chamfer::http {
namespace {

constexpr std::chrono::milliseconds kSweep{100};  ///< how often deadlines are looked at
constexpr int kAcceptsPerEvent = 64;              ///< then others have their turn
constexpr int kLastAccepts = 4096;                ///< more than the kernel lets wait
constexpr std::uint64_t kWake = 0, kListener = 1; ///< in events, beside the connections' serials

} // namespace

ConnectionLoop::Loop::Loop(const ConnectionLimits& limits, Dispatch dispatch, Screen screen)
    : limits_(limits), dispatch_(std::move(dispatch)), screen_(std::move(screen)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)), wake_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
      pool_(std::make_unique<WorkerPool>(limits.workers, limits.pending)) {
  if (epoll_ < 0 || wake_ < 0) throw Error(ErrorKind::Internal, "no descriptors left for the event loop");
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = kWake;
  ::epoll_ctl(epoll_, EPOLL_CTL_ADD, wake_, &event);
  thread_ = std::thread([this] { run(); });
}

ConnectionLoop::Loop::~Loop() {
  stop();
  ::close(wake_);
  ::close(epoll_);
}

void ConnectionLoop::Loop::listen(int socket) {
  const std::lock_guard lock(mutex_);
  wantedListener_ = socket;
  wantListening_ = true;
  wake();
}

void ConnectionLoop::Loop::stopListening() {
  std::unique_lock lock(mutex_);
  wantListening_ = false;
  wake();
  listenerClosed_.wait(lock, [this] { return wantedListener_ < 0; });
}

void ConnectionLoop::Loop::stop() {
  if (!thread_.joinable()) return;
  stopListening();
  stopping_ = true;
  wake();
  thread_.join();
  for (auto& [serial, connection] : connections_)
    if (connection->clientGone) *connection->clientGone = true; // ends what is still rendered for it
  pool_.reset();
  connections_.clear();
  open_ = busy_ = 0;
}

void ConnectionLoop::Loop::wake() {
  const std::uint64_t one = 1;
  // The only way to fail is a counter that is already far from zero: the loop is awake then.
  [[maybe_unused]] const ssize_t written = ::write(wake_, &one, sizeof one);
}

void ConnectionLoop::Loop::run() {
  std::array<epoll_event, 64> events;
  Clock::time_point nextSweep = Clock::now() + kSweep;
  while (!stopping_) {
    const int count = ::epoll_wait(epoll_, events.data(), static_cast<int>(events.size()),
                                   static_cast<int>(kSweep.count()));
    for (int i = 0; i < count; ++i) // none after an error, which can only be a signal
      onEvent(events[static_cast<std::size_t>(i)].data.u64, events[static_cast<std::size_t>(i)].events);
    takeMessages();
    if (Clock::now() >= nextSweep) {
      sweep();
      nextSweep = Clock::now() + kSweep;
    }
  }
}

template <class Action>
void ConnectionLoop::Loop::guarded(std::uint64_t serial, Action&& action) {
  try {
    action();
  } catch (const std::bad_alloc&) {
    if (Connection* c = find(serial)) drop(*c);
  }
}

void ConnectionLoop::Loop::onEvent(std::uint64_t serial, std::uint32_t events) {
  if (serial == kWake) {
    std::uint64_t drained = 0;
    [[maybe_unused]] const ssize_t read = ::read(wake_, &drained, sizeof drained);
  } else if (serial == kListener) {
    acceptAll(kAcceptsPerEvent);
  } else if (Connection* c = find(serial)) {
    guarded(serial, [&] { onEvent(*c, events); });
  }
}

void ConnectionLoop::Loop::takeMessages() {
  takeListener();
  std::list<Exchange> completions;
  {
    const std::lock_guard lock(mutex_);
    completions.swap(completions_);
  }
  for (Exchange& done : completions)
    if (Connection* c = find(done.serial))
      guarded(done.serial, [&] { beginWriting(*c, std::move(done.answer)); });
}

/// What listen() and stopListening() ask for.
void ConnectionLoop::Loop::takeListener() {
  const std::lock_guard lock(mutex_);
  if (wantListening_ && listener_ < 0) {
    listener_ = wantedListener_;
    epoll_event event{};
    event.events = EPOLLIN | EPOLLONESHOT;
    event.data.u64 = kListener;
    ::epoll_ctl(epoll_, EPOLL_CTL_ADD, listener_, &event);
  }
  if (wantListening_ || wantedListener_ < 0) return;
  if (listener_ >= 0) acceptAll(kLastAccepts); // who came before the end is still served
  ::close(wantedListener_);
  listener_ = wantedListener_ = -1;
  listenerClosed_.notify_all();
}

// Who comes.

void ConnectionLoop::Loop::armListener() {
  epoll_event event{};
  event.events = EPOLLIN | EPOLLONESHOT;
  event.data.u64 = kListener;
  ::epoll_ctl(epoll_, EPOLL_CTL_MOD, listener_, &event);
}

void ConnectionLoop::Loop::acceptAll(int most) {
  if (listener_ < 0) return;
  for (int i = 0; i < most; ++i) {
    const Accepted accepted = acceptNext(listener_);
    acceptPaused_ = accepted.shortage;
    if (acceptPaused_) return; // the socket stays readable: asked at once it would answer the same
    if (!accepted.socket) break;
    guarded(lastSerial_ + 1, [&] { open(*accepted.socket); });
  }
  armListener();
}

void ConnectionLoop::Loop::open(int socket) {
  struct Owner {
    int socket;
    ~Owner() {
      if (socket >= 0) ::close(socket);
    }
  } owner{socket};
  ++accepted_;
  if (connections_.size() >= 2 * limits_.connections) { // not even room to refuse it
    ++dropped_;
    return;
  }
  auto connection = std::make_unique<Connection>();
  connection->socket = std::exchange(owner.socket, -1);
  configureSocket(socket);
  connection->serial = ++lastSerial_;
  connection->peer = connection->client = addressOf(socket);
  connection->deadline = Clock::now() + limits_.idle;
  epoll_event event{};
  event.events = EPOLLONESHOT;
  event.data.u64 = connection->serial;
  if (::epoll_ctl(epoll_, EPOLL_CTL_ADD, socket, &event) != 0) {
    ++dropped_;
    return;
  }
  const bool full = connections_.size() >= limits_.connections && !makeRoomFor(connection->peer);
  Connection& c = *connections_.emplace(connection->serial, std::move(connection)).first->second;
  open_ = connections_.size();
  if (full) {
    Problem problem = busy("every connection of the server is in use", 1, Scarcity::Connections);
    problem.close = true;
    return refuse(c, problem);
  }
  readMore(c);
}

// Who has to go.

Connection* ConnectionLoop::Loop::find(std::uint64_t serial) {
  const auto found = connections_.find(serial);
  return found == connections_.end() ? nullptr : found->second.get();
}

void ConnectionLoop::Loop::close(Connection& c) {
  enter(c, State::Lingering); // leaves the count of busy ones
  bodyBytes_ -= c.held;
  answerBytes_ -= c.out.size();
  connections_.erase(c.serial);
  open_ = connections_.size();
}

/// Closes what the client would have kept open.
void ConnectionLoop::Loop::drop(Connection& c) {
  ++dropped_;
  close(c);
}

void ConnectionLoop::Loop::sweep() {
  if (acceptPaused_ && listener_ >= 0) {
    // Who keeps a connection without using it makes room for who waits for one.
    pollfd waiting{listener_, POLLIN, 0};
    if (::poll(&waiting, 1, 0) > 0)
      if (Connection* idle = longestIdle()) drop(*idle);
    acceptAll(kAcceptsPerEvent);
  }
  const Clock::time_point now = Clock::now();
  // By serial: to refuse one may close others, to make room for its answer.
  std::vector<std::uint64_t> late;
  try {
    for (const auto& [serial, c] : connections_) {
      if (c->state == State::Writing) {
        const std::size_t delivered = c->sent - std::min(c->sent, unconfirmedBytes(c->socket));
        if (delivered > c->delivered)
          c->progressed(delivered - c->delivered, limits_.transfer, limits_.bytesPerSecond);
        c->delivered = std::max(c->delivered, delivered);
      }
      if (c->state != State::Handling && now >= c->deadline) late.push_back(serial);
    }
  } catch (const std::bad_alloc&) {
    // Those that are listed; the next sweep finds the others.
  }
  for (const std::uint64_t serial : late)
    if (Connection* c = find(serial)) guarded(serial, [&] { onDeadline(*c); });
}

Connection* ConnectionLoop::Loop::longestIdle() {
  Connection* longest = nullptr;
  for (const auto& [serial, c] : connections_)
    if (c->idle() && (!longest || c->deadline < longest->deadline)) longest = c.get();
  return longest;
}

/// Closes one connection for a newcomer from `peer`: the longest idle; without one, the request that has been
/// arriving for the longest from the address that has most of them, if that has more than `peer` will have.
bool ConnectionLoop::Loop::makeRoomFor(const std::string& peer) {
  if (Connection* idle = longestIdle()) {
    drop(*idle);
    return true;
  }
  std::map<std::string_view, std::size_t> reading;
  for (const auto& [serial, c] : connections_)
    if (c->reading()) ++reading[c->peer];
  const auto most = std::max_element(reading.begin(), reading.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  if (most == reading.end() || most->second <= reading[peer] + 1) return false;
  Connection* oldest = nullptr;
  for (const auto& [serial, c] : connections_)
    if (c->reading() && c->peer == most->first && (!oldest || serial < oldest->serial)) oldest = c.get();
  drop(*oldest);
  return true;
}

/// Clients that leave their answers unread must not fill the memory. False: `but` is the only one.
bool ConnectionLoop::Loop::closeOldestWriting(const Connection& but) {
  Connection* oldest = nullptr;
  for (const auto& [serial, c] : connections_)
    if (c->state == State::Writing && c.get() != &but && (!oldest || c->deadline < oldest->deadline))
      oldest = c.get();
  if (oldest) drop(*oldest);
  return oldest != nullptr;
}

} // namespace chamfer::http
