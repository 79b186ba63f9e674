// The only file that knows cpp-httplib (0.11.4, Debian's split package: pkg-config's flags are part of its
// ABI).
//
// The library binds the socket and frames the answers. What it does badly in this version is kept from it:
// - one thread a connection, select(), an accept() whose passing errors end the listener for good: our
//   connection loop has the listening socket;
// - chunked and compressed bodies, bodies of GET, repeated lengths, percent-decoding in header values,
// ranges, regular
//   expressions over what clients send: heads are read by request_head.cpp and the library is shown a head of
//   ours;
// - exception texts in answers: what is thrown goes on to exchange(), which says nothing of it;
// - SO_REUSEPORT, by which a second server would silently share the port: replaced by SO_REUSEADDR.
#include "server/http/connection/http_server.h"

#include <fcntl.h>
#include <httplib.h>
#include <string.h>
#include <thread>

namespace chamfer::http {
namespace {

constexpr int kBacklog = 512;
constexpr std::size_t kHeadRoom = 4096; ///< for an answer's head

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

/// What is sent when there is no memory to make any other answer.
constexpr std::string_view kLastResort =
    "HTTP/1.1 503 Service Unavailable\r\nRetry-After: 10\r\nCache-Control: no-store\r\nConnection: close\r\n"
    "X-Content-Type-Options: nosniff\r\nContent-Type: application/problem+json\r\nContent-Length: 105\r\n\r\n"
    R"({"type":"urn:chamfer:problem:busy","title":"Busy","status":503,"detail":"the server is short of memory"})"
    "\n";
static_assert(kLastResort.size() - kLastResort.find("\r\n\r\n") - 4 == 105);

/// The request as its head says it, without its body.
Request requestOf(const RequestHead& head, const std::string& peer) {
  Request request;
  const std::size_t mark = head.target.find('?');
  request.method = head.method;
  request.path = head.target.substr(0, mark);
  if (mark != std::string::npos) request.query = head.target.substr(mark + 1);
  request.headers = head.headers;
  request.client = peer;
  return request;
}

} // namespace

class HttpServer::Library : public httplib::Server {
public:
  Library(const ConnectionLimits& limits, RequestHandler handler, RequestScreen screen)
      : handler_(std::move(handler)), screen_(std::move(screen)) {
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
    set_exception_handler([](const httplib::Request&, httplib::Response&, std::exception_ptr error) {
      std::rethrow_exception(error); // to exchange()
    });
    loop_ = std::make_unique<ConnectionLoop>(
        limits, [this](RawRequest& raw) { return exchange(raw); },
        [this](const RequestHead& head, std::string& client) { return screened(head, client); });
  }

  int start(const std::string& host, int port) {
    const int bound = port == 0 ? bind_to_any_port(host) : (bind_to_port(host, port) ? port : -1);
    if (bound <= 0)
      throw Error(ErrorKind::Usage, "cannot listen on " + host + " port " + std::to_string(port) + ": " +
                                        ::strerror(errno) + "; choose another --port or --host");
    const int socket = svr_sock_.exchange(INVALID_SOCKET); // no longer the library's
    ::fcntl(socket, F_SETFL, ::fcntl(socket, F_GETFL) | O_NONBLOCK);
    ::listen(socket, kBacklog); // the library asks for 5
    loop_->listen(socket);
    return bound;
  }

  void stop(std::chrono::milliseconds grace) {
    stopping_ = true;
    loop_->stopListening();
    const auto end = std::chrono::steady_clock::now() + grace;
    while (loop_->counts().busy > 0 && std::chrono::steady_clock::now() < end)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    loop_->stop();
  }

  ConnectionCounts counts() const { return loop_->counts(); }

private:
  std::optional<Problem> screened(const RequestHead& head, std::string& client) {
    if (!screen_) return std::nullopt;
    Request request = requestOf(head, client);
    std::optional<Problem> problem = screen_(request);
    client = request.client;
    return problem;
  }

  /// Nothing may be thrown from here: it would end the process.
  RawAnswer exchange(RawRequest& raw) {
    try {
      return framed(raw);
    } catch (...) {
      current_ = nullptr;
    }
    try {
      return {std::string(kLastResort), true};
    } catch (...) {
      return {{}, true};
    }
  }

  RawAnswer framed(RawRequest& raw) {
    const bool head = raw.head.method == "HEAD";
    const bool keepAlive = raw.head.keepAlive && !stopping_;
    Request request = requestOf(raw.head, raw.peer);
    request.body = std::move(raw.body);
    request.cancelled.clientGone = raw.clientGone;
    Response response = handler_(request, raw.refusal ? &*raw.refusal : nullptr);
    const bool close = response.close || !keepAlive || raw.refusal;
    MemoryStream stream(std::string(head ? "HEAD" : "GET") + " / HTTP/1.1\r\n\r\n");
    stream.output.reserve(response.body.size() + kHeadRoom);
    current_ = &response;
    bool libraryCloses = false;
    process_request(stream, close, libraryCloses, nullptr);
    current_ = nullptr;
    return {std::move(stream.output), close};
  }

  /// The answer that this thread is framing: the library gives its handlers no other way to know.
  static thread_local Response* current_;

  const RequestHandler handler_;
  const RequestScreen screen_;
  std::atomic<bool> stopping_ = false;
  std::unique_ptr<ConnectionLoop> loop_;
};

thread_local Response* HttpServer::Library::current_ = nullptr;

HttpServer::HttpServer(const ConnectionLimits& limits, RequestHandler handler, RequestScreen screen)
    : library_(std::make_unique<Library>(limits, std::move(handler), std::move(screen))) {}
HttpServer::~HttpServer() = default;
int HttpServer::start(const std::string& host, int port) { return library_->start(host, port); }
void HttpServer::stop(std::chrono::milliseconds grace) { library_->stop(grace); }
ConnectionCounts HttpServer::counts() const { return library_->counts(); }

} // namespace chamfer::http
