// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

namespace headway::test {

/// A TCP connection to a server on this computer, which sends and receives as it is told.
class Connection {
 public:
  Connection(const std::string& address, int port) : file_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(static_cast<std::uint16_t>(port));
    inet_pton(AF_INET, address.c_str(), &place.sin_addr);
    if (connect(file_, reinterpret_cast<const sockaddr*>(&place), sizeof place) != 0) {
      close(file_);
      throw std::runtime_error("no connection to port " + std::to_string(port));
    }
  }
  Connection(Connection&& other) noexcept : file_(std::exchange(other.file_, -1)) {}
  ~Connection() {
    if (file_ >= 0) close(file_);
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  Connection& operator=(Connection&&) = delete;

  /// @return false if the server does not accept it within a second, or has closed
  bool send(const std::string& text) {
    for (std::size_t done = 0; done < text.size();) {
      if (!isReady(POLLOUT, 1000)) return false;
      const auto count =
          ::send(file_, text.data() + done, text.size() - done, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  /// What comes within a time; nullopt: nothing yet; empty: the server has closed.
  std::optional<std::string> receive(int wait_ms) {
    if (!isReady(POLLIN, wait_ms)) return std::nullopt;
    std::array<char, 65536> bytes{};
    const auto count = recv(file_, bytes.data(), bytes.size(), 0);
    return std::string(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  }

  /// Waits for the server to close; what it sent.
  std::string receiveAll(int wait_ms = 10000) {
    std::string all;
    for (auto part = receive(wait_ms); part && !part->empty(); part = receive(wait_ms))
      all += *part;
    return all;
  }

 private:
  [[nodiscard]] bool isReady(short events, int wait_ms) const {
    pollfd ready{file_, events, 0};
    return poll(&ready, 1, wait_ms) > 0;
  }

  int file_;
};

struct HttpResponse {
  int status = 0;  ///< 0: none came
  std::string header;
  std::string body;

  /// Value of a header's field; empty without it.
  [[nodiscard]] std::string field(const std::string& name) const {
    const auto begin = header.find("\r\n" + name + ": ");
    if (begin == std::string::npos) return "";
    const auto first = begin + name.size() + 4;
    return header.substr(first, header.find("\r\n", first) - first);
  }
};

/// A response's parts.
inline HttpResponse parseResponse(const std::string& text) {
  const auto end = text.find("\r\n\r\n");
  if (end == std::string::npos || text.rfind("HTTP/1.1 ", 0) != 0) return {};
  return {std::atoi(text.c_str() + 9), text.substr(0, end + 2), text.substr(end + 4)};
}

/// A request without a body. @param host  of the header; empty: address and port
inline std::string httpRequest(const std::string& target, const std::string& host,
                               const std::string& more_fields = "",
                               const std::string& method = "GET") {
  return method + " " + target + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n" +
         more_fields + "\r\n";
}

/// Gets a page of a server on this computer. @param more_fields  lines of the header
inline HttpResponse httpGet(const std::string& address, int port, const std::string& target,
                            const std::string& more_fields = "", const std::string& host = "") {
  Connection connection(address, port);
  const std::string named = host.empty() ? address + ":" + std::to_string(port) : host;
  if (!connection.send(httpRequest(target, named, more_fields))) return {};
  std::string text;
  HttpResponse response;
  while (response.status == 0 ||
         response.body.size() < std::stoul("0" + response.field("Content-Length"))) {
    const auto part = connection.receive(10000);
    if (!part || part->empty()) break;
    response = parseResponse(text += *part);
  }
  return response;
}

}  // namespace headway::test
