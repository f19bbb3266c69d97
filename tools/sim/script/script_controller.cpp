// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/script/script_controller.h"

#include <functional>
#include <utility>

#include "tools/sim/script/scripted_vehicle.h"

namespace hardpack::sim::script {
namespace {

// No effect on a vehicle without a controller.
MaybeAction OnController(std::function<void(TwistController&)> act) {
  return [act = std::move(act)](ScriptedVehicle& scripted) {
    if (TwistController* controller = scripted.vehicle().controller()) act(*controller);
  };
}

Command Fault(bool TwistControllerFaults::*member) {
  return {1, 1, [member](const Words& words) -> MaybeAction {
            const auto on = Switch(words[0]);
            if (!on) return std::nullopt;
            return OnController([member, on = *on](TwistController& controller) {
              controller.faults().*member = on;
            });
          }};
}

MaybeAction RaiseFault(const Words& words) {
  const auto bits = Bounded<uint16_t>(words[0]);
  if (!bits) return std::nullopt;
  return OnController([bits = *bits](TwistController& controller) { controller.RaiseFault(bits); });
}

MaybeAction SetVersion(const Words& words) {
  const auto version = Bounded<uint8_t>(words[0]);
  if (!version) return std::nullopt;
  return OnController(
      [version = *version](TwistController& controller) { controller.faults().version = version; });
}

}  // namespace

void AddControllerCommands(std::map<std::string, Command>& commands) {
  commands["controller-silent"] = Fault(&TwistControllerFaults::silent);
  commands["controller-deaf"] = Fault(&TwistControllerFaults::deaf);
  commands["controller-frozen"] = Fault(&TwistControllerFaults::frozen);
  commands["controller-refuses"] = Fault(&TwistControllerFaults::refuses);
  commands["controller-bad-crc"] = Fault(&TwistControllerFaults::bad_crc);
  commands["controller-fault"] = {1, 1, RaiseFault};
  commands["controller-version"] = {1, 1, SetVersion};
  commands["controller-reboot"] = {
      0, 0, [](const Words&) {
        return OnController([](TwistController& controller) { controller.Reboot(); });
      }};
}

}  // namespace hardpack::sim::script
