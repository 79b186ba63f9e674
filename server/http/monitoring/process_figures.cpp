#include "server/http/monitoring/process_figures.h"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <sys/resource.h>
#include <unistd.h>

namespace chamfer::http {
namespace {

/// When the machine was started, in seconds since the epoch (proc(5), /proc/stat).
double bootTime() {
  std::ifstream file("/proc/stat");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("btime ")) return std::stod(line.substr(6));
  return 0;
}

/// Ticks after boot at which this process began: field 22 of /proc/self/stat. The second field, the program's
/// name in brackets, may hold blanks.
double startTicks() {
  std::ifstream file("/proc/self/stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name = line.rfind(") ");
  if (name == std::string::npos) return 0;
  std::istringstream fields(line.substr(name + 2));
  std::string field;
  for (int i = 3; i <= 22; ++i)
    fields >> field;
  return fields ? std::stod(field) : 0;
}

double seconds(const timeval& time) {
  return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
}

} // namespace

ProcessFigures processFigures() {
  ProcessFigures figures;
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  std::size_t virtualPages = 0, residentPages = 0;
  if (std::ifstream("/proc/self/statm") >> virtualPages >> residentPages) {
    figures.virtualBytes = virtualPages * page;
    figures.residentBytes = residentPages * page;
  }
  std::error_code error;
  for (auto entry = std::filesystem::directory_iterator("/proc/self/fd", error);
       !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
    ++figures.openDescriptors;
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) == 0) figures.maxDescriptors = limit.rlim_cur;
  rusage usage{};
  if (::getrusage(RUSAGE_SELF, &usage) == 0)
    figures.cpuSeconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  static const double begin = bootTime() + startTicks() / static_cast<double>(::sysconf(_SC_CLK_TCK));
  figures.startTimeSeconds = begin;
  return figures;
}

} // namespace chamfer::http
