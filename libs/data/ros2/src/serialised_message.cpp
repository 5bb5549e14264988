// SPDX-License-Identifier: BSD-3-Clause
// Messages of any type as Cyclone DDS keeps them: their bytes.
#include "serialised_message.h"

#include <dds/ddsi/q_radmin.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <utility>

#include "bag_file.h"

namespace headway::ros2 {
namespace {

const SerialisedMessage& messageOf(const ddsi_serdata* data) {
  return *static_cast<const SerialisedMessage*>(data);
}

std::string joined(const nn_rdata* part, std::size_t size) {
  std::string bytes(size, '\0');
  std::size_t at = 0;
  for (; part != nullptr; part = part->nextfrag) {
    if (part->maxp1 <= at || part->min > at) continue;  // nothing new
    const std::size_t end = std::min<std::size_t>(part->maxp1, size);
    const unsigned char* payload = NN_RMSG_PAYLOADOFF(part->rmsg, NN_RDATA_PAYLOAD_OFF(part));
    std::memcpy(bytes.data() + at, payload + (at - part->min), end - at);
    at = end;
  }
  return bytes;
}

/// A subscription keeps ten images or clouds, but a hundred of other messages, which must not have
/// more than the largest one of those together.
bool isTooLarge(const ddsi_sertype* type, std::size_t size) {
  const auto is = [&](const char* part) { return std::strstr(type->type_name, part) != nullptr; };
  return size > bags::kMaxRecordBytes / 100 && !is("Image") && !is("PointCloud");
}

ddsi_serdata* fromFragments(const ddsi_sertype* type, ddsi_serdata_kind kind, const nn_rdata* first,
                            std::size_t size) {
  if (isTooLarge(type, size)) return nullptr;  // which Cyclone DDS names
  return new SerialisedMessage(type, kind, joined(first, size));
}

ddsi_serdata* fromBuffers(const ddsi_sertype* type, ddsi_serdata_kind kind,
                          ddsrt_msg_iovlen_t count, const ddsrt_iovec_t* buffers,
                          std::size_t size) {
  std::string bytes;
  for (ddsrt_msg_iovlen_t i = 0; i < count && bytes.size() < size; ++i) {
    const std::size_t part = std::min<std::size_t>(buffers[i].iov_len, size - bytes.size());
    bytes.append(static_cast<const char*>(buffers[i].iov_base), part);
  }
  return new SerialisedMessage(type, kind, std::move(bytes));
}

ddsi_serdata* withoutContent(const ddsi_sertype* type) {
  return new SerialisedMessage(type, SDK_KEY, {});
}

constexpr ddsi_serdata_ops makeMessageOperations() {
  ddsi_serdata_ops operations{};
  operations.eqkey = [](const ddsi_serdata*, const ddsi_serdata*) { return true; };
  operations.get_size = [](const ddsi_serdata* data) {
    return static_cast<std::uint32_t>(messageOf(data).size);
  };
  operations.from_ser = fromFragments;
  operations.from_ser_iov = fromBuffers;
  operations.from_keyhash = [](const ddsi_sertype* type, const ddsi_keyhash*) {
    return withoutContent(type);
  };
  operations.from_sample = [](const ddsi_sertype* type, ddsi_serdata_kind, const void*) {
    return withoutContent(type);  // dispose() and the like, which have no content
  };
  operations.to_ser = [](const ddsi_serdata* data, std::size_t at, std::size_t size, void* to) {
    std::memcpy(to, messageOf(data).bytes.data() + at, size);
  };
  operations.to_ser_ref = [](const ddsi_serdata* data, std::size_t at, std::size_t size,
                             ddsrt_iovec_t* reference) {
    reference->iov_base = const_cast<char*>(messageOf(data).bytes.data() + at);
    reference->iov_len = size;
    return ddsi_serdata_ref(data);
  };
  operations.to_ser_unref = [](ddsi_serdata* data, const ddsrt_iovec_t*) {
    ddsi_serdata_unref(data);
  };
  operations.to_sample = [](const ddsi_serdata*, void*, void**, void*) { return false; };
  operations.to_untyped = [](const ddsi_serdata*) { return withoutContent(nullptr); };
  operations.untyped_to_sample = [](const ddsi_sertype*, const ddsi_serdata*, void*, void**,
                                    void*) { return false; };
  operations.free = [](ddsi_serdata* data) { delete static_cast<SerialisedMessage*>(data); };
  operations.print = [](const ddsi_sertype*, const ddsi_serdata*, char* text, std::size_t) {
    *text = '\0';
    return std::size_t{0};
  };
  operations.get_keyhash = [](const ddsi_serdata*, ddsi_keyhash* hash, bool) {
    std::memset(hash, 0, sizeof *hash);
  };
  return operations;
}

constexpr ddsi_serdata_ops kMessageOperations = makeMessageOperations();

ddsi_sertype_ops makeTypeOperations() {
  ddsi_sertype_ops operations{};
  operations.version = ddsi_sertype_v0;
  operations.free = [](ddsi_sertype* type) {
    ddsi_sertype_fini(type);
    delete type;
  };
  // Samples are never asked for: all messages are read and written as bytes.
  operations.zero_samples = [](const ddsi_sertype*, void*, std::size_t) {};
  operations.realloc_samples = [](void**, const ddsi_sertype*, void*, std::size_t, std::size_t) {};
  operations.free_samples = [](const ddsi_sertype*, void**, std::size_t, dds_free_op_t) {};
  operations.equal = [](const ddsi_sertype*, const ddsi_sertype*) { return true; };
  operations.hash = [](const ddsi_sertype*) { return std::uint32_t{0}; };
  return operations;
}

const ddsi_sertype_ops kTypeOperations = makeTypeOperations();

}  // namespace

SerialisedMessage::SerialisedMessage(const ddsi_sertype* of_type, ddsi_serdata_kind of_kind,
                                     std::string content)
    : ddsi_serdata{}, bytes(std::move(content)), size(bytes.size()) {
  if (of_type != nullptr) {
    ddsi_serdata_init(this, of_type, of_kind);
  } else {  // the key that all messages share
    ops = &kMessageOperations;
    kind = of_kind;
    ddsrt_atomic_st32(&refc, 1);
  }
  bytes.resize((size + 3) / 4 * 4);  // Cyclone DDS sends multiples of four
}

ddsi_sertype* makeSerialisedType(const std::string& name) {
  auto type = std::make_unique<ddsi_sertype>();
  ddsi_sertype_init(type.get(), name.c_str(), &kTypeOperations, &kMessageOperations, true);
  type->allowed_data_representation = DDS_DATA_REPRESENTATION_FLAG_XCDR1;
  return type.release();
}

}  // namespace headway::ros2
