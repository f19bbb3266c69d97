// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

namespace hardpack {

// Counts by kind what a target accepts, and at the end of the program writes a line `kind count`
// for each to the file that the environment variable HARDPACK_FUZZ_ACCEPTED names:
// tools/proof/fuzz.sh holds the seeds to it, since those that are all refused are none.
class AcceptedKinds {
 public:
  ~AcceptedKinds() {
    if (name_ == nullptr) return;
    std::ofstream file(name_);
    for (const auto& [kind, count] : counts_) file << kind << ' ' << count << '\n';
  }
  void Add(const char* kind) {
    if (name_ != nullptr) ++counts_[kind];
  }

 private:
  const char* name_ = std::getenv("HARDPACK_FUZZ_ACCEPTED");
  std::map<std::string, int64_t> counts_;
};

inline void Accepted(const char* kind) {
  static AcceptedKinds kinds;
  kinds.Add(kind);
}

}  // namespace hardpack
