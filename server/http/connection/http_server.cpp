// The only file that knows cpp-httplib (0.11.4, Debian's split package: pkg-config's flags are part of its
// ABI).
//
// The library listens, accepts, and frames the answers. What it does badly in this version is kept from it:
// - one thread a connection, select(): process_and_close_socket() hands the socket to our connection loop at
// once;
// - chunked and compressed bodies, bodies of GET, repeated lengths, percent-decoding in header values,
// ranges, regular
//   expressions over what clients send: heads are read by request_head.cpp and the library is shown a head of
//   ours;
// - exception texts in answers: the handler does not throw, and the exception handler says nothing;
// - SO_REUSEPORT, by which a second server would silently share the port: replaced by SO_REUSEADDR.
#include "server/http/connection/http_server.h"

#include <httplib.h>
#include <string.h>
#include <thread>

namespace chamfer::http {
namespace {

constexpr int kBacklog = 512;

/// Our head in, the answer's bytes out.
class MemoryStream : public httplib::Stream {
public:
  explicit MemoryStream(std::string input) : input_(std::move(input)) {}
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  ssize_t read(char* to, size_t size) override {
    const std::size_t n = input_.copy(to, size, position_);
    position_ += n;
    return static_cast<ssize_t>(n);
  }
  ssize_t write(const char* from, size_t size) override {
    output.append(from, size);
    return static_cast<ssize_t>(size);
  }
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return 0; } // below FD_SETSIZE, and never used

  std::string output;

private:
  std::string input_;
  std::size_t position_ = 0;
};

/// Runs the library's task, which only hands the socket on, on the accepting thread.
class InlineQueue : public httplib::TaskQueue {
public:
  void enqueue(std::function<void()> task) override { task(); }
  void shutdown() override {}
};

Request requestOf(RawRequest& raw) {
  Request request;
  const std::string& target = raw.head.target;
  const std::size_t mark = target.find('?');
  request.method = raw.head.method;
  request.path = target.substr(0, mark);
  if (mark != std::string::npos) request.query = target.substr(mark + 1);
  request.headers = std::move(raw.head.headers);
  request.body = std::move(raw.body);
  request.client = raw.peer;
  request.cancelled.clientGone = raw.clientGone;
  return request;
}

} // namespace

class HttpServer::Library : public httplib::Server {
public:
  Library(const ConnectionLimits& limits, RequestHandler handler) : handler_(std::move(handler)) {
    new_task_queue = [] { return new InlineQueue; };
    set_tcp_nodelay(true);
    set_socket_options([](socket_t socket) {
      const int on = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    });
    set_pre_routing_handler([](const httplib::Request&, httplib::Response& response) {
      response.status = current_->status;
      for (const auto& [name, value] : current_->headers)
        response.set_header(name, value);
      if (!current_->body.empty()) response.set_content(std::move(current_->body), current_->contentType);
      return HandlerResponse::Handled;
    });
    set_post_routing_handler([](const httplib::Request& request, httplib::Response& response) {
      // Said by the library, and not true here: its keep-alive limits, ranges, and the length of what is not
      // sent.
      response.headers.erase("Keep-Alive");
      response.headers.erase("Accept-Ranges");
      if (response.status == 204 || response.status == 304 ||
          (request.method == "HEAD" && response.body.empty()))
        response.headers.erase("Content-Length");
    });
    set_exception_handler([](const httplib::Request&, httplib::Response& response, std::exception_ptr) {
      response.status = 500;
    });
    loop_ = std::make_unique<ConnectionLoop>(limits, [this](RawRequest& raw) { return exchange(raw); });
  }

  ~Library() override { stopAccepting(); }

  int start(const std::string& host, int port) {
    const int bound = port == 0 ? bind_to_any_port(host) : (bind_to_port(host, port) ? port : -1);
    if (bound <= 0)
      throw Error(ErrorKind::Usage, "cannot listen on " + host + " port " + std::to_string(port) + ": " +
                                        ::strerror(errno) + "; choose another --port or --host");
    ::listen(svr_sock_, kBacklog); // the library asks for 5
    accepting_ = std::thread([this, host, bound] {
      // The library's loop ends for good on some passing errors of accept(); begin again unless it was asked
      // to end.
      while (!listen_after_bind() && !stopping_) {
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
        if (!stopping_ && bind_to_port(host, bound)) ::listen(svr_sock_, kBacklog);
      }
    });
    return bound;
  }

  void stopAccepting() {
    stopping_ = true;
    if (!accepting_.joinable()) return;
    // stop() does nothing until the loop has begun.
    while (!is_running() && svr_sock_ != INVALID_SOCKET)
      std::this_thread::yield();
    httplib::Server::stop();
    accepting_.join();
  }

  void stop(std::chrono::milliseconds grace) {
    stopAccepting();
    const auto end = std::chrono::steady_clock::now() + grace;
    while (loop_->counts().busy > 0 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    loop_->stop();
  }

  ConnectionCounts counts() const { return loop_->counts(); }

private:
  bool process_and_close_socket(socket_t socket) override {
    loop_->adopt(socket);
    return true;
  }

  RawAnswer exchange(RawRequest& raw) {
    const bool head = raw.head.method == "HEAD";
    const bool keepAlive = raw.head.keepAlive && !stopping_;
    Request request = requestOf(raw);
    Response response = handler_(request, raw.refusal ? &*raw.refusal : nullptr);
    const bool close = response.close || !keepAlive || raw.refusal;
    current_ = &response;
    MemoryStream stream(std::string(head ? "HEAD" : "GET") + " / HTTP/1.1\r\n\r\n");
    bool libraryCloses = false;
    process_request(stream, close, libraryCloses, nullptr);
    current_ = nullptr;
    return {std::move(stream.output), close};
  }

  /// The answer that this thread is framing: the library gives its handlers no other way to know.
  static thread_local Response* current_;

  const RequestHandler handler_;
  std::atomic<bool> stopping_ = false;
  std::unique_ptr<ConnectionLoop> loop_;
  std::thread accepting_;
};

thread_local Response* HttpServer::Library::current_ = nullptr;

HttpServer::HttpServer(const ConnectionLimits& limits, RequestHandler handler)
    : library_(std::make_unique<Library>(limits, std::move(handler))) {}
HttpServer::~HttpServer() = default;
int HttpServer::start(const std::string& host, int port) { return library_->start(host, port); }
void HttpServer::stop(std::chrono::milliseconds grace) { library_->stop(grace); }
ConnectionCounts HttpServer::counts() const { return library_->counts(); }

} // namespace chamfer::http
