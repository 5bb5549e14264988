// SPDX-License-Identifier: BSD-3-Clause
// A participant of a ROS 2 domain: which topics others publish, and serialised messages of them and
// to them.
#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <headway/core/error.h>
#include <headway/ros2/node.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <optional>
#include <utility>

#include "bag_file.h"
#include "cdr_writer.h"
#include "messages.h"
#include "serialised_message.h"

namespace headway::ros2 {
namespace {

constexpr char kDiscovery[] = "ros_discovery_info";
enum GidSize : std::size_t { kNewGid = 16, kOldGid = 24 };  // from Iron on, and before
constexpr int kReceiveBuffer = 1 << 25;  // asked of the system [bytes]: a dozen raw 1280x720 pairs

[[noreturn]] void fail(const std::string& what, dds_return_t code) {
  throw InputError("ROS 2: " + what + ": " + dds_strretcode(code));
}

/// The entity, unless it is an error.
dds_entity_t checked(dds_entity_t entity, const std::string& what) {
  if (entity < 0) fail(what, entity);
  return entity;
}

/// "sensor_msgs/Image" as "sensor_msgs::msg::dds_::Image_".
std::string ddsType(const std::string& type) {
  const auto slash = type.find('/');
  return type.substr(0, slash) + "::msg::dds_::" + type.substr(slash + 1) + "_";
}

/// The other way round; a type that is none of ROS 2 as it is.
std::string rosType(const std::string& type) {
  const std::string middle = "::msg::dds_::";
  const auto at = type.find(middle);
  if (at == std::string::npos || type.back() != '_') return type;
  const auto name = at + middle.size();
  return type.substr(0, at) + "/" + type.substr(name, type.size() - name - 1);
}

std::string environment(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

int domainOf(const NodeOptions& options) {
  if (options.domain >= 0) return options.domain;
  const std::string text = environment("ROS_DOMAIN_ID");
  if (text.empty()) return 0;
  int domain = -1;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), domain);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || domain < 0 || domain > 232) {
    throw InputError("ROS_DOMAIN_ID = " + text + ": must be 0 to 232, by the ports of DDS");
  }
  return domain;
}

bool isLoopback(const std::string& interface) {
  return interface == "lo" || interface == "127.0.0.1";
}

/// The interface of the options or of ROS 2's variables; empty: Cyclone DDS selects it.
std::string interfaceOf(const NodeOptions& options) {
  // From Iron on, where a value that it does not know means this computer alone, too.
  const std::string range = environment("ROS_AUTOMATIC_DISCOVERY_RANGE");
  const bool is_wide = range.empty() || range == "SUBNET" || range == "SYSTEM_DEFAULT";
  const bool is_local = environment("ROS_LOCALHOST_ONLY") == "1";
  if (options.interface.empty()) return is_local || !is_wide ? "lo" : "";
  if ((is_local || !is_wide) && !isLoopback(options.interface)) {
    throw InputError(
        "--ros2-interface " + options.interface + ": " +
        (is_local ? "ROS_LOCALHOST_ONLY=1" : "ROS_AUTOMATIC_DISCOVERY_RANGE=" + range) +
        " allows this computer alone");
  }
  return options.interface;
}

/// Whether these settings of Cyclone DDS say nothing of interfaces and messages.
bool leavesInterface(const std::string& settings) {
  if (settings.empty()) return true;
  const auto has = [&](const char* part) { return settings.find(part) != std::string::npos; };
  return settings.front() == '<' && !has("Interface") && !has("Tracing") && !has("file:");
}

