// The real program: started, asked, stopped, killed.
#pragma once

#include <array>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <string>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace chamfer::test {

inline constexpr const char* kChamferd = CHAMFER_BINARY_DIR "/server/chamferd";

/// A running chamferd with its standard output and error in pipes.
class Program {
public:
  explicit Program(std::vector<std::string> arguments, const std::vector<std::string>& environment = {}) {
    arguments.insert(arguments.begin(), kChamferd);
    std::array<int, 2> out{}, err{};
    if (::pipe2(out.data(), O_CLOEXEC) != 0 || ::pipe2(err.data(), O_CLOEXEC) != 0) std::abort();
    std::vector<char*> argv;
    for (std::string& argument : arguments)
      argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out[1], STDOUT_FILENO);
      ::dup2(err[1], STDERR_FILENO);
      for (const std::string& variable : environment)
        ::putenv(const_cast<char*>(variable.c_str()));
      ::execv(kChamferd, argv.data());
      ::_exit(127);
    }
    ::close(out[1]);
    ::close(err[1]);
    out_ = out[0];
    errors_ = std::jthread([this, fd = err[0]] {
      std::array<char, 4096> bytes;
      for (ssize_t n; (n = ::read(fd, bytes.data(), bytes.size())) > 0;)
        errorText_.append(bytes.data(), static_cast<std::size_t>(n));
      ::close(fd);
    });
  }
  ~Program() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      finish();
    }
    ::close(out_);
  }
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  /// The next line of standard output; empty at its end.
  std::string line() {
    std::string text;
    for (char c = 0; ::read(out_, &c, 1) == 1 && c != '\n';)
      text += c;
    return text;
  }
  /// Waits for "listening on http://127.0.0.1:PORT/".
  int port() {
    const std::string text = line();
    const std::string start = "listening on http://127.0.0.1:";
    EXPECT_TRUE(text.starts_with(start)) << text;
    return text.starts_with(start) ? std::stoi(text.substr(start.size())) : 0;
  }
  void signal(int number) const { ::kill(pid_, number); }
  /// Exit status; -1 when a signal ended it.
  int finish() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    errors_.join();
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// Everything on standard error; after finish().
  const std::string& errorText() const { return errorText_; }

private:
  pid_t pid_ = -1;
  int out_ = -1;
  std::string errorText_;
  std::jthread errors_;
};

} // namespace chamfer::test
