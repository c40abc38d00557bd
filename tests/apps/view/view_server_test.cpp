#include <array>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "apps/view/page_server.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

/// A run of one frame.
class ToySource : public PageSource {
 public:
  ShownRun run() const override {
    return {.name = "toy", .first_stamp = {}, .camera = {300, 300, 200, 60, 0.5, 400, 120}};
  }
  RunSnapshot snapshot() const override { return {.state = "running", .received = 7}; }
  std::string framesJson(std::int64_t from, std::size_t count) const override {
    return R"({"frames":[],"asked":[)" + std::to_string(from) + "," + std::to_string(count) + "]}";
  }
  std::string frameJson(std::int64_t frame) const override { return frame == 3 ? "{}" : ""; }
  std::shared_ptr<const std::string> picture(std::int64_t frame) override {
    return frame == 3 ? std::make_shared<const std::string>("JPEG") : nullptr;
  }
  bool control(const std::string& action) override {
    actions.push_back(action);
    return true;
  }
  std::string overviewJson() const override { return overview; }
  const PageSource* against() const override { return other; }
  std::vector<std::string> actions;
  std::string overview;
  const PageSource* other = nullptr;
};

/// A client that sends whatever the test wants, also what no browser would.
class Client {
 public:
  explicit Client(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const int small = 4096;  // so that a client that does not read stalls soon
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof(small));
    const timeval patience{.tv_sec = 10, .tv_usec = 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
    EXPECT_TRUE(connected_);
  }
  ~Client() { ::close(socket_); }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  void say(const std::string& text) const {
    EXPECT_EQ(::send(socket_, text.data(), text.size(), MSG_NOSIGNAL), std::ssize(text));
  }
  /// Text that came until the end of the answer, or until it holds `until`.
  std::string hear(const std::string& until = "") const {
    std::string answer;
    std::array<char, 4096> part{};
    const auto deadline = std::chrono::steady_clock::now() + 20s;
    while (std::chrono::steady_clock::now() < deadline && (until.empty() || answer.find(until) == std::string::npos)) {
      const ssize_t got = ::recv(socket_, part.data(), part.size(), 0);
      if (got <= 0) break;
      answer.append(part.data(), static_cast<std::size_t>(got));
    }
    return answer;
  }

 private:
  int socket_;
  bool connected_ = false;
};

class ViewServer : public testing::Test {
 protected:
  std::string own() const { return "127.0.0.1:" + std::to_string(server_.port()); }
  std::string ask(const std::string& path, const std::string& headers = "", const std::string& method = "GET") const {
    return answerTo(method + " " + path + " HTTP/1.1\r\nHost: " + own() + "\r\n" + headers + "\r\n");
  }
  std::string answerTo(const std::string& request) const {
    const Client client(server_.port());
    client.say(request);
    return client.hear();
  }
  /// The token in the address that is printed.
  std::string token() const {
    const std::string url = server_.controlUrl(), key = "#token=";
    return url.substr(url.find(key) + key.size());
  }
  /// A viewer whose place is taken once the first event is there.
  std::unique_ptr<Client> viewer() const {
    auto client = std::make_unique<Client>(server_.port());
    client->say("GET /events HTTP/1.1\r\nHost: " + own() + "\r\n\r\n");
    return client;
  }
  void publish(const std::string& text) { viewers_.publish(std::make_shared<const std::string>(text)); }

  ToySource source_;
  Viewers viewers_;
  PageServer server_{{.host = "127.0.0.1", .port = 0}, source_, viewers_};
};

