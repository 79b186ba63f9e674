// `chamferd serve ROOT`: the long-running server. The caller parses the command line.
#pragma once

#include "server/render/scene/scene.h"

#include <filesystem>
#include <string>
#include <vector>

namespace chamfer::http {

struct ServeCommandOptions {
  std::filesystem::path root;     ///< folder with the scenes
  std::string host = "127.0.0.1"; ///< address or name to listen on
  int port = 8080;                ///< 0: any free one
  unsigned threads = 0;           ///< of each render; 0: all cores
  unsigned slots = 2;             ///< requests rendered at one time
  unsigned waiting = 64;          ///< requests that may wait for a slot
  unsigned connections = 512;
  std::size_t cacheMegabytes = 1024;   ///< of prepared scenes
  std::size_t sceneMegabytes = 8192;   ///< of all scenes, as loaded
  double deadlineSeconds = 120;        ///< of one request
  double rescanSeconds = 2;            ///< how often files are looked at again; 0: never
  double drainDelaySeconds = 0;        ///< after SIGTERM, not ready yet taking work: for balancers to see it
  double drainSeconds = 30;            ///< after SIGTERM, for what is under way
  std::filesystem::path keyFile;       ///< one key a line; empty: no key is asked for
  bool behindProxy = false;            ///< the client is the last address of X-Forwarded-For
  bool noAuth = false;                 ///< listen beyond this machine without keys
  std::vector<std::string> allowHosts; ///< names in Host that are answered, beside the loopback ones
  UpAxis upAxis = UpAxis::Z;           ///< of bare meshes
  std::filesystem::path web;           ///< folder of the page; empty: the one in the program
  std::filesystem::path jobs;          ///< folder of comparisons; empty: none are taken
  std::size_t jobsMegabytes = 4096;    ///< of that folder
  double jobsDays = 30;                ///< that finished jobs stay
  unsigned jobsWaiting = 128;          ///< jobs that may wait or run
  std::string logLevel = "info";
};

/// Serves until SIGTERM or SIGINT, then drains and returns 0; a second signal ends it at once. Prints
/// "listening on http://HOST:PORT/" on standard output once it listens and its scenes are loaded (large
/// catalogues go on loading behind it: /readyz tells). Throws Error for what is wrong at start.
int runServeCommand(const ServeCommandOptions& options);

} // namespace chamfer::http
