// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "core/timebase/timebase.h"

// A device that stamps datagrams with its own clock, and a network that delays and loses them: all
// in integer nanoseconds of our time, so that the true time of every stamp is known.

namespace hardpack::test {

constexpr int64_t kMillisecond_ns = 1'000'000;
constexpr int64_t kSecond_ns = 1'000'000'000;

struct Datagram {
  int64_t sent_ns = 0;      // our time of the stamp: what ToHost is to give
  uint64_t device_ns = 0;   // the stamp
  int64_t received_ns = 0;  // our time
};

// A stretch of our time in which nothing is delivered; then all at once, or as many a tick.
struct Stall {
  int64_t begin_ns = 0;
  int64_t end_ns = 0;
  bool lost = false;              // what was sent in it never comes
  int64_t drain_interval_ns = 0;  // between two datagrams of the backlog
};

struct ClockScene {
  unsigned seed = 1;
  int64_t duration_ns = 10 * kSecond_ns;
  int64_t interval_ns = kSecond_ns / 640;
  int64_t device_start_ns = 3 * kSecond_ns;
  int64_t our_start_ns = 1000 * kSecond_ns;
  int64_t drift_ppm = 0;    // of the device's clock against ours
  int64_t step_at_ns = -1;  // since the start, our time; -1: no step
  int64_t step_ns = 0;      // of the device's clock
  bool reboot = false;      // at the step the device's clock is set to zero
  double loss = 0.0;
  bool bursts = false;  // now and then delays of up to 20 ms
  int64_t shortest_delay_ns = 100'000;
  int64_t longest_delay_ns = 500'000;
  std::vector<Stall> stalls;  // since the start
};

inline uint64_t DeviceTime(const ClockScene& scene, int64_t since_ns) {
  const int64_t drifted_ns = since_ns + since_ns / 1'000'000 * scene.drift_ppm;
  if (scene.step_at_ns < 0 || since_ns < scene.step_at_ns) {
    return static_cast<uint64_t>(scene.device_start_ns + drifted_ns);
  }
  if (scene.reboot) return static_cast<uint64_t>(since_ns - scene.step_at_ns);
  return static_cast<uint64_t>(scene.device_start_ns + drifted_ns + scene.step_ns);
}

// In the order in which they come. The network keeps the order.
inline std::vector<Datagram> Play(const ClockScene& scene) {
  std::mt19937_64 random(scene.seed);
  std::uniform_int_distribution<int64_t> delay(scene.shortest_delay_ns, scene.longest_delay_ns);
  std::uniform_int_distribution<int64_t> burst(0, 20 * kMillisecond_ns);
  std::uniform_real_distribution<double> chance(0.0, 1.0);
  std::vector<Datagram> datagrams;
  int64_t received_ns = 0;  // since the start, of the last
  for (int64_t since_ns = 0; since_ns < scene.duration_ns; since_ns += scene.interval_ns) {
    int64_t arrival_ns = since_ns + delay(random);
    if (scene.bursts && chance(random) < 0.01) arrival_ns += burst(random);
    bool lost = chance(random) < scene.loss;
    for (const Stall& stall : scene.stalls) {
      if (since_ns >= stall.begin_ns && since_ns < stall.end_ns && stall.lost) lost = true;
      if (arrival_ns >= stall.begin_ns && arrival_ns < stall.end_ns) arrival_ns = stall.end_ns;
      if (arrival_ns >= stall.end_ns && received_ns >= stall.end_ns &&
          since_ns - stall.begin_ns < 20 * (stall.end_ns - stall.begin_ns)) {
        arrival_ns = std::max(arrival_ns, received_ns + stall.drain_interval_ns);
      }
    }
    if (lost) continue;
    received_ns = std::max(received_ns, arrival_ns);
    datagrams.push_back({scene.our_start_ns + since_ns, DeviceTime(scene, since_ns),
                         scene.our_start_ns + received_ns});
  }
  return datagrams;
}

}  // namespace hardpack::test
