// SPDX-License-Identifier: BSD-3-Clause
// A participant of another implementation of DDS, on the loopback alone: Fast DDS.
#include "fast_dds_peer.h"

#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/subscriber/qos/DataReaderQos.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <map>
#include <stdexcept>

/// Fast DDS 2.9 allocates and deletes samples of its own types by different sizes. Called where a
/// program has the address sanitizer, which chose the name.
extern "C" const char* __asan_default_options() {  // NOLINT
  return "new_delete_type_mismatch=0";
}

namespace headway::test {
namespace {

using namespace eprosima::fastdds::dds;
using eprosima::fastrtps::rtps::SerializedPayload_t;

/// A type that is its name alone.
class BytesType : public TopicDataType {
 public:
  explicit BytesType(const std::string& name) {
    setName(name.c_str());
    m_typeSize = 1 << 16;
    m_isGetKeyDefined = false;
  }
  bool serialize(void* data, SerializedPayload_t* payload) override {
    const auto& bytes = *static_cast<std::string*>(data);
    std::memcpy(payload->data, bytes.data(), bytes.size());
    payload->length = static_cast<std::uint32_t>(bytes.size());
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(SerializedPayload_t* payload, void* data) override {
    static_cast<std::string*>(data)->assign(reinterpret_cast<char*>(payload->data),
                                            payload->length);
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<std::uint32_t>(static_cast<std::string*>(data)->size()); };
  }
  void* createData() override { return new std::string; }
  void deleteData(void* data) override { delete static_cast<std::string*>(data); }
  bool getKey(void*, eprosima::fastrtps::rtps::InstanceHandle_t*, bool) override { return false; }
};

template <typename Pointer>
Pointer required(Pointer pointer, const std::string& what) {
  if (pointer == nullptr) throw std::runtime_error("Fast DDS: no " + what);
  return pointer;
}

template <typename EntityQos>
void apply(const PeerQos& qos, EntityQos& result) {
  result.reliability().kind =
      qos.is_reliable ? RELIABLE_RELIABILITY_QOS : BEST_EFFORT_RELIABILITY_QOS;
  result.durability().kind =
      qos.is_transient_local ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
  result.history().kind = KEEP_LAST_HISTORY_QOS;
  result.history().depth = qos.depth;
  result.endpoint().history_memory_policy =
      eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
}

class PeerWriter : public FastDdsPeer::Writer {
 public:
  PeerWriter(Publisher& publisher, DataWriter* writer) : publisher_(publisher), writer_(writer) {}
  ~PeerWriter() override { publisher_.delete_datawriter(writer_); }
  bool write(void* sample) override { return writer_->write(sample); }
  [[nodiscard]] int matched() const override {
    PublicationMatchedStatus status;
    writer_->get_publication_matched_status(status);
    return status.current_count;
  }

 private:
  Publisher& publisher_;
  DataWriter* writer_;
};

class PeerReader : public FastDdsPeer::Reader, private DataReaderListener {
 public:
  PeerReader(Subscriber& subscriber, Topic* topic, const PeerQos& qos,
             std::function<void(const void*)> receive, TypeSupport type)
      : subscriber_(subscriber),
        receive_(std::move(receive)),
        type_(std::move(type)),
        sample_(type_.create_data()) {
    DataReaderQos reader_qos = DATAREADER_QOS_DEFAULT;
    apply(qos, reader_qos);
    reader_ = required(subscriber.create_datareader(topic, reader_qos, this), "reader");
  }
  ~PeerReader() override {
    subscriber_.delete_datareader(reader_);
    type_.delete_data(sample_);
  }
  [[nodiscard]] int matched() const override {
    SubscriptionMatchedStatus status;
    reader_->get_subscription_matched_status(status);
    return status.current_count;
  }

 private:
  void on_data_available(DataReader* reader) override {
    SampleInfo info;
    while (reader->take_next_sample(sample_, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) receive_(sample_);
    }
  }

