// SPDX-License-Identifier: Apache-2.0
#include "test/decision/report.h"

#include <cstddef>

#include "core/base/assert.h"

namespace hardpack::decision {
namespace {

// A line being written. Overlong input is a programmer's error.
class Line {
 public:
  void Append(char letter) {
    HP_ASSERT(size_ + 1 < sizeof(text_));
    text_[size_++] = letter;
    text_[size_] = '\0';
  }
  void Append(const char* text) {
    for (; *text != '\0'; ++text) Append(*text);
  }
  const char* text() const { return text_; }

 private:
  char text_[80] = {};
  size_t size_ = 0;
};

void Print(const char* name, uint64_t hash) {
  Line line;
  line.Append("decision ");
  line.Append(name);
  line.Append(' ');
  for (int shift = 60; shift >= 0; shift -= 4) {
    line.Append("0123456789abcdef"[(hash >> shift) & 15u]);
  }
  PrintLine(line.text());
}

}  // namespace

void Report::Add(const char* name, const DecisionHash& hash) {
  Print(name, hash.value());
  total_.AddU64(hash.value());
}

void Report::PrintTotal() {
  Print("total", total_.value());
}

void PrintNumber(const char* prefix, uint32_t value) {
  Line line;
  line.Append(prefix);
  line.Append(' ');
  uint32_t divisor = 1;
  while (value / divisor >= 10) divisor *= 10;
  for (; divisor > 0; divisor /= 10) line.Append("0123456789"[value / divisor % 10]);
  PrintLine(line.text());
}

void PrintStatus(const char* prefix, Status status) {
  Line line;
  line.Append(prefix);
  line.Append(' ');
  line.Append(StatusName(status));
  PrintLine(line.text());
}

}  // namespace hardpack::decision
