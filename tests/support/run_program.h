// Runs a program to its end and keeps what it said.
#pragma once

#include <cstdio>
#include <fcntl.h>
#include <memory>
#include <spawn.h>
#include <stdexcept>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

namespace chamfer::test {

struct ProgramRun {
  int status; ///< exit status; -1 when a signal ended it
  std::string out, err;
};

/// `arguments` without the program's own name. Standard input is empty. Throws when it cannot be started.
inline ProgramRun runProgram(const std::string& program, std::vector<std::string> arguments) {
  // Files, not pipes: nobody has to read while the program writes.
  const auto temporary = [] {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::tmpfile(), &std::fclose);
    if (!file) throw std::runtime_error("no temporary file");
    return file;
  };
  const auto out = temporary(), err = temporary();
  const auto contentOf = [](std::FILE* file) {
    std::string text;
    char bytes[4096];
    std::rewind(file);
    for (std::size_t n; (n = std::fread(bytes, 1, sizeof bytes, file)) > 0;)
      text.append(bytes, n);
    return text;
  };
  arguments.insert(arguments.begin(), program);
  std::vector<char*> argv;
  for (std::string& argument : arguments)
    argv.push_back(argument.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(out.get()), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(err.get()), STDERR_FILENO);
  pid_t pid = -1;
  const int failed = ::posix_spawn(&pid, program.c_str(), &actions, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (failed) throw std::runtime_error("cannot start " + program);
  int status = 0;
  ::waitpid(pid, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contentOf(out.get()), contentOf(err.get())};
}

} // namespace chamfer::test
