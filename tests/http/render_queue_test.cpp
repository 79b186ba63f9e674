#include "server/http/queue/render_queue.h"

#include "tests/http/expect_problem.h"

#include <atomic>
#include <optional>
#include <thread>
#include <vector>

namespace chamfer::http {
namespace {

using std::chrono::milliseconds;

const auto kNever = [] { return false; };

void waitFor(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000 && !condition(); ++i)
    std::this_thread::sleep_for(milliseconds(1));
  ASSERT_TRUE(condition());
}

TEST(RenderQueue, GivesEverySlotThenRefuses) {
  RenderQueue queue(2, 0);
  const auto first = queue.acquire("a", kNever);
  {
    const auto second = queue.acquire("a", kNever);
    EXPECT_EQ(queue.state().running, 2u);
    const Problem problem = test::problemFrom([&] { queue.acquire("b", kNever); }, 503);
    EXPECT_GE(problem.retryAfterSeconds, 1);
  }
  EXPECT_EQ(queue.state().running, 1u);
  EXPECT_NO_THROW(queue.acquire("b", kNever));
}

TEST(RenderQueue, WaiterIsServedWhenASlotIsFreed) {
  RenderQueue queue(1, 1);
  std::optional<RenderQueue::Slot> held(queue.acquire("a", kNever));
  std::atomic<bool> served = false;
  std::jthread waiter([&] {
    const auto slot = queue.acquire("b", kNever);
    served = true;
  });
  waitFor([&] { return queue.state().waiting == 1; });
  EXPECT_FALSE(served);
  test::problemFrom([&] { queue.acquire("c", kNever); }, 503); // the only place is taken
  held.reset();
  waitFor([&] { return served.load(); });
}

TEST(RenderQueue, WaiterLeavesWhenCancelled) {
  RenderQueue queue(1, 4);
  const auto held = queue.acquire("a", kNever);
  std::atomic<bool> cancelled = false;
  std::atomic<bool> left = false;
  std::jthread waiter([&] {
    try {
      queue.acquire("b", [&] { return cancelled.load(); });
    } catch (const Error& error) {
      left = error.kind() == ErrorKind::Cancelled;
    }
  });
  waitFor([&] { return queue.state().waiting == 1; });
  cancelled = true;
  waitFor([&] { return left.load(); });
  EXPECT_EQ(queue.state().waiting, 0u);
}

TEST(RenderQueue, FreedSlotGoesToTheClientThatHoldsFewest) {
  RenderQueue queue(2, 8);
  std::optional<RenderQueue::Slot> one(queue.acquire("greedy", kNever)), two(queue.acquire("greedy", kNever));
  std::mutex mutex;
  std::vector<std::string> order;
  std::vector<std::jthread> waiters;
  const auto wait = [&](const std::string& client) {
    const unsigned before = queue.state().waiting;
    waiters.emplace_back([&, client] {
      const auto slot = queue.acquire(client, kNever);
      const std::lock_guard lock(mutex);
      order.push_back(client);
    });
    waitFor([&] { return queue.state().waiting == before + 1; });
  };
  wait("greedy");
  wait("greedy");
  wait("modest");
  one.reset(); // greedy still holds one
  waitFor([&] {
    const std::lock_guard lock(mutex);
    return !order.empty();
  });
  {
    const std::lock_guard lock(mutex);
    EXPECT_EQ(order.front(), "modest");
  }
  two.reset();
  waiters.clear();
  EXPECT_EQ(order.size(), 3u);
}

TEST(RenderQueue, GreediestClientGivesUpAPlace) {
  RenderQueue queue(1, 3);
  auto running = std::make_optional(queue.acquire("greedy", kNever));
  std::atomic<int> displaced = 0, served = 0;
  std::vector<std::jthread> greedy;
  for (unsigned i = 0; i < 3; ++i) {
    greedy.emplace_back([&] {
      try {
        const RenderQueue::Slot slot = queue.acquire("greedy", kNever);
        ++served;
      } catch (const ProblemError& error) {
        EXPECT_EQ(error.problem().status, 429);
        EXPECT_GE(error.problem().retryAfterSeconds, 1);
        EXPECT_EQ(error.problem().scarcity, Scarcity::FairShare);
        ++displaced;
      }
    });
    waitFor([&] { return queue.state().waiting == i + 1; });
  }
  EXPECT_EQ(test::problemFrom([&] { queue.acquire("greedy", kNever); }, 503).scarcity, Scarcity::RenderQueue);
  std::jthread modest([&] {
    const RenderQueue::Slot slot = queue.acquire("modest", kNever);
    ++served;
  });
  waitFor([&] { return displaced == 1; });
  EXPECT_EQ(queue.state().waiting, 3u);
  // Two against one: another of the modest client's would make it as many.
  test::problemFrom([&] { queue.acquire("modest", kNever); }, 503);
  running.reset();
  modest.join();
  greedy.clear();
  EXPECT_EQ(displaced, 1);
  EXPECT_EQ(served, 3);
}

TEST(RenderQueue, NeverRunsMoreThanItsSlots) {
  RenderQueue queue(3, 64);
  std::atomic<int> running = 0, most = 0;
  {
    std::vector<std::jthread> clients;
    for (int c = 0; c < 12; ++c)
      clients.emplace_back([&, c] {
        for (int i = 0; i < 50; ++i) {
          const auto slot = queue.acquire(std::to_string(c % 4), kNever);
          const int now = ++running;
          for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
          }
          std::this_thread::yield();
          --running;
        }
      });
  }
  EXPECT_LE(most, 3);
  EXPECT_EQ(queue.state().running, 0u);
  EXPECT_EQ(queue.state().waiting, 0u);
}

