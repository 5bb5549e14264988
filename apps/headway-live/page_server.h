// SPDX-License-Identifier: BSD-3-Clause
// The server of a live run's page: GET requests and event streams, within limits that no client
// exceeds.
#pragma once

#include <functional>
#include <memory>
#include <string>

namespace headway::live {

/// An answer to a request.
struct Answer {
  int status = 200;
  std::string type = "text/plain";
  std::shared_ptr<const std::string> content = nullptr;  ///< null: none
  std::string cookie = "";                               ///< to set; empty: none
};

/// Answers GET requests that name its address as their host and have its token, if there is one.
///
/// Whatever clients do, it has at most 16 connections, of which 4 are event streams; the answer to
/// others is 503. A connection is one request: 8 kB of header and no body, which takes 2 s at most,
/// as does each write. Of more than 16 connections the one whose request has been incomplete for
/// longest is refused, so that slow clients do not shut out others. A quarter of the process's
/// descriptors is left to files. One thread serves all; handlers are called by it, and one that
/// throws costs its request alone (500) or its stream.
///
///     PageServer server("127.0.0.1", "");
///     server.get("/health", [] { return Answer{200, "text/plain", text}; });
///     server.start(8080, "--health");
class PageServer {
 public:
  using Handler = std::function<Answer()>;
  /// The next event of a stream, asked for every 20 ms; empty: there is none yet.
  using NextEvent = std::function<std::string()>;

  /// @param token  empty: none is needed
  PageServer(std::string address, std::string token);
  ~PageServer();  ///< as end()
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  void get(const std::string& path, Handler handler);
  void get(const std::string& path, const std::string& text, const std::string& type);
  /// Server-sent events; `begin` is called for each stream.
  void stream(const std::string& path, std::function<NextEvent()> begin);

  /// @param port    0: any free one
  /// @param option  of the command line, for the error
  /// @throws InputError if the address cannot be used or the port is taken
  void start(int port, const std::string& option);

  /// Ends all connections at once. Waits for a handler that is called just then.
  void end();

  /// Address, with the token if one is needed.
  [[nodiscard]] std::string url() const;
  /// The cookie that carries the token; empty without one.
  [[nodiscard]] std::string cookie() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::live
