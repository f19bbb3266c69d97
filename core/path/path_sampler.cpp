// SPDX-License-Identifier: Apache-2.0
#include "core/base/saturate.h"
#include "core/path/path.h"

namespace hardpack {
namespace {

float DistanceBetween(Vec2 a, Vec2 b) {
  const float dx = b.x_m - a.x_m;
  const float dy = b.y_m - a.y_m;
  return Sqrt(dx * dx + dy * dy);
}

}  // namespace

void PathSampler::End(Status status) {
  status_ = status;
  phase_ = Phase::kIdle;
}

Status PathSampler::Begin(const AstarSearch& search, const PathParams& params, Vec2 start_odom,
                          Vec2 goal_odom) {
  const AstarResult& found = search.result();
  path_.Clear();
  End(Status::kNotStarted);
  if (!IsFinite(start_odom) || !IsFinite(goal_odom)) {
    End(Status::kNotFinite);
  } else if (!(params.step_m >= kMinStep_m)) {
    End(Status::kParameterOutOfRange);
  } else if (IsUsable(found.status) && found.path_cells > 0) {
    wanted_step_m_ = params.step_m;
    start_ = start_odom;
    end_ = CellAt(goal_odom) == found.end ? goal_odom : CellCenter(found.end);
    first_cell_ = found.start;
    legs_ = found.path_cells > 1 ? found.path_cells - 1 : 1;
    length_m_ = 0.0f;
    BeginWalk();
    phase_ = Phase::kLength;
    return Status::kOk;
  }
  return status_;
}

void PathSampler::BeginWalk() {
  vertex_ = start_;
  cell_ = first_cell_;
  leg_ = 0;
}

// The polyline's next corner; also moves the walk's cell there.
Vec2 PathSampler::NextVertex(const AstarSearch& search) {
  ++leg_;
  if (leg_ == legs_) return end_;
  cell_ = search.Next(cell_);
  return CellCenter(cell_);
}

void PathSampler::AddLength(const AstarSearch& search) {
  const Vec2 next = NextVertex(search);
  length_m_ += DistanceBetween(vertex_, next);
  vertex_ = next;
}

void PathSampler::ChooseStep() {
  int steps = RoundToInt(length_m_ / wanted_step_m_);
  if (steps < kMinPathSteps) steps = kMinPathSteps;
  step_m_ = length_m_ / static_cast<float>(steps);
  cut_ = steps > kMaxPathPoints - 1;
  points_ = cut_ ? kMaxPathPoints : steps + 1;
  until_next_m_ = step_m_;
  path_.Resize(1);
  path_[0] = {start_.x_m, start_.y_m, 0.0f};
}

// Emits the points that lie on one leg. A finished path's end is not among them: it is set exactly.
void PathSampler::AddPoints(const AstarSearch& search) {
  const Vec2 next = NextVertex(search);
  const float leg_m = DistanceBetween(vertex_, next);
  const int between = cut_ ? points_ : points_ - 1;
  HP_LOOP_BOUND(kMaxPathPoints)
  while (until_next_m_ <= leg_m && path_.size() < between) {
    const float share = until_next_m_ / leg_m;
    const int at = path_.size();
    path_.Resize(at + 1);
    path_[at] = {vertex_.x_m + share * (next.x_m - vertex_.x_m),
                 vertex_.y_m + share * (next.y_m - vertex_.y_m), 0.0f};
    until_next_m_ += step_m_;
  }
  until_next_m_ -= leg_m;
  vertex_ = next;
}

void PathSampler::DoUnit(const AstarSearch& search) {
  if (phase_ == Phase::kLength) {
    AddLength(search);
    if (leg_ < legs_) return;
    if (!(length_m_ >= kMinPathLength_m)) return End(Status::kPathTooShort);
    ChooseStep();
    BeginWalk();
    phase_ = Phase::kPoints;
  } else if (phase_ == Phase::kPoints) {
    AddPoints(search);
    if (leg_ < legs_ && !path_.full()) return;
    if (!cut_) {
      path_.Resize(path_.size() + 1);
      path_.back() = {end_.x_m, end_.y_m, 0.0f};
    }
    phase_ = Phase::kHeadings;
  } else {
    SetHeadingsFromChords(path_);
    End(cut_ ? Status::kPathCut : Status::kOk);
  }
}

Progress PathSampler::Step(const AstarSearch& search, int units) {
  HP_LOOP_BOUND(kMaxUnits)
  for (int unit = 0; unit < units && phase_ != Phase::kIdle; ++unit) DoUnit(search);
  return phase_ == Phase::kIdle ? Progress::kDone : Progress::kBusy;
}

}  // namespace hardpack
