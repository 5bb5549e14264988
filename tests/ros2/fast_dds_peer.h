// SPDX-License-Identifier: BSD-3-Clause
// A participant of another implementation of DDS, on the loopback alone: Fast DDS.
#pragma once

#include <cstdint>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ros2_messagesPubSubTypes.h"

namespace headway::test {

/// Quality of service of a writer or reader of the peer.
struct PeerQos {
  bool is_reliable = true;
  bool is_transient_local = false;
  int depth = 10;
};

/// Publishes and subscribes as a robot's programs would, with types that fastddsgen made.
///
///     FastDdsPeer peer(domain);
///     auto scan = peer.writer<sensor_msgs::msg::dds_::LaserScan_PubSubType>("rt/scan");
///     scan->write(&message);
class FastDdsPeer {
 public:
  class Writer {
   public:
    virtual ~Writer() = default;
    virtual bool write(void* sample) = 0;
    [[nodiscard]] virtual int matched() const = 0;
  };
  class Reader {
   public:
    virtual ~Reader() = default;
    [[nodiscard]] virtual int matched() const = 0;
  };

  explicit FastDdsPeer(int domain);
  ~FastDdsPeer();
  FastDdsPeer(const FastDdsPeer&) = delete;
  FastDdsPeer& operator=(const FastDdsPeer&) = delete;

  template <typename PubSubType>
  std::unique_ptr<Writer> writer(const std::string& topic, const PeerQos& qos = {}) {
    return makeWriter(topic, new PubSubType, qos);
  }
  /// Calls back in a thread of Fast DDS.
  template <typename PubSubType>
  std::unique_ptr<Reader> reader(const std::string& topic, const PeerQos& qos,
                                 std::function<void(const typename PubSubType::type&)> receive) {
    return makeReader(topic, new PubSubType, qos, [receive](const void* sample) {
      receive(*static_cast<const typename PubSubType::type*>(sample));
    });
  }
  /// A writer of any bytes under a type's name: its samples are std::string, with encapsulation.
  std::unique_ptr<Writer> bytesWriter(const std::string& topic, const std::string& type,
                                      const PeerQos& qos = {});
  /// Messages of any type as they came.
  std::unique_ptr<Reader> bytesReader(const std::string& topic, const std::string& type,
                                      const PeerQos& qos,
                                      std::function<void(const std::string&)> receive);

 private:
  using Receive = std::function<void(const void*)>;
  std::unique_ptr<Writer> makeWriter(const std::string& topic,
                                     eprosima::fastdds::dds::TopicDataType* type,
                                     const PeerQos& qos);
  std::unique_ptr<Reader> makeReader(const std::string& topic,
                                     eprosima::fastdds::dds::TopicDataType* type,
                                     const PeerQos& qos, Receive receive);
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// A domain for this process alone, among tests that run at once.
[[nodiscard]] int domainOfThisTest();

/// Whether the system gives sockets less than 16 MB to receive, asked for with one.
[[nodiscard]] bool hasSmallReceiveBuffers();

}  // namespace headway::test
