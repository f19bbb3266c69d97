// SPDX-License-Identifier: Apache-2.0
// Random streams with loss, repetition, reordering, restarts and silence against a slow reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <vector>

#include "core/scan/scan.h"

namespace hardpack {
namespace {

// A column by the sensor's true count of revolutions, which does not wrap.
struct Sent {
  int64_t revolution = 0;
  int id = 0;
  auto operator<=>(const Sent&) const = default;
};

struct Shape {
  int beams = 1;
  int columns = 0;
  int window_first = 0;
  int window_last = 0;
  int revolutions_held = 0;

  // Measurement ids in the order in which they come.
  std::vector<int> Window() const {
    std::vector<int> ids;
    for (int id = 0; id < columns; ++id) {
      const bool inside = window_first <= window_last ? id >= window_first && id <= window_last
                                                      : id >= window_first || id <= window_last;
      if (inside) ids.push_back(id);
    }
    return ids;
  }
};

// What the ring should hold and count, told by sets of all that ever came.
class Reference {
 public:
  explicit Reference(const Shape& shape) : shape_(shape), window_(shape.Window()) {}

  Status Push(const Sent& sent) {
    if (!filed_.empty()) {
      const Sent& newest = *filed_.rbegin();
      const int64_t ahead = sent.revolution - newest.revolution;
      if (ahead > ScanRing::kMaxFrameGap || ahead < -ScanRing::kMaxFrameGap) {
        ++restarts_;
        return Status::kSensorRestarted;
      }
      if (Sent{sent.revolution + shape_.revolutions_held, sent.id} <= newest) {
        ++too_late_;
        return Status::kLate;
      }
      if (filed_.count(sent) != 0) {
        ++duplicates_;
        return Status::kDuplicate;
      }
      if (sent.revolution > newest.revolution) End();
      if (sent <= end_) ++late_;
      if (sent.revolution > newest.revolution) {
        for (int64_t r = newest.revolution + 1; r < sent.revolution; ++r) ++incomplete_;
        revolutions_ += sent.revolution - newest.revolution;
        ended_ = false;
      }
    } else {
      end_ = sent;
      ended_ = false;
      ++revolutions_;
    }
    end_ = std::max(end_, sent);
    filed_.insert(sent);
    const int64_t column = sent.revolution * shape_.columns + sent.id;
    slots_[Modulo(column)] = sent;
    return Status::kOk;
  }

  void End() {
    if (filed_.empty() || ended_) return;
    ended_ = true;
    const int64_t revolution = filed_.rbegin()->revolution;
    end_ = {revolution, window_.back()};
    bool complete = true;
    for (const int id : window_) {
      const Sent expected{revolution, id};
      if (expected > *filed_.begin() && filed_.count(expected) == 0) complete = false;
    }
    if (!complete) ++incomplete_;
  }

  void Restart() {
    columns_before_ += filed_.size();
    missing_before_ += Missing();
    filed_.clear();
    slots_.clear();
  }

  uint64_t Columns() const { return columns_before_ + filed_.size(); }

  // Of all columns of the window from the first to the last, those that are not there.
  uint64_t Missing() const {
    if (filed_.empty()) return 0;
    uint64_t missing = 0;
    for (int64_t r = filed_.begin()->revolution; r <= end_.revolution; ++r) {
      for (const int id : window_) {
        const Sent expected{r, id};
        if (expected < *filed_.begin() || expected > end_) continue;
        if (filed_.count(expected) == 0) ++missing;
      }
    }
    return missing;
  }

