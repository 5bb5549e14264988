// SPDX-License-Identifier: BSD-3-Clause
// The page of a live run.
#pragma once

#include <headway/drivers/sensor_group.h>
#include <headway/map/perception_map.h>
#include <headway/pipeline/perception.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace headway::live {

/// Where page and health are served.
struct LivePageOptions {
  std::optional<int> port = 0;        ///< of the page; 0: any free port; nullopt: no page
  std::string address = "127.0.0.1";  ///< of the page's network interface
  std::optional<int> health_port = std::nullopt;  ///< of the health, on 127.0.0.1; 0: any free port
};

/// What the page shows of one frame, but for pictures.
struct LiveView {
  pipeline::PerceptionUpdate update;
  double arrival_s = 0.0;  ///< of its second image, by monotonicSeconds() [s]
  double latency_s = 0.0;  ///< from the arrival of the second image to the results
  double process_s = 0.0;  ///< of it in the pipeline
  std::size_t frames = 0;  ///< processed so far
  std::size_t dropped = 0;
  std::string left_out;  ///< because of the load; or empty
  Warnings warnings;
};

/// Asks for the state of all sensors, from any thread.
using SensorStates = std::function<std::vector<drivers::SensorStatus>()>;

/// What the page draws of one frame.
struct LivePictures {
  RecordedFrame frame;
  map::PerceptionMap map;
  double arrival_s = 0.0;  ///< as of a LiveView
};

/// Serves a page that shows a live run: image with tracks, map from above, latency and health; and
/// the health alone, for programs.
///
/// The page is updated by server-sent events, at most ten a second, and loads nothing from other
/// servers. Every text is escaped; a strict content security policy forbids everything else.
/// Requests must name the served address as their host, so that no other web site can read them
/// through the user's browser. On another address than 127.0.0.1 they need the token that url()
/// contains. Pictures are encoded by the server's thread, and only while a page is open. What
/// clients may take is limited by PageServer.
///
/// GET /health on the health's port needs no token: JSON with status, submap, age and latency of
/// the newest frame, sensors and warnings. 200 while the camera is tracked, in whichever submap,
/// and the newest frame's images came at most 1 s ago; else 503.
///
///     LivePage page({8080});
///     std::puts(page.url().c_str());
///     page.show(std::move(view));          // after each frame
///     page.draw({frame, map, arrival_s});  // after those for which there is time
class LivePage {
 public:
  /// @throws InputError if the address cannot be used or a port is taken
  explicit LivePage(const LivePageOptions& options);
  ~LivePage();  ///< as end()
  LivePage(const LivePage&) = delete;
  LivePage& operator=(const LivePage&) = delete;

  /// Address of the page, with the token if one is needed; empty without a page.
  [[nodiscard]] std::string url() const;
  [[nodiscard]] std::string healthUrl() const;  ///< empty without one

  /// Shows the sensors as they are when a client asks, with or without frames; empty: none. After
  /// it has returned, those of before are not asked any more.
  void watch(SensorStates sensors);
  /// Replaces the figures that are shown. Never waits for a browser.
  void show(LiveView view);
  /// Replaces the pictures likewise.
  void draw(LivePictures pictures);

  /// Ends all connections at once; nothing is served any more.
  void end();

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::live
