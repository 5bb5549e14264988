// SPDX-License-Identifier: BSD-3-Clause
// A participant of a ROS 2 domain: which topics others publish, and serialised messages of them and
// to them.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace headway::ros2 {

/// Name and network of a node.
struct NodeOptions {
  std::string name = "headway";
  int domain = -1;        ///< negative: ROS_DOMAIN_ID, or 0
  std::string interface;  ///< name or address of the only one; empty: as ROS 2 with Cyclone DDS
};

/// Quality of service of a subscription or publication, as ROS 2 names it.
struct Qos {
  bool is_reliable = true;
  bool is_transient_local = false;  ///< the newest messages are sent to those that come later, too
  int depth = 10;                   ///< messages that are kept
};

/// A topic that others publish.
struct PublishedTopic {
  std::string name;  ///< "/scan"
  std::string type;  ///< "sensor_msgs/LaserScan"; as DDS names it, if it is none of ROS 2
  std::size_t publishers = 0;
  bool is_reliable = true;         ///< all publishers are
  bool is_transient_local = true;  ///< all publishers are
};

/// Messages to those who subscribe to a topic. A value that must not outlive its node.
class Publication {
 public:
  Publication() = default;
  /// Whether anybody subscribes; without subscribers nothing should be made to be published.
  [[nodiscard]] bool hasSubscribers() const;
  /// Sends a message without waiting: a subscriber that does not keep up misses all but the newest
  /// ones; others do not.
  ///
  /// @param message  as CDR, with its encapsulation
  /// @return         whether it was sent
  bool publish(std::string message) const;
  /// Waits until all subscribers have what was published before the call; false if one does not.
  [[nodiscard]] bool isTaken(double timeout_s) const;
  [[nodiscard]] const std::string& topic() const { return topic_; }

 private:
  friend class Node;
  std::string topic_;
  int writer_ = 0;
  const void* type_ = nullptr;
};

/// A node of ROS 2 without ROS 2: a participant of its DDS domain, with the names of topics and
/// types, the quality of service, and the announcement (`ros2 node list`) that ROS 2 has.
///
/// Messages are bytes: they are copied when they arrive, and not decoded. Those of more than 128 MB
/// are never put together, those of 1.3 MB, unless of images or clouds, not kept. Each kind of what
/// Cyclone DDS drops is named on the standard error once, then counted. ROS_DOMAIN_ID,
/// ROS_LOCALHOST_ONLY and ROS_AUTOMATIC_DISCOVERY_RANGE are respected, CYCLONEDDS_URI without a
/// restriction to an interface, which it could widen. One thread at a time may use a node, apart
/// from its publications, which any threads may use. The nodes of a program share a domain's
/// settings.
///
///     Node node({});
///     node.subscribe("/scan", "sensor_msgs/LaserScan", {}, [](std::string_view cdr) { ... });
///     while (runs) node.spin(0.1);
class Node {
 public:
  using Receive = std::function<void(std::string_view message)>;

  /// @throws InputError if the domain cannot be joined, there is no such interface, or another node
  ///         of the program has joined the domain on another one
  explicit Node(const NodeOptions& options);
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Domain and interfaces, in one line.
  [[nodiscard]] const std::string& network() const;
  /// Why large messages are lost on this computer, with the command that helps; empty: they are
  /// not.
  [[nodiscard]] std::string bufferHint() const;
  /// The topics that others publish now.
  [[nodiscard]] std::vector<PublishedTopic> published();

  /// Calls back with each message of a topic. The callback may subscribe and unsubscribe.
  ///
  /// @param type  "sensor_msgs/LaserScan"
  void subscribe(const std::string& topic, const std::string& type, const Qos& qos,
                 Receive receive);
  /// Reads a topic that is subscribed to with another quality of service, too, for publishers that
  /// the first one does not match. Messages that match both come twice.
  void widen(const std::string& topic, const Qos& qos);
  void unsubscribe(const std::string& topic);
  /// Publishers that do not match the newest quality of service of a subscription, so far.
  [[nodiscard]] std::size_t mismatches(const std::string& topic) const;
  [[nodiscard]] Publication advertise(const std::string& topic, const std::string& type,
                                      const Qos& qos);

  /// Waits for messages and passes on those that have come, of each topic at most as many as are
  /// kept.
  void spin(double timeout_s);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace headway::ros2