  void Compare(const ScanRing& ring) const {
    const ScanCounters& counters = ring.counters();
    ASSERT_EQ(counters.columns, Columns());
    ASSERT_EQ(counters.missing_columns, missing_before_ + Missing());
    ASSERT_EQ(counters.duplicates, duplicates_);
    ASSERT_EQ(counters.late_columns, late_);
    ASSERT_EQ(counters.too_late_columns, too_late_);
    ASSERT_EQ(counters.restarts, restarts_);
    ASSERT_EQ(counters.revolutions, static_cast<uint64_t>(revolutions_));
    ASSERT_EQ(counters.incomplete_revolutions, incomplete_);
    size_t held = 0;
    for (int slot = 0; slot < ring.slots(); ++slot) {
      held += ring.column(slot).state != ColumnState::kAbsent ? 1u : 0u;
    }
    ASSERT_EQ(held, slots_.size());
    if (filed_.empty()) {
      ASSERT_EQ(ring.newest_sequence(), -1);
      return;
    }
    const Sent& newest = *filed_.rbegin();
    for (const auto& [slot, sent] : slots_) {
      const int64_t sequence = ring.newest_sequence() +
                               (sent.revolution - newest.revolution) * shape_.columns + sent.id -
                               newest.id;
      ASSERT_TRUE(ring.Holds(sequence));
      const int where = ring.SlotOf(sequence);
      const ScanColumn& column = ring.column(where);
      ASSERT_EQ(column.sequence, sequence);
      ASSERT_EQ(column.frame_id, static_cast<uint16_t>(sent.revolution));
      ASSERT_EQ(column.measurement_id, sent.id);
      ASSERT_EQ(column.time_ns, Time(sent));
      ASSERT_EQ(ring.at(where, shape_.beams - 1).range_mm(), Range(sent, shape_.beams - 1));
    }
  }

  static uint64_t Time(const Sent& sent) {
    return static_cast<uint64_t>(sent.revolution) * 100'000'000u + static_cast<uint64_t>(sent.id);
  }
  static uint32_t Range(const Sent& sent, int row) {
    return static_cast<uint32_t>(sent.revolution % 200 * 2048 + sent.id + row);
  }

 private:
  int64_t Modulo(int64_t column) const {
    return column % (int64_t{shape_.columns} * shape_.revolutions_held);
  }

  Shape shape_;
  std::vector<int> window_;
  std::set<Sent> filed_;           // since the last restart
  std::map<int64_t, Sent> slots_;  // the last that came
  Sent end_;                       // the last that is filed or missing
  bool ended_ = false;
  uint64_t columns_before_ = 0;
  uint64_t missing_before_ = 0;
  uint64_t duplicates_ = 0;
  uint64_t late_ = 0;
  uint64_t too_late_ = 0;
  uint64_t restarts_ = 0;
  uint64_t incomplete_ = 0;
  int64_t revolutions_ = 0;
};

class ScanRingStream : public ::testing::Test {
 protected:
  int Below(int limit) { return static_cast<int>(random_() % static_cast<unsigned>(limit)); }
  bool OneIn(int count) { return Below(count) == 0; }

  Shape RandomShape() {
    // Few columns of long revolutions: the ring then holds only 3, 6 or 12 of them.
    Shape shape;
    shape.columns = 512 << Below(3);
    shape.revolutions_held = ScanRing::kMaxColumns / shape.columns;
    shape.beams = 1 + Below(3);
    shape.window_first = Below(shape.columns);
    shape.window_last = (shape.window_first + Below(24)) % shape.columns;
    return shape;
  }

