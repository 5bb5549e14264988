// SPDX-License-Identifier: BSD-3-Clause
// The page of a live run.
#pragma once

#include <headway/drivers/sensor_group.h>
#include <headway/map/perception_map.h>
#include <headway/pipeline/perception.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::live {

/// Where the page is served.
struct LivePageOptions {
  int port = 0;                       ///< 0: any free port
  std::string address = "127.0.0.1";  ///< of the network interface
};

/// What the page shows of one frame.
struct LiveView {
  RecordedFrame frame;
  pipeline::PerceptionUpdate update;
  map::PerceptionMap map;
  double latency_s = 0.0;  ///< from the arrival of the second image to the results
  double process_s = 0.0;  ///< of it in the pipeline
  std::size_t frames = 0;  ///< processed so far
  std::size_t dropped = 0;
  std::vector<drivers::SensorStatus> sensors;
  Warnings warnings;
};

/// Serves a page that shows a live run: image with tracks, map from above, latency and health.
///
/// The page is updated by server-sent events, at most ten a second, and loads nothing from other
/// servers. Every text is escaped; a strict content security policy forbids everything else.
/// Requests must name the served address as their host, so that no other web site can read them
/// through the user's browser. On another address than 127.0.0.1 they need the token that url()
/// contains. Pictures are encoded by the server's threads, and only while a page is open.
///
///     LivePage page({8080});
///     std::puts(page.url().c_str());
///     page.show(std::move(view));  // after each frame
class LivePage {
 public:
  /// @throws InputError if the address cannot be used or the port is taken
  explicit LivePage(const LivePageOptions& options);
  ~LivePage();  ///< ends all connections
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// Address of the page, with the token if one is needed.
  [[nodiscard]] const std::string& url() const;

  /// Replaces what is shown. Never waits for a browser.
  void show(LiveView view);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::live
