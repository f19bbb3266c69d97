// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

// The rtnetlink(7) messages for watching and restarting a CAN interface. Bytes only: the socket is
// CanLink's. Every length from the kernel is checked.

namespace hardpack {

// The kernel's name of an interface has at most 15 characters (IFNAMSIZ - 1).
inline constexpr size_t kMaxLinkName = 15;

// What RTM_NEWLINK and RTM_DELLINK report about an interface.
struct LinkInfo {
  int index = 0;
  bool up = false;       // by the administrator
  bool carrier = false;  // and working: a CAN controller in bus-off has none
  bool is_can = false;
  char name[kMaxLinkName + 1] = {};
  // For a CAN controller; an interface without one (vcan) reports none of these.
  bool has_controller = false;
  bool bus_off = false;
  uint32_t bit_rate_bps = 0;
  uint32_t sample_point_permille = 0;
  uint32_t restart_ms = 0;  // after bus-off, by the kernel itself; 0: disabled
};

struct NetlinkMessage {
  uint16_t type = 0;
  uint32_t sequence = 0;
  std::span<const uint8_t> payload;
};

// Takes the first message off `bytes`. False: there is no complete one.
bool NextNetlinkMessage(std::span<const uint8_t>& bytes, NetlinkMessage& message);

// Parses a message of type RTM_NEWLINK or RTM_DELLINK. False: it is truncated.
bool ParseLink(std::span<const uint8_t> payload, LinkInfo& link);

// Parses a message of type NLMSG_ERROR: 0, or an errno. False: it is truncated.
bool ParseAcknowledgement(std::span<const uint8_t> payload, int& code);

// A request for an interface's RTM_NEWLINK, by its name; at most kMaxLinkName characters.
std::vector<uint8_t> LinkQuery(uint32_t sequence, std::string_view name);

// A request, with acknowledgement, to set the flags in `change` to `flags`. With no `change`,
// nothing is done, and the acknowledgement tells whether it would be permitted.
struct LinkRequest {
  alignas(4) uint8_t bytes[32];  // nlmsghdr, ifinfomsg
};
LinkRequest SetLinkFlags(uint32_t sequence, int index, uint32_t flags, uint32_t change);

}  // namespace hardpack