  Subscriber& subscriber_;
  std::function<void(const void*)> receive_;
  TypeSupport type_;
  void* sample_;
  DataReader* reader_ = nullptr;
};

}  // namespace

class FastDdsPeer::Implementation {
 public:
  explicit Implementation(int domain) {
    using eprosima::fastdds::rtps::UDPv4TransportDescriptor;
    DomainParticipantQos qos = PARTICIPANT_QOS_DEFAULT;
    const auto udp = std::make_shared<UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->maxInitialPeersRange = 10;
    qos.transport().use_builtin_transports = false;
    qos.transport().user_transports.push_back(udp);
    eprosima::fastrtps::rtps::Locator_t loopback;
    eprosima::fastrtps::rtps::IPLocator::setIPv4(loopback, "127.0.0.1");
    auto& builtin = qos.wire_protocol().builtin;
    builtin.metatrafficUnicastLocatorList.push_back(loopback);
    builtin.initialPeersList.push_back(loopback);
    builtin.discovery_config.leaseDuration = {20, 0};
    builtin.discovery_config.leaseDuration_announcementperiod = {0, 200'000'000};
    participant_ = required(
        DomainParticipantFactory::get_instance()->create_participant(domain, qos), "participant");
    publisher_ = required(participant_->create_publisher(PUBLISHER_QOS_DEFAULT), "publisher");
    subscriber_ = required(participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT), "subscriber");
  }
  ~Implementation() {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  Topic* topicOf(const std::string& name, const TypeSupport& type) {
    if (auto* known = participant_->lookup_topicdescription(name)) {
      return static_cast<Topic*>(known);
    }
    type.register_type(participant_);
    return required(participant_->create_topic(name, type.get_type_name(), TOPIC_QOS_DEFAULT),
                    "topic " + name);
  }
  Publisher& publisher() { return *publisher_; }
  Subscriber& subscriber() { return *subscriber_; }

 private:
  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
};

FastDdsPeer::FastDdsPeer(int domain) : implementation_(std::make_unique<Implementation>(domain)) {}

FastDdsPeer::~FastDdsPeer() = default;

std::unique_ptr<FastDdsPeer::Writer> FastDdsPeer::makeWriter(const std::string& topic,
                                                             TopicDataType* type,
                                                             const PeerQos& qos) {
  DataWriterQos writer_qos = DATAWRITER_QOS_DEFAULT;
  apply(qos, writer_qos);
  auto& publisher = implementation_->publisher();
  auto* writer =
      publisher.create_datawriter(implementation_->topicOf(topic, TypeSupport(type)), writer_qos);
  return std::make_unique<PeerWriter>(publisher, required(writer, "writer of " + topic));
}

std::unique_ptr<FastDdsPeer::Reader> FastDdsPeer::makeReader(const std::string& topic,
                                                             TopicDataType* type,
                                                             const PeerQos& qos, Receive receive) {
  const TypeSupport support(type);
  return std::make_unique<PeerReader>(implementation_->subscriber(),
                                      implementation_->topicOf(topic, support), qos,
                                      std::move(receive), support);
}

std::unique_ptr<FastDdsPeer::Writer> FastDdsPeer::bytesWriter(const std::string& topic,
                                                              const std::string& type,
                                                              const PeerQos& qos) {
  return makeWriter(topic, new BytesType(type), qos);
}

std::unique_ptr<FastDdsPeer::Reader> FastDdsPeer::bytesReader(
    const std::string& topic, const std::string& type, const PeerQos& qos,
    std::function<void(const std::string&)> receive) {
  return makeReader(topic, new BytesType(type), qos, [receive](const void* sample) {
    receive(*static_cast<const std::string*>(sample));
  });
}

int domainOfThisTest() { return 20 + static_cast<int>(getpid() % 200); }

bool hasSmallReceiveBuffers() {
  const int descriptor = socket(AF_INET, SOCK_DGRAM, 0);
  int size = 1 << 24;
  socklen_t length = sizeof size;
  (void)setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, length);
  (void)getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, &length);
  close(descriptor);
  return size < 1 << 25;  // Linux states twice of it
}

}  // namespace headway::test
