// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fcntl.h>
#include <headway_test/folders.h>
#include <headway_test/process.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace headway::test {

inline bool hasBrowser() { return runProcess("command -v chromium").status == 0; }

/// Chromium without a window, driven by its DevTools protocol over a pipe: pages are opened,
/// clicked and looked at as by a user. Ended by the destructor.
class PageBrowser {
 public:
  PageBrowser(int width, int height, const std::string& more_options = "") {
    std::array<int, 2> to_browser{}, from_browser{};
    if (pipe(to_browser.data()) != 0 || pipe(from_browser.data()) != 0) fail("no pipe");
    const std::string command =
        "exec chromium --headless=new --no-sandbox --disable-gpu --enable-unsafe-swiftshader "
        "--hide-scrollbars --remote-debugging-pipe --user-data-dir=" +
        (folder_ / "profile").string() + " " + more_options + " about:blank >/dev/null 2>&1";
    process_ = fork();
    if (process_ == 0) {
      const int input = fcntl(to_browser[0], F_DUPFD, 10);
      const int output = fcntl(from_browser[1], F_DUPFD, 10);
      dup2(input, 3);  // the ends that chromium reads and writes
      dup2(output, 4);
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    close(to_browser[0]);
    close(from_browser[1]);
    write_ = to_browser[1];
    read_ = from_browser[0];
    for (const int end : {write_, read_}) fcntl(end, F_SETFD, FD_CLOEXEC);
    attach(width, height);
  }
  ~PageBrowser() {
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    close(write_);
    close(read_);
  }
  PageBrowser(const PageBrowser&) = delete;
  PageBrowser& operator=(const PageBrowser&) = delete;

  void open(const std::string& url) { command("Page.navigate", {{"url", url}}); }

  /// Value of an expression in the page; null if it fails.
  nlohmann::json evaluate(const std::string& expression) {
    const auto result =
        command("Runtime.evaluate",
                {{"expression", expression}, {"returnByValue", true}, {"awaitPromise", true}});
    if (result.contains("exceptionDetails")) return nullptr;
    return result.at("result").value("value", nlohmann::json());
  }

  /// Waits up to 60 s until an expression is true.
  bool waitFor(const std::string& expression) {
    for (int i = 0; i < 600; ++i) {
      if (evaluate("Boolean(" + expression + ")") == true) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
  }

  void click(double x, double y) {
    for (const char* type : {"mousePressed", "mouseReleased"}) {
      command("Input.dispatchMouseEvent",
              {{"type", type}, {"x", x}, {"y", y}, {"button", "left"}, {"clickCount", 1}});
    }
  }

  void press(const std::string& key) {
    for (const char* type : {"keyDown", "keyUp"}) {
      command("Input.dispatchKeyEvent", {{"type", type}, {"key", key}});
    }
  }

  /// The page as a PNG file in base 64.
  std::string screenshot() {
    return command("Page.captureScreenshot", {{"format", "png"}}).at("data");
  }

  /// Errors and warnings of the page's console, without those about the browser's renderer.
  [[nodiscard]] const std::vector<std::string>& messages() const { return messages_; }

  nlohmann::json command(const std::string& method, nlohmann::json params) {
    nlohmann::json message = {{"id", ++sent_}, {"method", method}, {"params", std::move(params)}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t done = 0; done < text.size();) {
      const auto written = write(write_, text.data() + done, text.size() - done);
      if (written <= 0) fail("chromium does not listen");
      done += static_cast<std::size_t>(written);
    }
    while (true) {
      auto answer = receive();
      if (answer.value("id", 0) == sent_) {
        if (answer.contains("error")) fail(method + ": " + answer["error"].dump());
        return answer.at("result");
      }
      keep(answer);
    }
  }

 private:
  [[noreturn]] static void fail(const std::string& what) { throw std::runtime_error(what); }

  /// Selects the page, which exists a little after the browser.
  void attach(int width, int height) {
    for (int i = 0; i < 100 && session_.empty(); ++i) {
      const auto targets = command("Target.getTargets", nlohmann::json::object())["targetInfos"];
      for (const auto& target : targets) {
        if (target["type"] != "page" || !session_.empty()) continue;
        session_ = command("Target.attachToTarget",
                           {{"targetId", target["targetId"]}, {"flatten", true}})["sessionId"];
      }
      if (session_.empty()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    if (session_.empty()) fail("chromium has no page");
    for (const char* domain : {"Runtime", "Log", "Page"}) {
      command(std::string(domain) + ".enable", nlohmann::json::object());
    }
    command("Emulation.setDeviceMetricsOverride",
            {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
    setTheme("dark");
  }

 public:
  void setTheme(const std::string& theme) {
    command("Emulation.setEmulatedMedia",
            {{"features", {{{"name", "prefers-color-scheme"}, {"value", theme}}}}});
  }

 private:
  nlohmann::json receive() {
    std::size_t end = 0;
    while ((end = received_.find('\0')) == std::string::npos) {
      std::array<char, 65536> bytes{};
      const auto count = read(read_, bytes.data(), bytes.size());
      if (count <= 0) fail("chromium has ended");
      received_.append(bytes.data(), static_cast<std::size_t>(count));
    }
    auto message = nlohmann::json::parse(received_.substr(0, end));
    received_.erase(0, end + 1);
    return message;
  }

  void keep(const nlohmann::json& event) {
    const std::string method = event.value("method", "");
    if (method == "Runtime.exceptionThrown" || method == "Runtime.consoleAPICalled") {
      messages_.push_back(event["params"].dump());
    } else if (method == "Log.entryAdded") {
      const auto& entry = event["params"]["entry"];
      if (entry["source"] != "rendering") messages_.push_back(entry.dump());
    }
  }

  TemporaryFolder folder_;
  pid_t process_ = 0;
  int write_ = -1, read_ = -1;
  int sent_ = 0;
  std::string session_, received_;
  std::vector<std::string> messages_;
};

}  // namespace headway::test
