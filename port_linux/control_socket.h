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

// Where operators' programs connect: a Unix-domain SOCK_SEQPACKET socket in the file system, a
// message of hal/onboard/control a packet (docs/control.md). It looks at headers only: what a
// command does is the tick's business, what is answered the owner's.
//
// Two locks keep others out. The file lets its owner and its group connect, nobody else; and of
// those who connect, only root, the owner and members of the group may command, by what the kernel
// says of them (SO_PEERCRED, SO_PEERGROUPS, of the moment of connecting). Who got in otherwise (the
// file's mode was changed) may ask questions.

namespace hardpack {

struct ControlSocketOptions {
  std::string path;
  std::string group;  // may connect and command besides the owner; empty: none
};

// About 22 KiB.
class ControlSocket final : public OperatorLink {
 public:
  static constexpr int kMaxClients = 8;

  ControlSocket() = default;
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;
  ~ControlSocket() { Close(); }

  // Once, at start-up; allocates. A file that a dead program left behind is replaced.
  // kInvalidArgument: no path, one that is too long for a socket, something else than a socket is
  // there, or there is no such group; kNotPermitted: the folder, or giving the file to the group;
  // kSystemError: all else, and that another program answers there or holds the lock (path +
  // ".lock", a file that stays).
  OpenOutcome Open(const ControlSocketOptions& options);

  // Takes connections, too.
  [[nodiscard]] bool Receive(ControlMessage& message) override;

  // A client that does not take its answers is dropped.
  void Answer(const ControlClient& client, std::span<const uint8_t> bytes) override;

  // Ends all connections and removes the file, if it still is ours. No answers after that.
  void Close();

  const control::ControlCounters& counters() const override { return counters_; }

 private:
  struct Client {
    FileDescriptor socket;
    uint64_t number = 0;
    uint64_t last_call = 0;  // of Receive, in which it last said something
    uint32_t user = 0;
    bool may_command = false;
    bool leaves = false;  // nothing more comes from it; goes once what it has said is taken
  };
  static constexpr size_t kMaxGroups = 4096;  // of a peer that are looked at

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
  std::string path_;  // of the file that is ours
  dev_t device_ = 0;
  ino_t inode_ = 0;
  uid_t owner_ = 0;
  bool has_group_ = false;
  gid_t group_ = 0;
  std::array<Client, kMaxClients> clients_;
  Client waits_;            // accepted, for a place that is being vacated
  int32_t next_place_ = 0;  // asked first
  uint64_t last_number_ = 0;
  uint64_t calls_ = 0;  // of Receive
  control::ControlCounters counters_;
  std::array<pollfd, kMaxClients + 1> polled_{};
  std::array<gid_t, kMaxGroups> groups_{};
  std::array<uint8_t, control::kMaxMessageBytes> buffer_{};
};

}  // namespace hardpack