/// Settings of Cyclone DDS: bounds and buffers, then the interface or those of CYCLONEDDS_URI,
/// whose interfaces would be added to that one.
std::string configurationOf(const std::string& interface, int domain) {
  const bool is_local = isLoopback(interface);
  const bool is_address = interface.find_first_not_of("0123456789.:") == std::string::npos;
  std::string general, discovery;
  if (!interface.empty()) {
    if (interface.find_first_of("<>&\"'") != std::string::npos) {
      throw InputError("--ros2-interface " + interface + ": no such interface");
    }
    general = std::string("<General><Interfaces><NetworkInterface ") +
              (is_address ? "address" : "name") + "=\"" + interface + "\"/></Interfaces></General>";
  }
  if (is_local) {
    // By multicast if the loopback has it, as others of ROS 2; without it they are asked for at the
    // ports of so many participants, as many as the domain has: a robot with Nav2 has more than the
    // ten of Cyclone DDS.
    const int last = std::min(100, (65535 - 7411 - 250 * domain) / 2);
    discovery =
        "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>" +
        std::to_string(last) +
        "</MaxAutoParticipantIndex><Peers><Peer address=\"127.0.0.1\"/></Peers></Discovery>";
  }
  const std::string own = "<CycloneDDS><Domain>" + general + discovery +
                          "<Internal><SocketReceiveBufferSize max=\"" +
                          std::to_string(kReceiveBuffer) + "B\"/></Internal></Domain></CycloneDDS>";
  const std::string bound = ",<CycloneDDS><Domain><Internal><MaxSampleSize>" +  // in any case
                            std::to_string(bags::kMaxRecordBytes) +
                            "B</MaxSampleSize></Internal></Domain></CycloneDDS>";
  const std::string users = environment("CYCLONEDDS_URI");
  if (!interface.empty()) return own + bound;
  std::string all = own + (users.empty() ? "" : ",") + users + bound;
  if (leavesInterface(users)) {  // as by default, but it says which
    all +=
        ",<CycloneDDS><Domain><General><Interfaces><NetworkInterface autodetermine=\"true\"/>"
        "</Interfaces></General><Tracing><Category>info</Category><OutputFile>/dev/null"
        "</OutputFile></Tracing></Domain></CycloneDDS>";
  }
  return all;
}

/// Name of the interface that Cyclone DDS selected last, as it says while it joins a domain.
struct SelectedInterface {
  std::mutex mutex;
  std::string name;  // guarded by mutex

  void read(std::string_view message) {
    for (const std::string_view start : {"determined ", "using network interface "}) {
      if (message.substr(0, start.size()) != start) continue;
      const auto rest = message.substr(start.size());
      const std::lock_guard lock(mutex);
      name = rest.substr(0, rest.find(" ("));
    }
  }
  std::string take() {
    const std::lock_guard lock(mutex);
    return std::exchange(name, "");
  }
};

SelectedInterface& selectedInterface() {
  static SelectedInterface interface;
  return interface;
}

/// Warnings of Cyclone DDS by kind, which is the beginning of their text: it has one for each
/// malformed packet.
struct DdsWarnings {
  std::mutex mutex;
  std::map<std::string, std::size_t> counts;  // guarded by mutex

  /// Prints the first of each kind, then how many there are: at 10, 100, 1000, ...
  void add(const std::string& text) {
    const std::lock_guard lock(mutex);
    const std::string kind =
        text.substr(0, std::min(text.find_first_of("0123456789<"), text.find('\n')));
    std::size_t& count = counts[counts.size() < 100 || counts.count(kind) > 0 ? kind : "others"];
    std::size_t rest = ++count;
    while (rest % 10 == 0) rest /= 10;
    if (count == 1) std::fprintf(stderr, "Cyclone DDS: %s", text.c_str());
    if (count > 1 && rest == 1) {
      std::fprintf(stderr, "Cyclone DDS: so far %zu times: %s\n", count, kind.c_str());
    }
  }
};

void limitLog() {
  static DdsWarnings warnings;
  const auto print = [](void*, const dds_log_data_t* data) {
    if ((data->priority & DDS_LC_INFO) != 0) return selectedInterface().read(data->message);
    const bool is_usual = std::strstr(data->message, "\"lo\" is not multicast-capable") != nullptr;
    if (!is_usual) warnings.add(data->message);
  };
  dds_set_log_sink(print, nullptr);
}

