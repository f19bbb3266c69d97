// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

#include "port_linux/control_socket.h"
#include "test/fakes/memory_operator_link.h"
#include "test/hal/conformance/operator_link_conformance.h"

namespace hardpack {
namespace {

class MemoryLinkHarness {
 public:
  OperatorLink& link() { return link_; }
  size_t Connect() { return link_.Connect(); }
  void Say(size_t client, const std::vector<uint8_t>& bytes) { link_.Say(client, bytes); }
  std::vector<uint8_t> Read(size_t client) { return link_.Read(client); }
  void Leave(size_t client) { link_.Leave(client); }

 private:
  fakes::MemoryOperatorLink link_;
};

// Real sockets, in a folder of their own.
class SocketLinkHarness {
 public:
  SocketLinkHarness() {
    char name[] = "/tmp/hardpack_link_XXXXXX";
    EXPECT_NE(mkdtemp(name), nullptr);
    folder_ = name;
    EXPECT_TRUE(link_.Open({folder_ + "/control.sock", ""}).ok());
  }
  ~SocketLinkHarness() {
    link_.Close();
    unlink((folder_ + "/control.sock.lock").c_str());
    rmdir(folder_.c_str());
  }

  OperatorLink& link() { return link_; }
  size_t Connect() {
    const std::string path = folder_ + "/control.sock";
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path.begin(), path.end(), address.sun_path);
    clients_.emplace_back(socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
    const auto* bytes = reinterpret_cast<const sockaddr*>(&address);
    EXPECT_EQ(connect(clients_.back().get(), bytes, sizeof(address)), 0);
    ControlMessage message;
    EXPECT_FALSE(link_.Receive(message));  // lets it in
    return clients_.size() - 1;
  }
  void Say(size_t client, const std::vector<uint8_t>& bytes) {
    EXPECT_EQ(send(clients_[client].get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  std::vector<uint8_t> Read(size_t client) {
    std::vector<uint8_t> bytes(control::kMaxMessageBytes);
    const ssize_t size = recv(clients_[client].get(), bytes.data(), bytes.size(), 0);
    bytes.resize(size > 0 ? static_cast<size_t>(size) : 0);
    return bytes;
  }
  void Leave(size_t client) { clients_[client].Reset(-1); }

 private:
  std::string folder_;
  ControlSocket link_;
  std::vector<FileDescriptor> clients_;
};

INSTANTIATE_TYPED_TEST_SUITE_P(Memory, OperatorLinkConformance, MemoryLinkHarness);
INSTANTIATE_TYPED_TEST_SUITE_P(Socket, OperatorLinkConformance, SocketLinkHarness);

}  // namespace
}  // namespace hardpack
