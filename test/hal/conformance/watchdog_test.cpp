// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <stddef.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "port_linux/service_watchdog.h"
#include "test/fakes/counting_watchdog.h"
#include "tools/allocation_counter/allocation_counter.h"

// What every Watchdog has to do (hal/watchdog.h): to be told at least once in its period, and no
// more than needed.

namespace hardpack {
namespace {

constexpr uint64_t kMillisecond_ns = 1'000'000;
constexpr uint64_t kPeriod_ns = 200 * kMillisecond_ns;

void SetVariable(const char* name, const std::string& value) {
  setenv(name, value.c_str(), 1);
}

// Stands in for systemd: a datagram socket, and the variables that name it.
class ServiceManager {
 public:
  // `path` as in NOTIFY_SOCKET.
  explicit ServiceManager(const std::string& path)
      : socket_(socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0)) {
    Forget();
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::memcpy(address.sun_path, path.data(), path.size());
    if (path[0] == '@') address.sun_path[0] = '\0';
    const size_t size = offsetof(sockaddr_un, sun_path) + path.size();
    EXPECT_EQ(bind(socket_.get(), reinterpret_cast<const sockaddr*>(&address),
                   static_cast<socklen_t>(size)),
              0);
    SetVariable("NOTIFY_SOCKET", path);
  }
  ~ServiceManager() { Forget(); }

  std::vector<std::string> Messages() {
    std::vector<std::string> messages;
    char text[256];
    for (ssize_t got; (got = recv(socket_.get(), text, sizeof(text), 0)) > 0;) {
      messages.emplace_back(text, static_cast<size_t>(got));
    }
    return messages;
  }

  static void Forget() {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }

