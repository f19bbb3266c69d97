// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "core/base/status.h"
#include "hal/onboard/control/operator_link.h"
#include "port_linux/file_descriptor.h"
#include "port_linux/open_outcome.h"

// Where operators' programs connect: a Unix-domain SOCK_SEQPACKET socket in the file system, one
// message of hal/onboard/control per packet (docs/control.md). It reads headers only: commands are
// executed by the tick and answered by the owner.
//
// Two checks keep others out. The file lets only its owner and its group connect; and of those who
// connect, only root, the owner and members of the group may command, according to the kernel
// (SO_PEERCRED, SO_PEERGROUPS, at connect time). Anyone else who gets in (because the file's mode
// was changed) may ask questions.

namespace hardpack {

struct ControlSocketOptions {
  std::string path;
  std::string group;  // may connect and command in addition to the owner; empty: none
};

// About 22 KiB.
class ControlSocket final : public OperatorLink {
 public:
  static constexpr int kMaxClients = 8;

  ControlSocket() = default;
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;
  ~ControlSocket() { Close(); }

  // Once, at start-up; allocates. A file left behind by a dead program is replaced.
  // kInvalidArgument: no path, one too long for a socket, something other than a socket is there,
  // or there is no such group; kNotPermitted: the folder, or giving the file to the group;
  // kSystemError: everything else, including another program that answers there or holds the lock
  // (path + ".lock", a file that stays).
  OpenOutcome Open(const ControlSocketOptions& options);

  // Also accepts connections.
  [[nodiscard]] bool Receive(ControlMessage& message) override;

  // A client that does not read its answers is dropped.
  void Answer(const ControlClient& client, std::span<const uint8_t> bytes) override;

  // Closes all connections and removes the file, if it is still ours. No answers after that.
  void Close();

  const control::ControlCounters& counters() const override { return counters_; }

 private:
  struct Client {
    FileDescriptor socket;
    uint64_t number = 0;
    uint64_t last_call = 0;  // of Receive, in which it last sent something
    uint32_t user = 0;
    bool may_command = false;
    bool leaves = false;  // sends nothing more; removed once its messages are read
  };
  static constexpr size_t kMaxGroups = 4096;  // of a peer that are checked

  OpenOutcome Lock(const std::string& path);
  OpenOutcome RemoveStale(const std::string& path);
  OpenOutcome Bind(const std::string& path, const std::string& group);
  void Accept();
  bool MayCommand(int socket, uint32_t& user);
  bool Seat(Client& client);
  int PlaceFor(bool may_command);
  bool Dismiss(int place);
  void Drop(int place);
  bool TakeFrom(int place, ControlMessage& message);
  void AnswerDone(int place, uint32_t sequence, Status status);

  FileDescriptor lock_;
  FileDescriptor socket_;
  std::string path_;  // of our file
  dev_t device_ = 0;
  ino_t inode_ = 0;
  uid_t owner_ = 0;
  bool has_group_ = false;
  gid_t group_ = 0;
  std::array<Client, kMaxClients> clients_;
  Client waits_;            // accepted, for a slot that is being vacated
  int32_t next_place_ = 0;  // asked first
  uint64_t last_number_ = 0;
  uint64_t calls_ = 0;  // of Receive
  control::ControlCounters counters_;
  std::array<pollfd, kMaxClients + 1> polled_{};
  std::array<gid_t, kMaxGroups> groups_{};
  std::array<uint8_t, control::kMaxMessageBytes> buffer_{};
};

}  // namespace hardpack
