// SPDX-License-Identifier: BSD-3-Clause
// Clients that try to hurt the server of a live run's page.
#include "page_server.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <headway/core/recorded_frame.h>
#include <headway_test/http_client.h>
#include <headway_test/peak_memory.h>
#include <headway_test/waiting.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <iterator>
#include <list>
#include <optional>
#include <vector>

namespace headway::live {
namespace {

using test::Connection;
using ::testing::StartsWith;

constexpr const char* kSlow = "GET / HTTP/1.1\r\nX: ";  // a header that is not complete yet

std::size_t openFiles() {
  const std::filesystem::directory_iterator files("/proc/self/fd");
  return static_cast<std::size_t>(std::distance(begin(files), end(files)));
}

/// A page, pictures that are too large for the buffers of the system, and a stream of numbers.
class PageServerTest : public ::testing::Test {
 protected:
  PageServerTest() {
    server_->get("/", "a page", "text/html");
    server_->get("/picture", std::string(30'000'000, 'x'), "image/png");
    server_->stream("/events",
                    [] { return [n = 0]() mutable { return std::to_string(n++) + "\n"; }; });
    server_->get("/broken", []() -> Answer { throw std::runtime_error("no memory"); });
    server_->stream("/broken_events",
                    [] { return []() -> std::string { throw std::runtime_error("no memory"); }; });
    server_->start(0, "--show");
    const std::string url = server_->url();
    port_ = std::stoi(url.substr(url.rfind(':') + 1));
    host_ = "127.0.0.1:" + std::to_string(port_);
    memory_.emplace();
  }
  ~PageServerTest() override { EXPECT_LE(memory_->growthMb(), 20.0); }

  [[nodiscard]] Connection connect() const { return {"127.0.0.1", port_}; }
  [[nodiscard]] int statusOf(const std::string& path) const {
    return test::httpGet("127.0.0.1", port_, path).status;
  }
  /// Sends a request and receives the whole answer.
  [[nodiscard]] int statusOfRequest(const std::string& request) const {
    Connection client = connect();
    client.send(request);
    return test::parseResponse(client.receiveAll()).status;
  }
  [[nodiscard]] Connection openStream() const {
    Connection client = connect();
    client.send(test::httpRequest("/events", host_));
    return client;
  }
  [[nodiscard]] static std::string firstOf(Connection& client) {
    return client.receive(5000).value_or("nothing");
  }
  /// Clients that have sent part of a request.
  [[nodiscard]] std::list<Connection> slowClients(int count) const {
    std::list<Connection> clients;
    for (int i = 0; i < count; ++i) clients.push_back(connect());
    for (auto& client : clients) client.send(kSlow);
    return clients;
  }