 private:
  FileDescriptor socket_;
};

std::string AbstractName() {
  return "@hardpack-test-" + std::to_string(getpid());
}

struct FakeHarness {
  Watchdog& watchdog() { return watchdog_; }
  fakes::CountingWatchdog watchdog_{kPeriod_ns};
};

struct ServiceHarness {
  ServiceHarness() {
    SetVariable("WATCHDOG_USEC", "200000");
    const OpenOutcome outcome = watchdog_.Open();
    EXPECT_TRUE(outcome.ok()) << outcome.message;
  }
  Watchdog& watchdog() { return watchdog_; }
  ServiceManager manager_{AbstractName()};
  ServiceWatchdog watchdog_;
};

template <typename Harness>
class WatchdogConformance : public ::testing::Test {
 protected:
  Harness harness_;
};

using Harnesses = testing::Types<FakeHarness, ServiceHarness>;
TYPED_TEST_SUITE(WatchdogConformance, Harnesses);

// SR-PGM02
TYPED_TEST(WatchdogConformance, IsFedOftenEnoughAndNoMoreThanNeeded) {
  Watchdog& watchdog = this->harness_.watchdog();
  watchdog.Ready();
  uint64_t now_ns = 12345;
  uint64_t last_ns = 0;
  for (int tick = 0; tick < 1000; ++tick) {
    const uint64_t before = watchdog.fed();
    watchdog.Feed(now_ns);
    if (watchdog.fed() != before) {
      if (tick > 0) {
        EXPECT_LE(now_ns - last_ns, kPeriod_ns / 2 + 10 * kMillisecond_ns);
        EXPECT_GE(now_ns - last_ns, kPeriod_ns / 4);
      }
      last_ns = now_ns;
    }
    now_ns += 10 * kMillisecond_ns;
  }
  EXPECT_GT(watchdog.fed(), 0u);
  watchdog.Stopping();
}

TYPED_TEST(WatchdogConformance, PassesTheFirstFeedOn) {
  this->harness_.watchdog().Feed(1);
  EXPECT_EQ(this->harness_.watchdog().fed(), 1u);
}

TEST(CountingWatchdog, SaysWhenItWouldHaveEndedTheProgram) {
  fakes::CountingWatchdog watchdog(kPeriod_ns);
  watchdog.Feed(1);
  watchdog.Feed(1 + kPeriod_ns);
  EXPECT_FALSE(watchdog.expired());
  watchdog.Feed(2 + 2 * kPeriod_ns);
  EXPECT_TRUE(watchdog.expired());
}

// SR-PGM02
TEST(ServiceWatchdog, SpeaksTheManagersProtocol) {
  const std::string path =
      std::filesystem::temp_directory_path() / ("hardpack-notify-" + std::to_string(getpid()));
  for (const std::string& name : {AbstractName(), path}) {
    ServiceManager manager(name);
    SetVariable("WATCHDOG_USEC", "200000");
    SetVariable("WATCHDOG_PID", std::to_string(getpid()));
    ServiceWatchdog watchdog;
    const OpenOutcome outcome = watchdog.Open();
    ASSERT_TRUE(outcome.ok()) << outcome.message;
    EXPECT_EQ(outcome.message, "watchdog: the service manager's time-out is 200 ms");
    EXPECT_EQ(watchdog.period_ns(), kPeriod_ns);
    watchdog.Ready();
    watchdog.Feed(1);
    watchdog.Feed(2);
    watchdog.Feed(1 + kPeriod_ns / 2);
    watchdog.Stopping();
    EXPECT_EQ(manager.Messages(),
              (std::vector<std::string>{"READY=1", "WATCHDOG=1", "WATCHDOG=1", "STOPPING=1"}));
  }
  unlink(path.c_str());
}

TEST(ServiceWatchdog, FeedsNobodyWhereNobodyWatches) {
  ServiceManager::Forget();
  ServiceWatchdog alone;
  EXPECT_EQ(alone.Open().message, "watchdog: no service manager");
  ServiceManager manager(AbstractName());
  ServiceWatchdog unwatched;
  EXPECT_EQ(unwatched.Open().message, "watchdog: not enabled by the service manager");
  SetVariable("WATCHDOG_USEC", "200000");
  SetVariable("WATCHDOG_PID", "1");
  ServiceWatchdog another;  // process is meant
  ASSERT_TRUE(another.Open().ok());
  for (ServiceWatchdog* watchdog : {&alone, &unwatched, &another}) {
    watchdog->Ready();
    watchdog->Feed(1);
    watchdog->Stopping();
    EXPECT_EQ(watchdog->fed(), 0u);
  }
  EXPECT_EQ(manager.Messages(),
            (std::vector<std::string>{"READY=1", "STOPPING=1", "READY=1", "STOPPING=1"}));
}

TEST(ServiceWatchdog, SaysWhatMakesNoSense) {
  const auto why = [](const char* name, const std::string& value) {
    ServiceManager manager(AbstractName());
    SetVariable("WATCHDOG_USEC", "200000");
    SetVariable(name, value);
    ServiceWatchdog watchdog;
    const OpenOutcome outcome = watchdog.Open();
    EXPECT_FALSE(outcome.ok()) << name << "=" << value;
    EXPECT_EQ(watchdog.period_ns(), 0u);
    return outcome.message;
  };
  EXPECT_EQ(why("WATCHDOG_USEC", "0"), "WATCHDOG_USEC=0");
  EXPECT_EQ(why("WATCHDOG_USEC", "2 s"), "WATCHDOG_USEC=2 s");
  EXPECT_EQ(why("WATCHDOG_USEC", ""), "WATCHDOG_USEC=");
  EXPECT_EQ(why("WATCHDOG_USEC", "99999999999999999999"), "WATCHDOG_USEC=99999999999999999999");
  EXPECT_EQ(why("WATCHDOG_PID", "me"), "WATCHDOG_PID=me");
  EXPECT_EQ(why("NOTIFY_SOCKET", "vsock:2:1"), "NOTIFY_SOCKET=vsock:2:1: neither a path nor @name");
  EXPECT_EQ(why("NOTIFY_SOCKET", "@"), "NOTIFY_SOCKET=@: neither a path nor @name");
  EXPECT_EQ(why("NOTIFY_SOCKET", "/" + std::string(200, 'a')),
            "NOTIFY_SOCKET=/" + std::string(200, 'a') + ": too long");
  EXPECT_EQ(why("NOTIFY_SOCKET", "/nosuch/socket"),
            "NOTIFY_SOCKET=/nosuch/socket: No such file or directory");
}

// A manager that does not read fills its socket's queue: no call waits, and nothing counts as fed.
// SR-PGM02
TEST(ServiceWatchdog, DoesNotWaitForASlowManagerAndTriesAgain) {
  ServiceHarness harness;
  uint64_t now_ns = 1;
  uint64_t before = 0;
  do {
    before = harness.watchdog().fed();
    harness.watchdog().Feed(now_ns);
    now_ns += kPeriod_ns;
  } while (harness.watchdog().fed() != before && before < 100000);
  EXPECT_LT(before, 100000u);
  harness.watchdog().Ready();
  EXPECT_EQ(harness.manager_.Messages().size(), before);
  harness.watchdog().Feed(now_ns);
  EXPECT_EQ(harness.watchdog().fed(), before + 1);
  EXPECT_EQ(harness.manager_.Messages(), (std::vector<std::string>{"READY=1", "WATCHDOG=1"}));
}

TEST(ServiceWatchdog, AllocatesNothingOnceItIsOpen) {
  if (!command::AllocationsAreCounted()) GTEST_SKIP() << "allocations are not counted here";
  ServiceHarness harness;
  const int64_t before = command::AllocationCount();
  harness.watchdog().Ready();
  for (uint64_t i = 1; i < 100; ++i) harness.watchdog().Feed(i * 10 * kMillisecond_ns);
  harness.watchdog().Stopping();
  EXPECT_EQ(command::AllocationCount(), before);
}

}  // namespace
}  // namespace hardpack
