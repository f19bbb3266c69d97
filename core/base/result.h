// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <type_traits>

#include "core/base/assert.h"
#include "core/base/status.h"

namespace hardpack {

// A value, or the reason why there is none. Holds the value in place: no heap, trivially copyable.
template <typename T>
class [[nodiscard]] Result {
  static_assert(std::is_trivially_copyable_v<T>);
  static_assert(!std::is_same_v<T, Status>, "a Status says it all by itself");

 public:
  // Implicit from either, so that a function may return a value or a Status directly.
  constexpr Result(T value) : value_(value) {}
  // Precondition: not a usable status.
  constexpr Result(Status failure) : status_(failure) { HP_ASSERT(!IsUsable(failure)); }

  constexpr bool ok() const { return IsUsable(status_); }
  constexpr Status status() const { return status_; }

  // Precondition: ok().
  constexpr const T& value() const {
    HP_ASSERT(ok());
    return value_;
  }

 private:
  T value_{};
  Status status_ = Status::kOk;
};

}  // namespace hardpack
