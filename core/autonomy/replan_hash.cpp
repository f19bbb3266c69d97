// SPDX-License-Identifier: Apache-2.0
#include "core/autonomy/replanner.h"
#include "core/base/loop_bound.h"

namespace hardpack {

void AddToHash(const CommittedPlan& plan, DecisionHash& hash) {
  hash.AddU32(plan.number);
  hash.AddU8(static_cast<uint8_t>(plan.status));
  hash.AddI32(plan.path.size());
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const Pose2& pose : plan.path) hash.AddPose(pose);
  HP_LOOP_BOUND(kMaxPathPoints)
  for (const float speed_mps : plan.speed) hash.AddFloat(speed_mps);
  hash.AddFloat(plan.start_along_m);
  hash.AddFloat(plan.start_curvature_per_m);
  hash.AddFloat(plan.start_turn_rad);
  hash.AddI32(plan.slow_points);
  hash.AddBool(plan.narrow);
  hash.AddBool(plan.creeps);
  hash.AddBool(plan.is_stop);
  hash.AddBool(plan.reaches_goal);
}

void AddToHash(const Replanner& replanner, DecisionHash& hash) {
  AddToHash(replanner.committed(), hash);
  const ReplanOutcome& outcome = replanner.outcome();
  hash.AddU8(static_cast<uint8_t>(outcome.decision));
  hash.AddU8(static_cast<uint8_t>(outcome.reason));
  hash.AddU8(static_cast<uint8_t>(outcome.status));
  hash.AddU8(static_cast<uint8_t>(outcome.plan_status));
  hash.AddBool(outcome.anchored);
  hash.AddBool(outcome.late);
  hash.AddFloat(outcome.committed_cost);
  hash.AddFloat(outcome.new_cost);
  const ReplanCounters& counters = replanner.counters();
  hash.AddU32(counters.plans);
  hash.AddU32(counters.kept);
  hash.AddU32(counters.extended);
  HP_LOOP_BOUND(kReplanReasons)
  for (const uint32_t replaced : counters.replaced) hash.AddU32(replaced);
  hash.AddU32(counters.stopped);
  hash.AddU32(counters.failed);
  hash.AddU32(counters.reanchored);
  hash.AddU32(counters.late);
  hash.AddU32(counters.refused);
}

}  // namespace hardpack
