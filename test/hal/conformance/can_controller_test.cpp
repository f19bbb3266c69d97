// SPDX-License-Identifier: Apache-2.0
// SocketCanBus on an interface that has a controller, as a vcan has not: bit rate, error states and
// a bus-off that the kernel knows of. The controller is slcan's, on a pseudo-terminal whose other
// end plays the adapter (its protocol: Lawicel's; state changes: the kernel's slcan-core.c).
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/if.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

#include "port_linux/socket_can_bus.h"

namespace hardpack {
namespace {

constexpr uint64_t kTick_ns = 10'000'000;
constexpr int kSlcanDiscipline = 17;  // N_SLCAN

bool Shell(const std::string& command) {
  return std::system((command + " >/dev/null 2>&1").c_str()) == 0;
}

class CanController : public ::testing::Test {
 protected:
  void SetUp() override {
    adapter_ = FileDescriptor(posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK));
    if (!adapter_.valid() || grantpt(adapter_.get()) != 0 || unlockpt(adapter_.get()) != 0) {
      GTEST_SKIP() << "there are no pseudo-terminals here";
    }
    line_ = FileDescriptor(open(ptsname(adapter_.get()), O_RDWR | O_NOCTTY));
    termios raw{};
    cfmakeraw(&raw);
    tcsetattr(line_.get(), TCSANOW, &raw);
    ifreq request{};
    if (ioctl(line_.get(), TIOCSETD, &kSlcanDiscipline) != 0 ||
        ioctl(line_.get(), SIOCGIFNAME, &request) != 0) {
      GTEST_SKIP() << "there is no slcan here: run it by tools/vcan.sh and with_vcan.sh";
    }
    name_ = request.ifr_name;
    reader_ = std::thread([this] { Read(); });
    ASSERT_TRUE(Shell("ip link set " + name_ + " type can bitrate 500000"));
    ASSERT_TRUE(Shell("ip link set " + name_ + " up"));
  }

  void TearDown() override { Pull(); }

  // The adapter's plug, with which the interface goes.
  void Pull() {
    line_.Reset();
    pulled_ = true;
    if (reader_.joinable()) reader_.join();
    adapter_.Reset();
  }

  // What the controller has written so far.
  std::string Written() {
    const std::lock_guard lock(mutex_);
    return written_;
  }

  // The controller's driver waits until its line has been read.
  void Read() {
    char text[256];
    while (!pulled_) {
      pollfd ready{adapter_.get(), POLLIN, 0};
      if (poll(&ready, 1, 20) <= 0) continue;
      const ssize_t got = read(adapter_.get(), text, sizeof(text));
      const std::lock_guard lock(mutex_);
      if (got > 0) written_.append(text, static_cast<size_t>(got));
    }
  }

  // The adapter tells a state, and the error counters.
  void Tell(const std::string& state) {
    const std::string text = state + "\r";
    ASSERT_EQ(write(adapter_.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }

  // At most five seconds of real time, in which none passes for the bus.
  bool Until(SocketCanBus& bus, const std::function<bool()>& is_true) {
    const auto give_up = std::chrono::steady_clock::now() + std::chrono::seconds(5);
    while (std::chrono::steady_clock::now() < give_up) {
      bus.Advance(now_ns_);
      if (is_true()) return true;
      usleep(1000);
    }
    return false;
  }

  // So long that the kernel has told all that it has to tell of a change of the link (it may take a
  // second for that), and as long for the bus.
  void LetTheKernelTell(SocketCanBus& bus) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(1500);
    const uint64_t end_ns = now_ns_ + 1'500'000'000;
    while (std::chrono::steady_clock::now() < end || now_ns_ < end_ns) {
      bus.Advance(now_ns_ += kTick_ns);
      usleep(1000);
    }
  }

  FileDescriptor adapter_;
  FileDescriptor line_;
  std::string name_;
  std::thread reader_;
  std::atomic<bool> pulled_ = false;
  std::mutex mutex_;
  std::string written_;  // guarded by it
  uint64_t now_ns_ = 1'000'000'000;
};

TEST_F(CanController, TellsItsBitRate) {
  SocketCanBus bus;
  const OpenOutcome outcome = bus.Open(name_, {.bit_rate_bps = 500000});
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(bus.bit_rate_bps(), 500000u);
  EXPECT_TRUE(outcome.message.starts_with(name_ + ": 500000 bit/s, sample point "))
      << outcome.message;
  SocketCanBus other;
  const OpenOutcome wrong = other.Open(name_, {.bit_rate_bps = 250000});
  EXPECT_EQ(wrong.status, Status::kWrongDevice);
  EXPECT_EQ(wrong.message, name_ + ": 500000 bit/s, configured are 250000");
}

TEST_F(CanController, HasItsErrorStatesFollowed) {
  SocketCanBus bus;
  ASSERT_TRUE(bus.Open(name_, {}).ok());
  Tell("sw100100");
  EXPECT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kWarning; }));
  Tell("sp130130");
  EXPECT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kPassive; }));
  Tell("sa000000");
  EXPECT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kActive; }));
  EXPECT_EQ(bus.counters().error_frames, 3u);
}

// SR-DRV07
TEST_F(CanController, IsTakenOutOfBusOff) {
  SocketCanBus bus;
  ASSERT_TRUE(bus.Open(name_, {}).ok());
  Tell("sb256256");
  ASSERT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kBusOff; }));
  ASSERT_TRUE(Until(bus, [&bus] { return !bus.restarting(); }));
  EXPECT_EQ(bus.state(), CanBusState::kBusOff) << "the silence after it is not over";
  for (int i = 0; i < 11; ++i) bus.Advance(now_ns_ += kTick_ns);
  EXPECT_EQ(bus.state(), CanBusState::kActive);
  EXPECT_EQ(bus.counters().bus_offs, 1u);
  EXPECT_EQ(bus.counters().restarts, 1u);
  EXPECT_EQ(bus.counters().went_down, 0u);

  CanFrame frame;
  frame.id = 0x202;
  frame.size = 2;
  frame.data[0] = 0xab;
  EXPECT_EQ(bus.Send(frame, now_ns_ + kTick_ns), Status::kOk);
  EXPECT_TRUE(Until(bus, [this] { return Written().ends_with("t2022AB00\r"); })) << Written();
  LetTheKernelTell(bus);
  EXPECT_EQ(bus.state(), CanBusState::kActive);
  EXPECT_EQ(bus.counters().restarts, 1u);
}

TEST_F(CanController, StaysInBusOffWhereItMayNotBeRestarted) {
  SocketCanBus bus;
  ASSERT_TRUE(bus.Open(name_, {.restart = false}).ok());
  Tell("sb256256");
  ASSERT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kBusOff; }));
  LetTheKernelTell(bus);
  EXPECT_EQ(bus.state(), CanBusState::kBusOff);
  EXPECT_EQ(bus.counters().bus_offs, 1u);
  // Somebody else does it.
  ASSERT_TRUE(Shell("ip link set " + name_ + " down && ip link set " + name_ + " up"));
  EXPECT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kActive; }));
  EXPECT_EQ(bus.counters().went_down, 1u);
}

TEST_F(CanController, IsMissedWhenItIsGone) {
  SocketCanBus bus;
  ASSERT_TRUE(bus.Open(name_, {}).ok());
  ASSERT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kActive; }));
  Pull();
  EXPECT_TRUE(Until(bus, [&bus] { return bus.state() == CanBusState::kDown; }));
  EXPECT_EQ(bus.counters().went_down, 1u);
}

}  // namespace
}  // namespace hardpack
