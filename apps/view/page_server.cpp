#include "apps/view/page_server.hpp"

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <functional>
#include <thread>
#include <utility>

#include <httplib.h>
#include <sys/resource.h>

#include "apps/console/log.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;
using httplib::Request, httplib::Response;

/// One thread for each viewer, as their answers have no end, and some for all others.
constexpr std::size_t kThreads = Viewers::kMost + 16;
constexpr int kNice = 10;
constexpr std::size_t kMostFrames = 600;
/// Bytes that may be on their way to a stalled viewer: a few events.
constexpr int kSendBuffer_bytes = 256 * 1024;

const httplib::Headers kHeaders{
    {"Content-Security-Policy",
     "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; connect-src 'self'; "
     "base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Referrer-Policy", "no-referrer"},
    {"Cache-Control", "no-store"}};

void setSocketOptions(socket_t socket) {
  const int yes = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  ::setsockopt(socket, SOL_SOCKET, SO_SNDBUF, &kSendBuffer_bytes, sizeof(kSendBuffer_bytes));
}

RequestFacts factsOf(const Request& request) {
  return {.method = request.method,
          .path = request.path,
          .host = request.get_header_value("Host"),
          .origin = request.get_header_value("Origin"),
          .fetch_site = request.get_header_value("Sec-Fetch-Site"),
          .token = request.has_param("token") ? request.get_param_value("token") : ""};
}

void refuse(Response& response, const Refusal& refusal) {
  response.status = refusal.status;
  if (refusal.status == 405) response.set_header("Allow", "GET, HEAD");
  response.set_content(refusal.sentence + "\n", "text/plain; charset=utf-8");
}

std::int64_t numberOf(const std::string& text, std::int64_t otherwise) {
  std::int64_t number = otherwise;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

/// Sends an event, or a comment that keeps the stream alive.
bool send(httplib::DataSink& sink, std::string_view text) { return sink.write(text.data(), text.size()); }

}  // namespace

class PageServer::Impl {
 public:
  Impl(ListenAddress address, PageSource& source, Viewers& viewers);
  ~Impl();
  int port() const { return address_.port; }
  std::string url() const { return "http://" + address_.localText() + "/"; }
  std::string controlUrl() const { return url() + "#token=" + guard_->token(); }

 private:
  void configure();
  void listen();
  void route();
  void routeRun(const std::string& path, const std::function<const PageSource*()>& run);
  void answerEvents(Response& response);
  void answerPicture(const Request& request, Response& response);
  void answerControl(const Request& request, Response& response);
  static std::string framesJson(const Request& request, const PageSource& source);
  static void answerJson(Response& response, const std::string& json);

  ListenAddress address_;
  PageSource& source_;
  Viewers& viewers_;
  httplib::Server server_;
  std::unique_ptr<RequestGuard> guard_;
  std::jthread thread_;
};

PageServer::Impl::Impl(ListenAddress address, PageSource& source, Viewers& viewers)
    : address_(std::move(address)), source_(source), viewers_(viewers) {
  configure();
  listen();
  guard_ = std::make_unique<RequestGuard>(address_);
  if (const std::string warning = exposureWarning(address_); !warning.empty()) logWarning(warning);
  route();
  thread_ = std::jthread([this] {
    ::setpriority(PRIO_PROCESS, 0, kNice);  // of this thread and of those that it starts
    server_.listen_after_bind();
  });
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (!server_.is_running()) {  // stopping it earlier would have no effect
    if (std::chrono::steady_clock::now() > deadline) throw OutputError(address_.text() + ": the server does not start");
    std::this_thread::sleep_for(1ms);
  }
}

PageServer::Impl::~Impl() {
  viewers_.close();
  server_.stop();
}

void PageServer::Impl::configure() {
  server_.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };  // the server owns it
  server_.set_socket_options(setSocketOptions);
  server_.set_tcp_nodelay(true);
  server_.set_keep_alive_max_count(1);  // no thread waits for what a page may ask next
  server_.set_keep_alive_timeout(2);
  server_.set_read_timeout(2);
  server_.set_write_timeout(1);
  server_.set_payload_max_length(0);
  server_.set_default_headers(kHeaders);
}

void PageServer::Impl::listen() {
  errno = 0;
  if (address_.port != 0 && server_.bind_to_port(address_.host, address_.port)) return;
  if (address_.port == 0) {
    const int port = server_.bind_to_any_port(address_.host);
    if (port > 0) {
      address_.port = port;
      return;
    }
  }
  const std::string why = errno != 0 ? std::strerror(errno) : "no such address";
  throw OutputError(address_.text() + ": cannot listen there: " + why +
                    "; choose another port or address as ADDR:PORT, with port 0 for any that is free");
}

