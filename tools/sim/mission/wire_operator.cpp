// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/mission/wire_operator.h"

#include <utility>

#include "core/safety/supervisor.h"
#include "port_linux/hardpackctl/code_names.h"
#include "tools/sim/mission/mission.h"

namespace hardpack::mission {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;
using std::chrono::steady_clock;

constexpr std::chrono::milliseconds kAnswer{2000};
constexpr std::chrono::milliseconds kSettle{500};  // for the first columns to come in
constexpr const char* kInterrupted = "interrupted";

bool IsFresh(const control::Age& age) {
  return age.limit_ns == 0 || age.age_ns <= age.limit_ns;
}

bool IsReady(const control::StatusReport& status) {
  const control::AgePart& inputs = status.inputs;
  return status.vehicle.drives_ready && IsFresh(inputs.lidar_age) && IsFresh(inputs.ins_age) &&
         IsFresh(inputs.odometry_age);
}

std::string WhyRefused(const control::Done& answer) {
  if (answer.reason == static_cast<uint8_t>(StopReason::kNone)) return ctl::WordsOf(answer.status);
  return ctl::NameOf(control::FieldKind::kStopReason, answer.reason).name;
}

}  // namespace

WireOperator::~WireOperator() {
  leaving_ = true;
  if (thread_.joinable()) thread_.join();
}

void WireOperator::Start() {
  thread_ = std::thread([this] { Run(); });
}

WireOperator::Said WireOperator::said() const {
  const std::lock_guard lock(mutex_);
  return said_;
}

void WireOperator::Tell(Phase phase, const std::string& message) {
  const std::lock_guard lock(mutex_);
  said_.phase = phase;
  said_.message = message;
}

bool WireOperator::AskStatus(std::string& failure) {
  const ReadOutcome outcome = connection_.AskStatus(status_);
  failure = outcome.message;
  if (!outcome.ok()) return false;
  const std::lock_guard lock(mutex_);
  said_.status = status_;
  ++said_.reports;
  return true;
}

// Requests the status until the condition holds; empty, or the reason why it does not.
std::string WireOperator::Until(const std::string& what, const std::function<bool()>& condition) {
  std::string failure;
  while (!leaving_) {
    if (!AskStatus(failure)) return failure;
    if (condition()) return "";
    if (steady_clock::now() > patience_) return what;
    std::this_thread::sleep_for(kPeriod);
  }
  return kInterrupted;
}

std::string WireOperator::Connect() {
  while (!leaving_) {
    const ReadOutcome outcome = connection_.Open(socket_, kAnswer);
    if (outcome.ok()) return "";
    if (steady_clock::now() > patience_) return outcome.message;
    std::this_thread::sleep_for(4 * kPeriod);
  }
  return kInterrupted;
}

// Repeats a refused request: it may be refused only because some input is too old at that moment.
std::string WireOperator::Arm() {
  while (!leaving_) {
    control::OperatorCommand command;
    command.kind = control::Kind::kArm;
    control::Done answer;
    const ReadOutcome outcome = connection_.Ask(command, answer);
    if (!outcome.ok()) return outcome.message;
    if (IsUsable(answer.status)) return "";
    if (steady_clock::now() > patience_) return "arming was refused: " + WhyRefused(answer);
    std::this_thread::sleep_for(4 * kPeriod);
  }
  return kInterrupted;
}

std::string WireOperator::Go() {
  StampedPose odom;
  odom.position = {status_.vehicle.x_m, status_.vehicle.y_m, 0.0f};
  odom.yaw_rad = status_.vehicle.yaw_rad;
  control::OperatorCommand command = GoalCommand(goal_, waypoints_, WorldFromOdom(start_, odom));
  control::Done answer;
  const ReadOutcome outcome = connection_.Ask(command, answer);
  if (!outcome.ok()) return outcome.message;
  return IsUsable(answer.status) ? "" : "the goal was refused: " + WhyRefused(answer);
}

// Up to the acceptance of the goal. Empty, or the reason of the failure.
std::string WireOperator::Begin() {
  patience_ =
      steady_clock::now() + duration_cast<steady_clock::duration>(duration<double>(wait_s_));
  std::string failure = Connect();
  if (!failure.empty()) return failure;
  failure = Until("the drives and sensors are not ready", [this] { return IsReady(status_); });
  if (!failure.empty()) return failure;
  std::this_thread::sleep_for(kSettle);
  failure = Arm();
  if (!failure.empty()) return failure;
  failure = Until("the drives are not enabled", [this] { return status_.vehicle.drives_enabled; });
  if (!failure.empty()) return failure;
  failure = Go();
  // An earlier status does not include the goal.
  if (failure.empty()) AskStatus(failure);
  return failure;
}

void WireOperator::End(bool is_connected) {
  control::OperatorCommand command;
  command.kind = control::Kind::kDisarm;
  control::Done answer;
  is_connected = is_connected && connection_.Ask(command, answer).ok();
  const auto until =
      steady_clock::now() + duration_cast<steady_clock::duration>(duration<double>(kLeave_s));
  std::string failure;
  while (is_connected && steady_clock::now() < until) {
    is_connected = AskStatus(failure);
    if (status_.vehicle.drives_off) break;
    std::this_thread::sleep_for(kPeriod);
  }
  Tell(Phase::kLeft);
}

void WireOperator::Run() {
  std::string failure = Begin();
  if (!failure.empty()) {
    Tell(Phase::kRefused, failure);
    return;
  }
  Tell(Phase::kDriving);
  bool is_connected = true;
  while (!leaving_) {
    std::this_thread::sleep_for(kPeriod);
    if (!is_connected) continue;
    is_connected = AskStatus(failure);
    if (!is_connected) Tell(Phase::kLost, failure);
  }
  End(is_connected);
}

}  // namespace hardpack::mission