TEST_F(ViewServer, ServesThePageAndItsScriptsFromMemory) {
  const std::string page = ask("/");
  EXPECT_THAT(page, StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(page, HasSubstr("<title>Motorcade</title>"));
  EXPECT_THAT(page, HasSubstr("Content-Security-Policy: default-src 'none'; script-src 'self'"));
  EXPECT_THAT(page, Not(HasSubstr("<script>"))) << "no inline script";
  for (const char* path : {"/page.css", "/page.js", "/three.js", "/orbit_controls.js", "/chart.js"})
    EXPECT_THAT(ask(path), StartsWith("HTTP/1.1 200")) << path;
  for (const char* path : {"/../etc/passwd", "/etc/passwd", "/%2e%2e/etc/passwd", "/frame/4.json", "/image/4.jpg"})
    EXPECT_THAT(ask(path), StartsWith("HTTP/1.1 404")) << path;
  EXPECT_THAT(ask("/image/3.jpg"), HasSubstr("JPEG"));
  EXPECT_THAT(ask("/frames.json?from=5&count=100000"), HasSubstr(R"("asked":[5,600])")) << "answers are bounded";
}

TEST_F(ViewServer, AnswersGetAndHeadOnly) {
  EXPECT_THAT(ask("/", "", "HEAD"), AllOf(StartsWith("HTTP/1.1 200"), Not(HasSubstr("<html"))));
  for (const char* method : {"POST", "PUT", "DELETE", "PATCH", "OPTIONS"})
    EXPECT_THAT(ask("/", "", method), AllOf(StartsWith("HTTP/1.1 405"), HasSubstr("Allow: GET, HEAD"))) << method;
}

TEST_F(ViewServer, RefusesNamesThatAreNotItsOwn) {
  const auto asHost = [this](const std::string& host) {
    return answerTo(std::string("GET /run.json HTTP/1.1\r\nHost: ").append(host).append("\r\n\r\n"));
  };
  const std::string port = std::string(":").append(std::to_string(server_.port()));
  EXPECT_THAT(asHost(std::string("localhost").append(port)), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(asHost(std::string("LOCALHOST").append(port)), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(asHost(std::string("[::1]").append(port)), StartsWith("HTTP/1.1 200"));
  for (const std::string& host : {std::string(), std::string("rebound.example").append(port), std::string("localhost"),
                                  std::string("127.0.0.1:1"), std::string("127.0.0.1.rebound.example").append(port),
                                  std::string("10.0.0.1").append(port)})
    EXPECT_THAT(asHost(host), StartsWith("HTTP/1.1 403")) << host;
}

TEST_F(ViewServer, RefusesPagesOfOtherSites) {
  EXPECT_THAT(ask("/run.json", "Origin: http://" + own() + "\r\n"), StartsWith("HTTP/1.1 200"));
  for (const char* origin : {"http://other.example", "null", "https://127.0.0.1", "http://127.0.0.1:1"})
    EXPECT_THAT(ask("/run.json", std::string("Origin: ") + origin + "\r\n"), StartsWith("HTTP/1.1 403")) << origin;
  EXPECT_THAT(ask("/run.json", "Sec-Fetch-Site: same-origin\r\n"), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(ask("/run.json", "Sec-Fetch-Site: cross-site\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("/", "Sec-Fetch-Site: cross-site\r\n"), StartsWith("HTTP/1.1 200")) << "a link leads to the page";
}

TEST_F(ViewServer, TakesControlCallsFromItsOwnPageOnly) {
  EXPECT_THAT(ask("/control/pause"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("/control/pause?token=0123"), StartsWith("HTTP/1.1 403"));
  EXPECT_THAT(ask("/control/pause?token=" + token(), "", "HEAD"), StartsWith("HTTP/1.1 405"));
  EXPECT_THAT(ask("/control/pause?token=" + token(), "Sec-Fetch-Site: cross-site\r\n"), StartsWith("HTTP/1.1 403"));
  EXPECT_TRUE(source_.actions.empty());
  EXPECT_THAT(ask("/control/pause?token=" + token()), StartsWith("HTTP/1.1 200"));
  EXPECT_THAT(source_.actions, testing::ElementsAre("pause"));
}

TEST_F(ViewServer, NoAnswerHoldsTheToken) {
  EXPECT_EQ(token().size(), 32);
  EXPECT_EQ(server_.controlUrl(), server_.url() + "#token=" + token()) << "behind #, which browsers send to nobody";
  for (const char* path : {"/", "/run.json", "/page.js", "/run_data.js", "/metrics", "/frames.json", "/frame/3.json",
                           "/overview.json", "/control/pause", "/control/pause?token=", "/nothing"})
    EXPECT_THAT(ask(path), Not(HasSubstr(token()))) << path;
  const PageServer other({.host = "127.0.0.1", .port = 0}, source_, viewers_);
  EXPECT_NE(other.controlUrl().substr(other.controlUrl().find('#')), "#token=" + token()) << "each run has its own";
}

TEST_F(ViewServer, ARunBesideAnotherAnswersBelowAPathOfItsOwn) {
  EXPECT_THAT(ask("/against/run.json"), AllOf(StartsWith("HTTP/1.1 404"), HasSubstr("--against")));
  EXPECT_THAT(ask("/overview.json"), StartsWith("HTTP/1.1 404")) << "of a run that is over alone";
  ToySource other;
  other.overview = R"({"frames":9})";
  source_.other = &other;
  EXPECT_THAT(ask("/against/run.json"), HasSubstr(R"("name":"toy")"));
  EXPECT_THAT(ask("/against/overview.json"), HasSubstr(R"({"frames":9})"));
  EXPECT_THAT(ask("/against/frames.json?from=2&count=3"), HasSubstr(R"("asked":[2,3])"));
  EXPECT_THAT(ask("/against/frame/3.json"), HasSubstr("{}"));
  EXPECT_THAT(ask("/against/frame/4.json"), StartsWith("HTTP/1.1 404"));
  source_.other = nullptr;
}

TEST_F(ViewServer, TellsANinthViewerThatAllPlacesAreTaken) {
  publish("first");
  std::vector<std::unique_ptr<Client>> clients;
  for (std::size_t i = 0; i < Viewers::kMost; ++i) {
    clients.push_back(viewer());
    EXPECT_THAT(clients.back()->hear("data: first\n\n"), HasSubstr("text/event-stream"));
  }
  EXPECT_THAT(ask("/events"), AllOf(StartsWith("HTTP/1.1 503"), HasSubstr("All 8 places are taken")));
  clients.pop_back();
  for (int i = 0; i < 100 && viewers_.count() == Viewers::kMost; ++i) {
    publish("next");  // only who writes notices that nobody reads
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_THAT(viewer()->hear("data: next\n\n"), HasSubstr("HTTP/1.1 200"));
}

TEST_F(ViewServer, AStalledViewerDelaysNobodyAndLosesItsPlace) {
  const auto stalled = viewer(), reader = viewer();
  for (int i = 0; i < 100 && viewers_.count() < 2; ++i) std::this_thread::sleep_for(20ms);
  const std::string large(1 << 20, 'x');
  publish(large);
  std::this_thread::sleep_for(200ms);  // both are being told, more than fits on the way
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 50; ++i) publish(large);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 1s) << "publishing waits for nobody";
  publish("last");
  EXPECT_THAT(reader->hear("data: last\n\n"), HasSubstr("data: last\n\n"));
  for (int i = 0; i < 100 && viewers_.count() == 2; ++i) std::this_thread::sleep_for(100ms);
  EXPECT_EQ(viewers_.count(), 1) << "what takes nothing for a second is dropped";
}

TEST_F(ViewServer, TheEndClosesAllAnswers) {
  const auto client = viewer();
  for (int i = 0; i < 100 && viewers_.count() < 1; ++i) std::this_thread::sleep_for(20ms);
  publish("the end");
  viewers_.close();
  EXPECT_THAT(client->hear(), HasSubstr("data: the end\n\n")) << "the last event comes, then the answer ends";
  EXPECT_THAT(ask("/events"), StartsWith("HTTP/1.1 503"));
}

TEST_F(ViewServer, ABusyPortIsNamedWithTheMend) {
  try {
    const PageServer second({.host = "127.0.0.1", .port = server_.port()}, source_, viewers_);
    FAIL() << "two servers at one port";
  } catch (const OutputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr(own()), HasSubstr("in use"), HasSubstr("choose another port")));
  }
}

}  // namespace
}  // namespace motorcade
