#include "server/http/connection/connection_loop.h"

#include "server/http/connection/loop.h"

namespace chamfer::http {

ConnectionLoop::ConnectionLoop(const ConnectionLimits& limits, Dispatch dispatch, Screen screen)
    : loop_(std::make_unique<Loop>(limits, std::move(dispatch), std::move(screen))) {}
ConnectionLoop::~ConnectionLoop() = default;
void ConnectionLoop::listen(int socket) { loop_->listen(socket); }
void ConnectionLoop::stopListening() { loop_->stopListening(); }
void ConnectionLoop::stop() { loop_->stop(); }
ConnectionCounts ConnectionLoop::counts() const { return loop_->counts(); }

} // namespace chamfer::http