  // Twenty revolutions or more of a stream, in the order in which it comes.
  std::vector<Sent> RandomStream(const Shape& shape) {
    const std::vector<int> window = shape.Window();
    std::vector<std::pair<int64_t, Sent>> stream;
    int64_t revolution = 65536 + 65520 + Below(20);
    int64_t now = 0;
    const int loss = 2 + Below(30);
    const int delay = 2 + Below(100);
    for (int i = 0; i < 20; ++i) {
      for (const int id : window) {
        ++now;
        if (OneIn(loss)) continue;
        int64_t comes = now;
        if (OneIn(4)) comes += Below(6);
        // By whole revolutions, so that some come too late.
        if (OneIn(delay)) comes += Below(15) * static_cast<int64_t>(window.size());
        stream.push_back({comes, {revolution, id}});
        if (OneIn(16)) stream.push_back({comes + Below(40), {revolution, id}});
      }
      revolution += NextStep();
    }
    std::stable_sort(stream.begin(), stream.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Sent> sent;
    sent.reserve(stream.size());
    for (const auto& [comes, column] : stream) sent.push_back(column);
    return sent;
  }

  int64_t NextStep() {
    if (OneIn(20)) return 2 + Below(ScanRing::kMaxFrameGap - 1);
    if (OneIn(40)) return ScanRing::kMaxFrameGap + 1 + Below(1000);
    if (OneIn(40)) return -ScanRing::kMaxFrameGap - 1 - Below(1000);
    return OneIn(10) ? 2 : 1;
  }

  Status Push(const Sent& sent, const Shape& shape) {
    column_->frame_id = static_cast<uint16_t>(sent.revolution);
    column_->measurement_id = static_cast<uint16_t>(sent.id);
    column_->valid = true;
    column_->beams = shape.beams;
    for (int row = 0; row < shape.beams; ++row) {
      column_->range_mm[row] = Reference::Range(sent, row);
    }
    const std::vector<uint8_t> self(static_cast<size_t>(shape.beams), 0);
    return ring_->Push(*column_, Reference::Time(sent), Transform3{}, self);
  }

  std::mt19937 random_;
  std::unique_ptr<ScanRing> ring_ = std::make_unique<ScanRing>();
  std::unique_ptr<LidarColumn> column_ = std::make_unique<LidarColumn>();
};

TEST_F(ScanRingStream, HoldsAndCountsWhatTheReferenceDoes) {
  std::map<Status, int> met;
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE(seed);
    random_.seed(seed);
    const Shape shape = RandomShape();
    ASSERT_EQ(ring_->Configure(shape.beams, shape.columns, shape.window_first, shape.window_last),
              Status::kOk);
    ASSERT_EQ(ring_->slots(), shape.columns * shape.revolutions_held);
    Reference reference(shape);
    for (const Sent& sent : RandomStream(shape)) {
      const Status expected = reference.Push(sent);
      ASSERT_EQ(Push(sent, shape), expected);
      ++met[expected];
      if (expected == Status::kSensorRestarted && OneIn(2)) {
        reference.Restart();
        ring_->Restart();
      }
      if (OneIn(50)) {
        reference.End();
        ring_->EndRevolution();
      }
      if (OneIn(40)) {
        ASSERT_NO_FATAL_FAILURE(reference.Compare(*ring_));
      }
    }
    ASSERT_NO_FATAL_FAILURE(reference.Compare(*ring_));
  }
  // The streams were as bad as they should be.
  EXPECT_GT(met[Status::kOk], 10000);
  EXPECT_GT(met[Status::kDuplicate], 100);
  EXPECT_GT(met[Status::kLate], 100);
  EXPECT_GT(met[Status::kSensorRestarted], 100);
}

// Bytes that make no sense: whatever comes is filed or refused, and the sum is right.
TEST_F(ScanRingStream, AccountsForEveryColumnOfNoise) {
  const unsigned seed = 9;
  SCOPED_TRACE(seed);
  random_.seed(seed);
  ASSERT_EQ(ring_->Configure(64, 1024, 1000, 20), Status::kOk);
  std::vector<uint8_t> self(64, 0);
  uint32_t pushed = 0;
  for (; pushed < 20000; ++pushed) {
    column_->frame_id = static_cast<uint16_t>(OneIn(50) ? Below(65536) : Below(120));
    column_->measurement_id = static_cast<uint16_t>(OneIn(10) ? Below(65536) : Below(1024));
    column_->beams = OneIn(10) ? static_cast<int32_t>(random_()) : 64;
    column_->valid = !OneIn(10);
    column_->returns = static_cast<int32_t>(random_());
    column_->range_mm[Below(64)] = static_cast<uint32_t>(random_());
    column_->second_range_mm[Below(64)] = static_cast<uint32_t>(random_());
    const Status status = ring_->Push(*column_, random_(), Transform3{}, self);
    if (status == Status::kSensorRestarted && OneIn(3)) ring_->Restart();
    int64_t sequence = 0;
    static_cast<void>(ring_->FindForLabels(static_cast<uint16_t>(Below(65536)),
                                           static_cast<uint16_t>(random_()), sequence));
    EXPECT_GE(sequence, 0);
  }
  const ScanCounters& counters = ring_->counters();
  EXPECT_EQ(counters.columns + counters.duplicates + counters.invalid_columns +
                counters.bad_columns + counters.too_late_columns + counters.restarts,
            pushed);
  EXPECT_GT(counters.columns, 100u);
}

}  // namespace
}  // namespace hardpack
