// SPDX-License-Identifier: BSD-3-Clause
// The server of a live run's page: GET requests and event streams, within limits that no client
// exceeds.
#include "page_server.h"

#include <headway/core/error.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <boost/asio.hpp>
#include <boost/beast/core/flat_static_buffer.hpp>
#include <boost/beast/http.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <list>
#include <map>
#include <random>
#include <thread>
#include <utility>

namespace headway::live {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Parser = http::request_parser<http::empty_body>;
using std::chrono::milliseconds;

/// What clients may take; a page and its pictures need less by far.
struct ServerLimits {
  std::size_t connections = 16;
  int streams = 4;                              ///< of these
  milliseconds wait = std::chrono::seconds(2);  ///< for a request, and for each write
  milliseconds event_interval{20};              ///< between two questions for an event
};
constexpr ServerLimits kServer;
constexpr std::size_t kMaxHeader = 8192;  // the usual limit of web servers [bytes]
constexpr const char* kTokenCookie = "headway_token";
constexpr const char* kSecurityHeaders =
    "Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; "
    "img-src 'self' data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
    "frame-ancestors 'none'\r\n"
    "X-Content-Type-Options: nosniff\r\n"
    "Referrer-Policy: no-referrer\r\n"
    "Cross-Origin-Resource-Policy: same-origin\r\n"
    "Cache-Control: no-store\r\n"
    "Connection: close\r\n";

/// Compares without revealing by its duration where the first difference is.
bool isEqual(const std::string& a, const std::string& b) {
  unsigned char difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size() && i < b.size(); ++i) {
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  }
  return difference == 0;
}

/// Value of NAME=VALUE in a list; empty without it.
std::string valueIn(const std::string& list, char separator, const std::string& name) {
  std::size_t begin = 0;
  while (begin < list.size()) {
    const std::size_t end = std::min(list.find(separator, begin), list.size());
    const std::size_t first = std::min(list.find_first_not_of(' ', begin), end);
    const std::string part = list.substr(first, end - first);
    if (part.rfind(name + "=", 0) == 0) return part.substr(name.size() + 1);
    begin = end + 1;
  }
  return "";
}

std::string headerOf(const Answer& answer, bool has_length) {
  std::string text = "HTTP/1.1 " + std::to_string(answer.status) + " " +
                     http::obsolete_reason(http::int_to_status(answer.status)).to_string() +
                     "\r\nContent-Type: " + answer.type + "\r\n" + kSecurityHeaders;
  const std::size_t size = answer.content ? answer.content->size() : 0;
  if (has_length) text += "Content-Length: " + std::to_string(size) + "\r\n";
  if (!answer.cookie.empty()) text += "Set-Cookie: " + answer.cookie + "\r\n";
  return text + "\r\n";
}

Answer refusal(int status, const std::string& text) {
  return {status, "text/plain", std::make_shared<const std::string>(text + "\n")};
}

/// Whether so many descriptors are open that the rest is left to files: the least free number is
/// always given.
bool isReserved(int descriptor) {
  rlimit limit{};
  return getrlimit(RLIMIT_NOFILE, &limit) == 0 &&
         static_cast<rlim_t>(descriptor) >= limit.rlim_cur / 4 * 3;
}

}  // namespace

class PageServer::Implementation {
 public:
  Implementation(std::string address, std::string token)
      : address_(std::move(address)), token_(std::move(token)) {}

  void start(int port, const std::string& option);
  void end();
  [[nodiscard]] std::string authority() const {
    const bool is_ipv6 = address_.find(':') != std::string::npos;
    return (is_ipv6 ? "[" + address_ + "]" : address_) + ":" + std::to_string(port_);
  }
  [[nodiscard]] const std::string& token() const { return token_; }

  std::map<std::string, Handler> handlers;
  std::map<std::string, std::function<NextEvent()>> streams;

 private:
  /// A connection: receives a request, writes the answer or events, and waits for the client's end.
  struct Connection {
    explicit Connection(tcp::socket its_socket)
        : socket(std::move(its_socket)), timer(socket.get_executor()) {
      parser.skip(true);  // bodies: they are refused by their announcement
    }
    tcp::socket socket;
    asio::steady_timer timer;  ///< ends what takes too long; asks for events
    boost::beast::flat_static_buffer<kMaxHeader> received;
    Parser parser;
    Answer answer;
    std::string text;  ///< that is being written: header or event
    NextEvent next_event;
    bool is_writing = false;
  };
  using Shared = std::shared_ptr<Connection>;

  void serve();
  void accept();
  void add(tcp::socket socket);
  [[nodiscard]] bool refuseOldest();
  void receive(const Shared& connection);
  void respond(const Shared& connection);
  [[nodiscard]] bool isAdmitted(const Parser::value_type& request) const;
  [[nodiscard]] Answer answerTo(Connection& connection);
  void answer(Connection& connection);
  void finish(const Shared& connection);
  void drain(const Shared& connection);
  void watchStream(const Shared& connection);
  void sendNextEvent(const Shared& connection);
  void limitTime(const Shared& connection);
  void close(const Shared& connection);
  static void refuse(tcp::socket& socket);

