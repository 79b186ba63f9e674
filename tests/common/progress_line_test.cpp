#include "common/progress_line.h"

#include <cstdlib>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <thread>

namespace chamfer {
namespace {

using std::chrono::milliseconds;

/// Both ends of a terminal.
class Terminal {
public:
  Terminal() : screen_(::posix_openpt(O_RDWR | O_NOCTTY)) {
    if (screen_ < 0 || ::grantpt(screen_) != 0 || ::unlockpt(screen_) != 0) return;
    program_ = ::open(::ptsname(screen_), O_RDWR | O_NOCTTY);
    ::fcntl(screen_, F_SETFL, O_NONBLOCK);
  }
  ~Terminal() {
    ::close(program_);
    ::close(screen_);
  }
  int program() const { return program_; }
  /// What has come since the last call.
  std::string read() const {
    char text[4096];
    const ssize_t n = ::read(screen_, text, sizeof text);
    return {text, std::size_t(std::max<ssize_t>(n, 0))};
  }

private:
  int screen_, program_ = -1;
};

TEST(ProgressLine, AppearsAfterASecondAndIsGoneAtTheEnd) {
  const Terminal terminal;
  ASSERT_GE(terminal.program(), 0);
  {
    ProgressLine line(true, terminal.program());
    line("reading", 0.2);
    EXPECT_EQ(terminal.read(), "");
    std::this_thread::sleep_for(milliseconds(1010));
    line("rounding", 0.5);
    EXPECT_EQ(terminal.read(), "\rrounding     [###############               ]  50 %");
    line("rounding", 0.9);
    EXPECT_EQ(terminal.read(), "") << "ten times a second at most";
    std::this_thread::sleep_for(milliseconds(110));
    line("rounding", 0.4);
    EXPECT_EQ(terminal.read(), "") << "never backwards";
    line("packing", 0);
    EXPECT_EQ(terminal.read(), "\rpacking      [                              ]   0 %");
  }
  EXPECT_EQ(terminal.read(), "\r\033[K");
}

TEST(ProgressLine, IsForTerminalsWhereItIsWanted) {
  const Terminal terminal;
  ASSERT_GE(terminal.program(), 0);
  int pipe[2];
  ASSERT_EQ(::pipe2(pipe, O_NONBLOCK), 0);
  {
    ProgressLine unwanted(false, terminal.program()), noTerminal(true, pipe[1]);
    std::this_thread::sleep_for(milliseconds(1010));
    unwanted("rounding", 0.5);
    noTerminal("rounding", 0.5);
  }
  EXPECT_EQ(terminal.read(), "");
  char c;
  EXPECT_EQ(::read(pipe[0], &c, 1), -1);
  ::close(pipe[0]);
  ::close(pipe[1]);
}

} // namespace
} // namespace chamfer