TEST(RenderQueue, BackgroundHasAPlaceBesideTheSlots) {
  RenderQueue queue(1, 0);
  const auto background = queue.acquireBackground(milliseconds(0), kNever);
  EXPECT_TRUE(queue.state().background);
  EXPECT_EQ(queue.state().running, 0u);
  const auto slot = queue.acquire("a", kNever); // at once, although there is but one
  EXPECT_EQ(queue.state().running, 1u);
}

TEST(RenderQueue, BackgroundWaitsForRequestsToEnd) {
  RenderQueue queue(2, 4);
  auto slot = std::make_optional(queue.acquire("a", kNever));
  std::atomic<bool> let = false;
  std::jthread background([&] {
    const auto place = queue.acquireBackground(std::chrono::minutes(1), kNever);
    let = true;
  });
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_FALSE(let) << "one slot is free, but a request is being rendered";
  EXPECT_EQ(queue.state().waiting, 0u) << "it takes no place from requests";
  slot.reset();
  waitFor([&] { return let.load(); });
}

TEST(RenderQueue, BackgroundDoesNotStarve) {
  RenderQueue queue(1, 4);
  const auto slot = queue.acquire("a", kNever);
  const auto begin = std::chrono::steady_clock::now();
  const auto place = queue.acquireBackground(milliseconds(150), kNever);
  EXPECT_GE(std::chrono::steady_clock::now() - begin, milliseconds(150));
}

TEST(RenderQueue, BackgroundIsOneAtATimeAndCanBeCancelled) {
  RenderQueue queue(2, 4);
  auto first = std::make_optional(queue.acquireBackground(milliseconds(0), kNever));
  std::atomic<bool> cancelled = false, left = false;
  std::jthread second([&] {
    try {
      const auto place = queue.acquireBackground(milliseconds(0), [&] { return cancelled.load(); });
    } catch (const Error& error) {
      left = error.kind() == ErrorKind::Cancelled;
    }
  });
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_FALSE(left);
  cancelled = true;
  waitFor([&] { return left.load(); });
  first.reset();
  EXPECT_FALSE(queue.state().background);
  EXPECT_NO_THROW(queue.acquireBackground(milliseconds(0), kNever));
}

} // namespace
} // namespace chamfer::http