/// A domain that the nodes of the program share: the last one ends it.
class Domain {
 public:
  Domain(int number, const std::string& interface) : number_(number) {
    const std::lock_guard lock(all().mutex);
    Shared& shared = all().by_number[number];
    if (shared.nodes > 0 && shared.interface != interface) {
      const auto named = [](const std::string& name) { return name.empty() ? "its own" : name; };
      throw InputError("ROS 2 domain " + std::to_string(number) + ": another node of this program" +
                       " has joined it on interface " + named(shared.interface) + ", not on " +
                       named(interface));
    }
    if (shared.nodes == 0) {
      shared.interface = interface;
      (void)selectedInterface().take();
      shared.entity = dds_create_domain(static_cast<dds_domainid_t>(number),
                                        configurationOf(interface, number).c_str());
      shared.selected = selectedInterface().take();
    }
    ++shared.nodes;
    selected = shared.selected;
    // What else in the program has joined it has its settings.
    const bool is_joined = shared.entity > 0 || shared.entity == DDS_RETCODE_PRECONDITION_NOT_MET;
    fault = is_joined ? DDS_RETCODE_OK : shared.entity;
  }
  ~Domain() {
    const std::lock_guard lock(all().mutex);
    Shared& shared = all().by_number.at(number_);
    if (--shared.nodes == 0 && shared.entity > 0) (void)dds_delete(shared.entity);
  }
  Domain(const Domain&) = delete;
  Domain& operator=(const Domain&) = delete;

  std::string selected;    ///< interface; empty: not by Cyclone DDS
  dds_return_t fault = 0;  ///< why it cannot be joined

 private:
  struct Shared {
    dds_entity_t entity = 0;
    std::string interface, selected;
    int nodes = 0;
  };
  struct All {
    std::mutex mutex;
    std::map<int, Shared> by_number;  // guarded by mutex
  };
  static All& all() {
    static All all;
    return all;
  }
  const int number_;
};

/// What to do about receive buffers that the system limits; empty: nothing.
std::string hintOfBuffers() {
  const int descriptor = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  int size = kReceiveBuffer;
  socklen_t length = sizeof size;
  const bool is_known =  // not by /proc/sys/net/core/rmem_max, which containers may lack
      setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, sizeof size) == 0 &&
      getsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &size, &length) == 0;
  if (descriptor >= 0) close(descriptor);
  const int limit = size / 2;  // Linux counts what it adds for itself
  if (!is_known || limit >= kReceiveBuffer / 2) return "";
  return "the system's receive buffers of " + std::to_string(limit / 1024) +
         " KiB lose parts of large raw images: sudo sysctl -w net.core.rmem_max=" +
         std::to_string(kReceiveBuffer);
}

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using DdsQos = std::unique_ptr<dds_qos_t, QosDeleter>;