  const std::string address_;
  const std::string token_;
  int port_ = 0;
  asio::io_context context_{1};
  tcp::acceptor acceptor_{context_};
  asio::steady_timer pause_{context_};
  std::list<Shared> connections_;  ///< the oldest first
  std::thread thread_;
};

void PageServer::Implementation::start(int port, const std::string& option) {
  try {
    const auto found = tcp::resolver(context_).resolve(
        address_, std::to_string(port), tcp::resolver::passive | tcp::resolver::numeric_service);
    const tcp::endpoint endpoint = found.begin()->endpoint();
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(tcp::acceptor::reuse_address(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
    port_ = acceptor_.local_endpoint().port();
  } catch (const boost::system::system_error& error) {
    throw InputError(option + ": " + address_ + ":" + std::to_string(port) +
                     " cannot be served; the port is taken, or no interface has this address (" +
                     error.code().message() + ")");
  }
  accept();
  thread_ = std::thread([this] { serve(); });
}

void PageServer::Implementation::end() {
  if (!thread_.joinable()) return;
  context_.stop();
  thread_.join();
  error_code ignored;
  acceptor_.close(ignored);
  for (const auto& connection : connections_) connection->socket.close(ignored);
  connections_.clear();
}

void PageServer::Implementation::serve() {
  for (;;) {
    try {
      context_.run();
      return;
    } catch (const std::exception&) {  // it ends what was done, not the robot's process
    }
  }
}

void PageServer::Implementation::accept() {
  acceptor_.async_accept([this](error_code error, tcp::socket socket) {
    if (!error) {
      try {
        add(std::move(socket));
      } catch (const std::exception&) {  // such as lack of memory: it costs this client alone
      }
      return accept();
    }
    // Without a free descriptor every try fails at once.
    pause_.expires_after(milliseconds(100));
    pause_.async_wait([this](error_code) { accept(); });
  });
}

void PageServer::Implementation::add(tcp::socket socket) {
  const bool is_full = connections_.size() >= kServer.connections && !refuseOldest();
  if (is_full || isReserved(socket.native_handle())) return refuse(socket);
  const auto connection = std::make_shared<Connection>(std::move(socket));
  connections_.push_back(connection);
  receive(connection);
}

/// Makes room among the connections that do not get an answer; false if all do.
bool PageServer::Implementation::refuseOldest() {
  const auto oldest = std::find_if(
      connections_.begin(), connections_.end(),
      [](const Shared& connection) { return !connection->is_writing && !connection->next_event; });
  if (oldest == connections_.end()) return false;
  if ((*oldest)->text.empty()) refuse((*oldest)->socket);
  close(*oldest);
  return true;
}

void PageServer::Implementation::refuse(tcp::socket& socket) {
  const Answer answer = refusal(503, "too many connections");
  const std::string text = headerOf(answer, true) + *answer.content;
  error_code ignored;
  socket.non_blocking(true, ignored);
  socket.send(asio::buffer(text), 0, ignored);  // fits into the empty buffer of the system
  socket.shutdown(tcp::socket::shutdown_both, ignored);
}

void PageServer::Implementation::receive(const Shared& connection) {
  limitTime(connection);
  const auto received = [this, connection](error_code error, std::size_t) {
    if (!connection->socket.is_open()) return;
    if (!error) {
      answer(*connection);
    } else if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      connection->answer = refusal(431, "the header is too long");
    } else {
      return close(connection);
    }
    respond(connection);
  };
  http::async_read_header(connection->socket, connection->received, connection->parser, received);
}

bool PageServer::Implementation::isAdmitted(const Parser::value_type& request) const {
  const std::string host = request[http::field::host].to_string();
  const std::string local = "localhost:" + std::to_string(port_);
  if (host != authority() && (address_ != "127.0.0.1" || host != local)) return false;
  if (token_.empty()) return true;
  const std::string target = request.target().to_string();
  const std::string given =
      valueIn(target.substr(std::min(target.find('?'), target.size() - 1) + 1), '&', "token");
  return isEqual(
      given.empty() ? valueIn(request[http::field::cookie].to_string(), ';', kTokenCookie) : given,
      token_);
}

Answer PageServer::Implementation::answerTo(Connection& connection) {
  const auto& request = connection.parser.get();
  if (!isAdmitted(request)) {
    return refusal(403, "forbidden: open the address that headway-live prints");
  }
  if (request.method() != http::verb::get) return refusal(405, "only GET is answered");
  if (connection.parser.chunked() || connection.parser.content_length().value_or(0) > 0) {
    return refusal(413, "a request has no body here");
  }
  const std::string target = request.target().to_string();
  const std::string path = target.substr(0, target.find('?'));
  if (const auto handler = handlers.find(path); handler != handlers.end()) {
    return handler->second();
  }
  const auto stream = streams.find(path);
  if (stream == streams.end()) return refusal(404, "not found");
  const auto open =
      std::count_if(connections_.begin(), connections_.end(),
                    [](const Shared& other) { return static_cast<bool>(other->next_event); });
  if (open >= kServer.streams) return refusal(503, "too many pages are open");
  connection.next_event = stream->second();
  return {200, "text/event-stream"};
}

/// A handler that fails costs its request alone.
void PageServer::Implementation::answer(Connection& connection) {
  try {
    connection.answer = answerTo(connection);
  } catch (const std::exception&) {
    connection.next_event = nullptr;
    connection.answer = refusal(500, "the answer could not be made");
  }
}

void PageServer::Implementation::respond(const Shared& connection) {
  limitTime(connection);
  connection->is_writing = true;
  connection->text = headerOf(connection->answer, !connection->next_event);
  const auto& content = connection->answer.content;
  const std::array<asio::const_buffer, 2> buffers = {
      asio::buffer(connection->text), content ? asio::buffer(*content) : asio::const_buffer()};
  asio::async_write(connection->socket, buffers, [this, connection](error_code error, std::size_t) {
    connection->is_writing = false;
    if (error || !connection->socket.is_open()) return close(connection);
    if (!connection->next_event) return finish(connection);
    watchStream(connection);
    sendNextEvent(connection);
  });
}

/// Closes when the client has, so that the answer to a request that is still sent is not lost.
void PageServer::Implementation::finish(const Shared& connection) {
  error_code ignored;
  connection->socket.shutdown(tcp::socket::shutdown_send, ignored);
  limitTime(connection);
  drain(connection);
}

void PageServer::Implementation::drain(const Shared& connection) {
  connection->received.clear();
  connection->socket.async_read_some(connection->received.prepare(kMaxHeader),
                                     [this, connection](error_code error, std::size_t) {
                                       if (error) return close(connection);
                                       drain(connection);
                                     });
}

/// A client that closes an event stream, or goes on to send, is closed.
void PageServer::Implementation::watchStream(const Shared& connection) {
  connection->received.clear();
  connection->socket.async_read_some(
      connection->received.prepare(1),
      [this, connection](error_code, std::size_t) { close(connection); });
}

void PageServer::Implementation::sendNextEvent(const Shared& connection) {
  if (!connection->socket.is_open()) return;
  try {
    connection->text = connection->next_event();
  } catch (const std::exception&) {
    return close(connection);
  }
  if (connection->text.empty()) {
    connection->timer.expires_after(kServer.event_interval);
    connection->timer.async_wait([this, connection](error_code error) {
      if (!error) sendNextEvent(connection);
    });
    return;
  }
  limitTime(connection);
  asio::async_write(connection->socket, asio::buffer(connection->text),
                    [this, connection](error_code error, std::size_t) {
                      if (error) return close(connection);
                      sendNextEvent(connection);
                    });
}

/// Closes the connection unless its timer is set anew before the time is over.
void PageServer::Implementation::limitTime(const Shared& connection) {
  connection->timer.expires_after(kServer.wait);
  connection->timer.async_wait([this, connection](error_code error) {
    const bool is_over = connection->timer.expiry() <= asio::steady_timer::clock_type::now();
    if (!error && is_over) close(connection);
  });
}

void PageServer::Implementation::close(const Shared& connection) {
  error_code ignored;
  connection->socket.close(ignored);
  connection->timer.cancel();
  connections_.remove(connection);
}

PageServer::PageServer(std::string address, std::string token)
    : implementation_(std::make_unique<Implementation>(std::move(address), std::move(token))) {}

PageServer::~PageServer() { implementation_->end(); }

void PageServer::get(const std::string& path, Handler handler) {
  implementation_->handlers[path] = std::move(handler);
}

void PageServer::get(const std::string& path, const std::string& text, const std::string& type) {
  get(path,
      [answer = Answer{200, type, std::make_shared<const std::string>(text)}] { return answer; });
}

void PageServer::stream(const std::string& path, std::function<NextEvent()> begin) {
  implementation_->streams[path] = std::move(begin);
}

void PageServer::start(int port, const std::string& option) {
  implementation_->start(port, option);
}

void PageServer::end() { implementation_->end(); }

std::string PageServer::url() const {
  const std::string& token = implementation_->token();
  return "http://" + implementation_->authority() + "/" + (token.empty() ? "" : "?token=" + token);
}

std::string PageServer::cookie() const {
  const std::string& token = implementation_->token();
  if (token.empty()) return "";
  return std::string(kTokenCookie) + "=" + token + "; HttpOnly; SameSite=Strict; Path=/";
}

}  // namespace headway::live
