// SPDX-License-Identifier: Apache-2.0
#include "port_linux/link_message.h"

#include <linux/can/netlink.h>
#include <linux/if.h>
#include <linux/if_arp.h>
#include <linux/netlink.h>
#include <linux/rtnetlink.h>

#include <algorithm>
#include <cstring>
#include <type_traits>

namespace hardpack {
namespace {

template <typename T>
bool Read(std::span<const uint8_t> bytes, T& value) {
  static_assert(std::is_trivially_copyable_v<T>);
  if (bytes.size() < sizeof(T)) return false;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return true;
}

constexpr size_t Aligned(size_t size) {
  return (size + 3) & ~size_t{3};  // NLA_ALIGNTO and NLMSG_ALIGNTO
}

struct Attribute {
  uint16_t type = 0;
  std::span<const uint8_t> value;
};

bool NextAttribute(std::span<const uint8_t>& bytes, Attribute& attribute) {
  nlattr header{};
  if (!Read(bytes, header) || header.nla_len < sizeof(header) || header.nla_len > bytes.size()) {
    return false;
  }
  attribute.type = header.nla_type & NLA_TYPE_MASK;
  attribute.value = bytes.first(header.nla_len).subspan(sizeof(header));
  bytes = bytes.subspan(std::min(Aligned(header.nla_len), bytes.size()));
  return true;
}

void ReadController(std::span<const uint8_t> bytes, LinkInfo& link) {
  for (Attribute attribute; NextAttribute(bytes, attribute);) {
    can_bittiming timing{};
    uint32_t number = 0;
    if (attribute.type == IFLA_CAN_BITTIMING && Read(attribute.value, timing)) {
      link.bit_rate_bps = timing.bitrate;
      link.sample_point_permille = timing.sample_point;
    } else if (attribute.type == IFLA_CAN_STATE && Read(attribute.value, number)) {
      link.has_controller = true;
      link.bus_off = number == CAN_STATE_BUS_OFF;
    } else if (attribute.type == IFLA_CAN_RESTART_MS && Read(attribute.value, number)) {
      link.restart_ms = number;
    }
  }
}

// The meaning of IFLA_INFO_DATA depends on the kind, whose name comes first.
void ReadDetails(std::span<const uint8_t> bytes, LinkInfo& link) {
  constexpr char kController[] = "can";
  bool is_controller = false;
  for (Attribute attribute; NextAttribute(bytes, attribute);) {
    if (attribute.type == IFLA_INFO_KIND) {
      is_controller = attribute.value.size() == sizeof(kController) &&
                      std::memcmp(attribute.value.data(), kController, sizeof(kController)) == 0;
    } else if (attribute.type == IFLA_INFO_DATA && is_controller) {
      ReadController(attribute.value, link);
    }
  }
}

nlmsghdr Header(size_t size, uint16_t type, uint16_t flags, uint32_t sequence) {
  nlmsghdr header{};
  header.nlmsg_len = static_cast<uint32_t>(size);
  header.nlmsg_type = type;
  header.nlmsg_flags = static_cast<uint16_t>(NLM_F_REQUEST | flags);
  header.nlmsg_seq = sequence;
  return header;
}

}  // namespace

bool NextNetlinkMessage(std::span<const uint8_t>& bytes, NetlinkMessage& message) {
  nlmsghdr header{};
  if (!Read(bytes, header) || header.nlmsg_len < sizeof(header) ||
      header.nlmsg_len > bytes.size()) {
    return false;
  }
  message.type = header.nlmsg_type;
  message.sequence = header.nlmsg_seq;
  message.payload = bytes.first(header.nlmsg_len).subspan(sizeof(header));
  bytes = bytes.subspan(std::min(Aligned(header.nlmsg_len), bytes.size()));
  return true;
}

bool ParseLink(std::span<const uint8_t> payload, LinkInfo& link) {
  ifinfomsg header{};
  if (!Read(payload, header)) return false;
  link = {};
  link.index = header.ifi_index;
  link.up = (header.ifi_flags & IFF_UP) != 0;
  link.carrier = (header.ifi_flags & IFF_LOWER_UP) != 0;
  link.is_can = header.ifi_type == ARPHRD_CAN;
  std::span<const uint8_t> rest = payload.subspan(sizeof(header));
  for (Attribute attribute; NextAttribute(rest, attribute);) {
    if (attribute.type == IFLA_IFNAME) {
      const size_t size = std::min(attribute.value.size(), kMaxLinkName);
      std::memcpy(link.name, attribute.value.data(), size);
    } else if (attribute.type == IFLA_LINKINFO) {
      ReadDetails(attribute.value, link);
    }
  }
  return true;
}

bool ParseAcknowledgement(std::span<const uint8_t> payload, int& code) {
  int negative = 0;
  if (!Read(payload, negative)) return false;
  code = -negative;
  return true;
}

std::vector<uint8_t> LinkQuery(uint32_t sequence, std::string_view name) {
  nlattr attribute{};
  attribute.nla_type = IFLA_IFNAME;
  attribute.nla_len = static_cast<uint16_t>(sizeof(attribute) + name.size() + 1);
  const size_t size = sizeof(nlmsghdr) + sizeof(ifinfomsg) + Aligned(attribute.nla_len);
  const nlmsghdr header = Header(size, RTM_GETLINK, 0, sequence);
  std::vector<uint8_t> bytes(size);
  uint8_t* to = bytes.data();
  std::memcpy(to, &header, sizeof(header));
  to += sizeof(header) + sizeof(ifinfomsg);  // which stays zero: any family, any index
  std::memcpy(to, &attribute, sizeof(attribute));
  std::memcpy(to + sizeof(attribute), name.data(), name.size());
  return bytes;
}

LinkRequest SetLinkFlags(uint32_t sequence, int index, uint32_t flags, uint32_t change) {
  const nlmsghdr header = Header(sizeof(LinkRequest), RTM_NEWLINK, NLM_F_ACK, sequence);
  ifinfomsg link{};
  link.ifi_index = index;
  link.ifi_flags = flags;
  link.ifi_change = change;
  LinkRequest request{};
  static_assert(sizeof(header) + sizeof(link) == sizeof(request.bytes));
  std::memcpy(request.bytes, &header, sizeof(header));
  std::memcpy(request.bytes + sizeof(header), &link, sizeof(link));
  return request;
}

}  // namespace hardpack