DdsQos makeQos(const Qos& qos) {
  DdsQos result(dds_create_qos());
  // Keeping the last ones, writers do not wait for subscribers that do not keep up.
  dds_qset_reliability(result.get(),
                       qos.is_reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, 0);
  dds_qset_history(result.get(), DDS_HISTORY_KEEP_LAST, qos.depth);
  dds_qset_ignorelocal(result.get(), DDS_IGNORELOCAL_PARTICIPANT);
  dds_qset_writer_data_lifecycle(result.get(), false);
  if (qos.is_transient_local) {
    dds_qset_durability(result.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    dds_qset_durability_service(result.get(), 0, DDS_HISTORY_KEEP_LAST, qos.depth,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return result;
}

/// Whether the bytes announce nodes with identifiers of this size.
bool hasGids(std::string_view message, std::size_t size) {
  try {
    bags::WireReader in(message, bags::Encoding::kCdr);
    const auto skip = [&in](std::size_t count) {
      for (std::size_t i = 0; i < count; ++i) (void)in.number<std::uint8_t>();
    };
    skip(size);
    const auto nodes = in.length(sizeof(std::uint32_t));
    for (std::uint32_t i = 0; i < nodes; ++i) {
      (void)in.text();
      (void)in.text();
      skip(size * in.length(size));
      skip(size * in.length(size));
    }
    in.requireEnd();
    return true;
  } catch (const bags::BrokenData&) {
    return false;
  }
}

struct Endpoint {
  std::string topic;  ///< of DDS: "rt/scan"
  std::string type;   ///< of DDS
  bool is_reliable = false;
  bool is_transient_local = false;
};

Endpoint endpointOf(const dds_builtintopic_endpoint_t& data) {
  Endpoint endpoint{data.topic_name, data.type_name};
  dds_reliability_kind_t reliability = DDS_RELIABILITY_BEST_EFFORT;
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  if (dds_qget_reliability(data.qos, &reliability, nullptr)) {
    endpoint.is_reliable = reliability == DDS_RELIABILITY_RELIABLE;
  }
  if (dds_qget_durability(data.qos, &durability)) {
    endpoint.is_transient_local = durability != DDS_DURABILITY_VOLATILE;
  }
  return endpoint;
}

struct MessageDeleter {
  void operator()(ddsi_serdata* data) const { ddsi_serdata_unref(data); }
};

}  // namespace

bool Publication::hasSubscribers() const {
  dds_publication_matched_status_t status{};
  return writer_ != 0 && dds_get_publication_matched_status(writer_, &status) == DDS_RETCODE_OK &&
         status.current_count > 0;
}

bool Publication::publish(std::string message) const {
  auto* data =
      new SerialisedMessage(static_cast<const ddsi_sertype*>(type_), SDK_DATA, std::move(message));
  return dds_writecdr(writer_, data) == DDS_RETCODE_OK;  // takes it
}

bool Publication::isTaken(double timeout_s) const {
  return dds_wait_for_acks(writer_, static_cast<dds_duration_t>(1e9 * timeout_s)) !=
         DDS_RETCODE_TIMEOUT;
}

class Node::Implementation {
 public:
  explicit Implementation(const NodeOptions& options) : name_(options.name) {
    const int number = domainOf(options);
    const std::string interface = interfaceOf(options);
    limitLog();
    domain_.emplace(number, interface);
    participant_ = domain_->fault;
    if (participant_ == DDS_RETCODE_OK) {
      participant_ = dds_create_participant(static_cast<dds_domainid_t>(number), nullptr, nullptr);
    }
    checked(participant_, "domain " + std::to_string(number) + " cannot be joined" +
                              (interface.empty() ? "" : " on interface " + interface));
    (void)dds_get_guid(participant_, &guid_);
    const bool has_settings = !environment("CYCLONEDDS_URI").empty();
    const std::string& selected = domain_->selected;
    network_ = "ROS 2 domain " + std::to_string(number) + " on " +
               (!interface.empty()   ? interface
                : !selected.empty() ? selected + ", which Cyclone DDS selects"
                : has_settings      ? "the interfaces of CYCLONEDDS_URI"
                                    : "the interface that Cyclone DDS selects");
    if (has_settings && !interface.empty()) network_ += " (CYCLONEDDS_URI is not used)";
    const std::string hint = hintOfBuffers();
    if (!hint.empty()) network_ += "; " + hint;
    start();
  }

  ~Implementation() { (void)dds_delete(participant_); }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  [[nodiscard]] const std::string& network() const { return network_; }

  std::vector<PublishedTopic> published() {
    takeEndpoints();
    std::map<std::pair<std::string, std::string>, PublishedTopic> topics;
    for (const auto& [key, endpoint] : endpoints_) {
      if (endpoint.topic.rfind("rt/", 0) != 0) continue;  // services, and what is not of ROS 2
      auto& topic = topics[{endpoint.topic, endpoint.type}];
      topic.name = endpoint.topic.substr(2);
      topic.type = rosType(endpoint.type);
      ++topic.publishers;
      topic.is_reliable = topic.is_reliable && endpoint.is_reliable;
      topic.is_transient_local = topic.is_transient_local && endpoint.is_transient_local;
    }
    std::vector<PublishedTopic> result;
    for (auto& entry : topics) result.push_back(std::move(entry.second));
    return result;
  }

  void subscribe(const std::string& topic, const std::string& type, const Qos& qos,
                 Receive receive) {
    remove(topic);
    subscriptions_[topic] = {
        {addReader("rt" + topic, type, qos)}, type, qos.depth, std::move(receive)};
    announce();
  }

  void widen(const std::string& topic, const Qos& qos) {
    Subscription& subscription = subscriptions_.at(topic);
    subscription.readers.push_back(addReader("rt" + topic, subscription.type, qos));
    announce();
  }

  void unsubscribe(const std::string& topic) {
    if (remove(topic)) announce();
  }

  [[nodiscard]] std::size_t mismatches(const std::string& topic) const {
    const auto found = subscriptions_.find(topic);
    dds_requested_incompatible_qos_status_t status{};
    if (found == subscriptions_.end()) return 0;
    (void)dds_get_requested_incompatible_qos_status(found->second.readers.back(), &status);
    return status.total_count;
  }

  std::pair<int, const void*> advertise(const std::string& topic, const std::string& type,
                                        const Qos& qos) {
    const auto writer = addWriter("rt" + topic, type, qos);
    writers_.push_back(writer.first);
    announce();
    return writer;
  }

  void spin(double timeout_s) {
    const double wait_s = std::exchange(has_more_, false) ? 0.0 : timeout_s;
    (void)dds_waitset_wait(waitset_, nullptr, 0, static_cast<dds_duration_t>(1e9 * wait_s));
    takeEndpoints();
    take({{discovery_}, "", 100, [this](std::string_view message) { adoptGids(message); }});
    std::vector<std::string> topics;
    for (const auto& entry : subscriptions_) topics.push_back(entry.first);
    for (const auto& topic : topics) {
      const auto found = subscriptions_.find(topic);  // unless a callback has ended it
      if (found != subscriptions_.end()) take(Subscription(found->second));
    }
  }

 private:
  struct Subscription {
    std::vector<dds_entity_t> readers;
    std::string type;
    int depth = 0;  ///< messages that a reader keeps
    Receive receive;
  };
  struct Topic {
    dds_entity_t entity = 0;
    const ddsi_sertype* type = nullptr;
  };

  void start() {
    waitset_ = checked(dds_create_waitset(participant_), "no waitset");
    publications_ = checked(
        dds_create_reader(participant_, DDS_BUILTIN_TOPIC_DCPSPUBLICATION, nullptr, nullptr),
        "no discovery");
    attach(publications_);
    constexpr char kAnnouncement[] = "rmw_dds_common/ParticipantEntitiesInfo";
    discovery_ = addReader(kDiscovery, kAnnouncement, {true, true, 100});
    announcement_ = addWriter(kDiscovery, kAnnouncement, {true, true, 1});
    announce();
  }

  /// Ends a subscription. @return whether there was one
  bool remove(const std::string& topic) {
    const auto found = subscriptions_.find(topic);
    if (found == subscriptions_.end()) return false;
    for (const dds_entity_t reader : found->second.readers) {
      (void)dds_waitset_detach(waitset_, reader);
      (void)dds_delete(reader);
    }
    subscriptions_.erase(found);
    return true;
  }

  void attach(dds_entity_t reader) {
    (void)dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS);
    (void)dds_waitset_attach(waitset_, reader, 0);
  }

  const Topic& topicOf(const std::string& name, const std::string& type) {
    Topic& topic = topics_[{name, type}];
    if (topic.entity > 0) return topic;
    ddsi_sertype* description = makeSerialisedType(ddsType(type));
    topic.entity = checked(dds_create_topic_sertype(participant_, name.c_str(), &description,
                                                    nullptr, nullptr, nullptr),
                           "topic " + name);
    topic.type = description;
    return topic;
  }

  dds_entity_t addReader(const std::string& name, const std::string& type, const Qos& qos) {
    const auto reader = checked(
        dds_create_reader(participant_, topicOf(name, type).entity, makeQos(qos).get(), nullptr),
        "subscription of " + name);
    attach(reader);
    return reader;
  }

  std::pair<int, const void*> addWriter(const std::string& name, const std::string& type,
                                        const Qos& qos) {
    const Topic& topic = topicOf(name, type);
    return {checked(dds_create_writer(participant_, topic.entity, makeQos(qos).get(), nullptr),
                    "publication of " + name),
            topic.type};
  }

  /// Keeps what others publish up to date.
  void takeEndpoints() {
    std::array<void*, 16> samples{};
    std::array<dds_sample_info_t, 16> infos{};
    for (int count = 16; count == 16;) {
      samples.fill(nullptr);
      count = dds_take(publications_, samples.data(), infos.data(), infos.size(), 16);
      for (int i = 0; i < count; ++i) {
        const auto& data = *static_cast<const dds_builtintopic_endpoint_t*>(samples[i]);
        const auto* bytes = reinterpret_cast<const char*>(data.key.v);
        const std::string key(bytes, sizeof data.key.v);
        const bool is_own = std::memcmp(data.key.v, guid_.v, 12) == 0;  // the same participant
        if (!infos[i].valid_data || infos[i].instance_state != DDS_IST_ALIVE) {
          endpoints_.erase(key);
        } else if (!is_own) {
          endpoints_[key] = endpointOf(data);
        }
      }
      if (count > 0) (void)dds_return_loan(publications_, samples.data(), count);
    }
  }

  /// Passes on as many messages as the reader keeps: a publisher that is faster than they are used
  /// must not keep others waiting. One by one, because a callback may end the subscription.
  void take(const Subscription& subscription) {
    for (const dds_entity_t reader : subscription.readers) {
      int left = subscription.depth;
      for (; left > 0; --left) {
        ddsi_serdata* sample = nullptr;
        dds_sample_info_t info{};
        if (dds_takecdr(reader, &sample, 1, &info, DDS_ANY_STATE) < 1) break;
        const std::unique_ptr<ddsi_serdata, MessageDeleter> owned(sample);
        const auto& message = *static_cast<const SerialisedMessage*>(sample);
        if (info.valid_data) subscription.receive({message.bytes.data(), message.size});
      }
      has_more_ = has_more_ || left == 0;
    }
  }

  /// Announces nodes with the identifiers of those who were there before: their size is not the
  /// same in all distributions.
  void adoptGids(std::string_view message) {
    const bool is_old = hasGids(message, kOldGid) && !hasGids(message, kNewGid);
    const GidSize size = is_old ? kOldGid : kNewGid;
    if (is_gid_known_ || !hasGids(message, size)) return;
    is_gid_known_ = true;
    if (size != std::exchange(gid_size_, size)) announce();
  }

  /// Tells ROS 2 which node has which subscriptions and publications.
  void announce() const {
    CdrWriter out;
    const auto add = [&](dds_entity_t entity) {
      std::array<unsigned char, kOldGid> gid{};
      dds_guid_t guid{};
      (void)dds_get_guid(entity, &guid);
      std::memcpy(gid.data(), guid.v, sizeof guid.v);
      out.append(gid.data(), gid_size_);
    };
    add(participant_);
    out.length(1);
    out.text("/");
    out.text(name_);
    std::vector<dds_entity_t> readers;
    for (const auto& entry : subscriptions_) {
      readers.insert(readers.end(), entry.second.readers.begin(), entry.second.readers.end());
    }
    out.length(readers.size());
    for (const dds_entity_t reader : readers) add(reader);
    out.length(writers_.size());
    for (const dds_entity_t writer : writers_) add(writer);
    (void)dds_writecdr(announcement_.first,
                       new SerialisedMessage(static_cast<const ddsi_sertype*>(announcement_.second),
                                             SDK_DATA, out.take()));
  }

  const std::string name_;
  std::optional<Domain> domain_;
  dds_entity_t participant_ = 0;
  dds_guid_t guid_{};
  std::string network_;
  dds_entity_t waitset_ = 0;
  dds_entity_t publications_ = 0;  ///< reader of what is published
  dds_entity_t discovery_ = 0;     ///< reader of the announcements of nodes
  std::pair<int, const void*> announcement_{0, nullptr};
  GidSize gid_size_ = kNewGid;
  bool is_gid_known_ = false;
  std::map<std::pair<std::string, std::string>, Topic> topics_;  ///< by name and type
  std::map<std::string, Endpoint> endpoints_;                    ///< publishers, by key
  std::map<std::string, Subscription> subscriptions_;            ///< by topic
  bool has_more_ = false;  ///< are there messages for which no wait would end?
  std::vector<dds_entity_t> writers_;
};

Node::Node(const NodeOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

Node::~Node() = default;

const std::string& Node::network() const { return implementation_->network(); }

std::vector<PublishedTopic> Node::published() { return implementation_->published(); }

void Node::subscribe(const std::string& topic, const std::string& type, const Qos& qos,
                     Receive receive) {
  implementation_->subscribe(topic, type, qos, std::move(receive));
}

void Node::widen(const std::string& topic, const Qos& qos) { implementation_->widen(topic, qos); }

void Node::unsubscribe(const std::string& topic) { implementation_->unsubscribe(topic); }

std::size_t Node::mismatches(const std::string& topic) const {
  return implementation_->mismatches(topic);
}

Publication Node::advertise(const std::string& topic, const std::string& type, const Qos& qos) {
  Publication publication;
  publication.topic_ = topic;
  std::tie(publication.writer_, publication.type_) = implementation_->advertise(topic, type, qos);
  return publication;
}

std::string Node::bufferHint() const { return hintOfBuffers(); }

void Node::spin(double timeout_s) { implementation_->spin(timeout_s); }

}  // namespace headway::ros2