  std::optional<PageServer> server_{std::in_place, "127.0.0.1", ""};
  int port_ = 0;
  std::string host_;
  std::optional<test::PeakMemory> memory_;
};

TEST_F(PageServerTest, AClientHasTwoSecondsForItsRequestHoweverItSendsIt) {
  Connection client = connect(), silent = connect();
  const double begin_s = monotonicSeconds();
  client.send(kSlow);
  std::optional<std::string> end;
  while (!end && monotonicSeconds() < begin_s + 10.0) {
    client.send("x");
    end = client.receive(200);
  }
  EXPECT_EQ("", end.value_or("open"));
  EXPECT_NEAR(2.0, monotonicSeconds() - begin_s, 0.5);
  EXPECT_EQ("", silent.receiveAll(500));
  EXPECT_EQ(200, statusOf("/"));
}

TEST_F(PageServerTest, AHeaderHasEightKilobytes) {
  EXPECT_EQ(
      200, statusOfRequest(test::httpRequest("/", host_, "X: " + std::string(8000, 'x') + "\r\n")));
  EXPECT_EQ(
      431, statusOfRequest(test::httpRequest("/", host_, "X: " + std::string(8200, 'x') + "\r\n")));
  Connection client = connect();
  const std::string line = "X: " + std::string(60000, 'x') + "\r\n";
  const double begin_s = monotonicSeconds();
  bool is_open = client.send("GET / HTTP/1.1\r\n");
  for (int i = 0; i < 1000 && is_open; ++i) is_open = client.send(line);
  EXPECT_LT(monotonicSeconds() - begin_s, 3.0);
  EXPECT_EQ(200, statusOf("/"));
}

TEST_F(PageServerTest, HostComesFirstAndABodyIsNotRead) {
  const std::string body = "Content-Length: 1000000000\r\n";
  EXPECT_EQ(403, statusOfRequest(test::httpRequest("/", "evil.example", body, "POST")));
  EXPECT_EQ(403, statusOfRequest("GET / HTTP/1.0\r\n\r\n"));
  EXPECT_EQ(405, statusOfRequest(test::httpRequest("/", host_, body, "POST")));
  EXPECT_EQ(413, statusOfRequest(test::httpRequest("/", host_, body)));
  EXPECT_EQ(413, statusOfRequest(test::httpRequest("/", host_, "Transfer-Encoding: chunked\r\n")));
  Connection sender = connect();
  sender.send(test::httpRequest("/", host_, "Content-Length: 60000000\r\n", "POST"));
  const std::string part(60000, 'x');
  const double begin_s = monotonicSeconds();
  bool is_open = true;
  for (int i = 0; i < 1000 && is_open; ++i) is_open = sender.send(part);
  EXPECT_LT(monotonicSeconds() - begin_s, 3.0);
  EXPECT_EQ("", [&] {
    Connection client = connect();
    client.send("\x16\x03\x01 nonsense\r\n\r\n");
    return client.receiveAll();
  }());
}

TEST_F(PageServerTest, WhatFailsToAnswerCostsItsRequestAlone) {
  EXPECT_EQ(500, statusOf("/broken"));
  EXPECT_EQ(200, statusOf("/broken_events")) << "the stream ends after its header";
  EXPECT_EQ(200, statusOf("/"));
}

TEST_F(PageServerTest, AStreamThatIsNotReadIsClosed) {
  std::list<Connection> streams;
  for (int i = 0; i < 4; ++i) streams.push_back(openStream());
  EXPECT_TRUE(test::waitUntil([&] { return statusOf("/events") == 503; }));
  EXPECT_TRUE(test::waitUntil([&] {
    Connection stream = openStream();
    return firstOf(stream).rfind("HTTP/1.1 200", 0) == 0;
  })) << "a place is free again";
}

TEST_F(PageServerTest, SlowClientsDoNotShutOutOthers) {
  std::list<Connection> slow = slowClients(40);
  EXPECT_EQ(200, statusOf("/"));
  EXPECT_THAT(firstOf(slow.front()), StartsWith("HTTP/1.1 503 Service Unavailable"));
  EXPECT_EQ(std::nullopt, slow.back().receive(0)) << "has its two seconds";
}

TEST_F(PageServerTest, FourStreamsAndSixteenConnectionsAreServed) {
  std::list<Connection> streams;
  for (int i = 0; i < 4; ++i) {
    streams.push_back(openStream());
    EXPECT_THAT(firstOf(streams.back()), StartsWith("HTTP/1.1 200"));
  }
  EXPECT_EQ(503, statusOf("/events"));
  EXPECT_EQ(200, statusOf("/"));
  const std::size_t files = openFiles() - streams.size();
  const std::list<Connection> slow = slowClients(200);
  EXPECT_EQ(200, statusOf("/"));
  EXPECT_LE(openFiles() - streams.size() - slow.size() - files, 12u);
  streams.pop_front();
  EXPECT_TRUE(test::waitUntil([&] {
    Connection stream = openStream();
    return firstOf(stream).rfind("HTTP/1.1 200", 0) == 0;
  })) << "a place is free again";
}

TEST_F(PageServerTest, ClientsThatDoNotReadAreClosed) {
  std::list<Connection> clients;
  for (int i = 0; i < 16; ++i) {
    clients.push_back(connect());
    clients.back().send(test::httpRequest("/picture", host_));
  }
  const double begin_s = monotonicSeconds();
  EXPECT_TRUE(test::waitUntil([&] { return statusOf("/") == 503; })) << "all 16 get an answer";
  EXPECT_TRUE(test::waitUntil([&] { return statusOf("/") == 200; }));
  EXPECT_NEAR(2.0, monotonicSeconds() - begin_s, 0.5);
  EXPECT_LT(clients.front().receiveAll().size(), 30'000'000u);
}

TEST_F(PageServerTest, EndsWithinHalfASecondWhateverIsOpen) {
  std::list<Connection> clients = slowClients(5);
  clients.push_back(connect());
  clients.push_back(openStream());
  EXPECT_THAT(firstOf(clients.back()), StartsWith("HTTP/1.1 200"));
  clients.push_back(connect());
  clients.back().send(test::httpRequest("/picture", host_));
  const double begin_s = monotonicSeconds();
  server_->end();
  for (auto& client : clients) (void)client.receiveAll(500);
  EXPECT_LT(monotonicSeconds() - begin_s, 0.5);
  EXPECT_THROW(connect(), std::runtime_error);
}

TEST_F(PageServerTest, LeavesAQuarterOfTheDescriptorsToFiles) {
  rlimit limit{};
  ASSERT_EQ(0, getrlimit(RLIMIT_NOFILE, &limit));
  const rlimit low{256, limit.rlim_max};
  ASSERT_EQ(0, setrlimit(RLIMIT_NOFILE, &low));
  std::vector<int> files;
  while (files.empty() || files.back() < 192) files.push_back(open("/dev/null", O_RDONLY));
  EXPECT_EQ(503, statusOf("/"));
  const std::list<Connection> slow = slowClients(30);
  const int file = open("/dev/null", O_RDONLY);
  EXPECT_GE(file, 0);
  close(file);
  for (const int opened : files) close(opened);
  EXPECT_EQ(200, statusOf("/"));
  ASSERT_EQ(0, setrlimit(RLIMIT_NOFILE, &limit));
}

}  // namespace
}  // namespace headway::live
