// SPDX-License-Identifier: Apache-2.0
#include "test/fakes/memory_can_bus.h"

#include "test/hal/conformance/can_bus_conformance.h"

namespace hardpack {
namespace {

class MemoryCanHarness {
 public:
  static constexpr int kMalformedKinds = 1;

  const char* unavailable() const { return nullptr; }
  CanBus& bus() { return bus_; }
  void PeerSend(const CanFrame& frame) { (void)peer_.Send(frame, UINT64_MAX); }
  void PeerSendMalformed() { wire_.PutMalformed(); }
  bool PeerReceive(CanFrame& frame) { return IsUsable(peer_.Receive(frame)); }
  void TakeDown() { bus_.TakeDown(); }
  void BringUp() { bus_.BringUp(); }
  void InjectBusOff() { bus_.EnterBusOff(); }
  void InjectErrorState(CanBusState state) { bus_.SetErrorState(state); }
  bool CanStall() const { return true; }
  void Stall() { wire_.Stall(); }
  void Resume() { wire_.Resume(); }
  bool Busy() const { return false; }
  void Settle() {}

 private:
  fakes::MemoryCanWire wire_;
  fakes::MemoryCanBus bus_{wire_};
  fakes::MemoryCanBus peer_{wire_};
};

INSTANTIATE_TYPED_TEST_SUITE_P(Memory, CanBusConformance, MemoryCanHarness);

}  // namespace
}  // namespace hardpack