void PageServer::Impl::route() {
  server_.set_pre_routing_handler([this](const Request& request, Response& response) {
    const auto refusal = guard_->refusalOf(factsOf(request));
    if (refusal) refuse(response, *refusal);
    return refusal ? httplib::Server::HandlerResponse::Handled : httplib::Server::HandlerResponse::Unhandled;
  });
  for (const Asset& asset : assets())
    server_.Get(asset.path, [asset](const Request&, Response& response) {
      response.set_content(asset.content.data(), asset.content.size(), asset.type);
    });
  server_.Get("/metrics", [this](const Request&, Response& response) {
    response.set_content(metricsText(source_.snapshot()), "text/plain; version=0.0.4; charset=utf-8");
  });
  server_.Get("/events", [this](const Request&, Response& response) { answerEvents(response); });
  routeRun("", [this] { return &source_; });
  routeRun("/against", [this] { return source_.against(); });
  server_.Get(R"(/image/(\d{1,12})\.jpg)",
              [this](const Request& request, Response& response) { answerPicture(request, response); });
  server_.Get(R"(/control/(pause|resume|step))",
              [this](const Request& request, Response& response) { answerControl(request, response); });
}

/// Registers the routes of a run's JSON below `path`; they answer 404 if `run` returns null.
void PageServer::Impl::routeRun(const std::string& path, const std::function<const PageSource*()>& run) {
  const auto answer = [run](Response& response, const std::function<std::string(const PageSource&)>& json) {
    const PageSource* const source = run();
    if (!source) return refuse(response, {404, "There is no other run; view RUN --against OTHER shows two."});
    answerJson(response, json(*source));
  };
  server_.Get(path + "/run.json", [answer](const Request&, Response& response) {
    answer(response, [](const PageSource& source) { return toJson(source.run()); });
  });
  server_.Get(path + "/overview.json", [answer](const Request&, Response& response) {
    answer(response, [](const PageSource& source) { return source.overviewJson(); });
  });
  server_.Get(path + "/frames.json", [answer](const Request& request, Response& response) {
    answer(response, [&request](const PageSource& source) { return framesJson(request, source); });
  });
  server_.Get(path + R"(/frame/(\d{1,12})\.json)", [answer](const Request& request, Response& response) {
    const std::int64_t frame = numberOf(request.matches[1], -1);
    answer(response, [frame](const PageSource& source) { return source.frameJson(frame); });
  });
}

/// Answers with events. The answer has no end while the run goes on; between events a comment tells whether the viewer
/// is still there.
void PageServer::Impl::answerEvents(Response& response) {
  const std::shared_ptr<Viewers::Seat> seat = viewers_.admit();
  if (!seat) {
    const std::string most = std::to_string(Viewers::kMost);
    return refuse(response, {503, "All " + most + " places are taken; close a page that follows this run and reload."});
  }
  response.set_header("X-Accel-Buffering", "no");
  response.set_chunked_content_provider("text/event-stream", [seat](std::size_t, httplib::DataSink& sink) {
    const EventText event = seat->next(2s);
    if (event) return send(sink, "data: " + *event + "\n\n");
    if (!seat->over()) return send(sink, ": waiting\n\n");
    sink.done();
    return true;
  });
}

std::string PageServer::Impl::framesJson(const Request& request, const PageSource& source) {
  const auto parameter = [&](const char* name, std::int64_t otherwise) {
    return request.has_param(name) ? numberOf(request.get_param_value(name), otherwise) : otherwise;
  };
  const auto count = std::clamp<std::int64_t>(parameter("count", kMostFrames), 0, kMostFrames);
  return source.framesJson(parameter("from", 0), static_cast<std::size_t>(count));
}

void PageServer::Impl::answerPicture(const Request& request, Response& response) {
  const auto picture = source_.picture(numberOf(request.matches[1], -1));
  if (!picture) return refuse(response, {404, "There is no picture of this frame."});
  response.set_content(*picture, "image/jpeg");
}

void PageServer::Impl::answerControl(const Request& request, Response& response) {
  if (!source_.control(request.matches[1])) return refuse(response, {409, "This run cannot be held."});
  response.set_content("{}", "application/json");
}

void PageServer::Impl::answerJson(Response& response, const std::string& json) {
  if (json.empty()) return refuse(response, {404, "This frame is not kept."});
  response.set_content(json, "application/json");
}

PageServer::PageServer(const ListenAddress& address, PageSource& source, Viewers& viewers)
    : impl_(std::make_unique<Impl>(address, source, viewers)) {}
PageServer::~PageServer() = default;
int PageServer::port() const { return impl_->port(); }
std::string PageServer::url() const { return impl_->url(); }
std::string PageServer::controlUrl() const { return impl_->controlUrl(); }

}  // namespace motorcade
