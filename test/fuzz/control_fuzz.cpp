// SPDX-License-Identifier: Apache-2.0
// Any bytes as a message between an operator's program and the onboard program: decoded as each
// sort there is; what is taken is encoded to the same bytes again. The first byte chooses whether
// magic, version and size are put right, the second the kind; a report gets its table's number.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <vector>

#include "hal/onboard/control/messages.h"
#include "hal/onboard/control/status_report.h"
#include "test/fuzz/accepted.h"

using namespace hardpack;
using Bytes = std::vector<uint8_t>;

namespace {

void Require(bool condition) {
  if (!condition) std::abort();
}

Bytes Report() {
  Bytes bytes(control::kMaxMessageBytes);
  int size_bytes = 0;
  Require(Encode(control::StatusReport{}, 0, bytes, size_bytes) == Status::kOk);
  bytes.resize(static_cast<size_t>(size_bytes));
  return bytes;
}

void FixHeader(Bytes& bytes, uint8_t choice) {
  static const Bytes report = Report();
  if (bytes.size() < control::kHeaderBytes) return;
  constexpr uint8_t kKinds[] = {1, 2, 3, 3, 3, 4, 5, 6, 64, 65, 128, 129, 129, 130, 10, 10, 11};
  bytes[5] = kKinds[choice % sizeof(kKinds)];
  if (bytes[5] == static_cast<uint8_t>(control::Kind::kStatus)) {
    bytes.resize(report.size());
    std::copy_n(report.begin() + control::kHeaderBytes, 4, bytes.begin() + control::kHeaderBytes);
  }
  std::copy_n(report.begin(), 5, bytes.begin());
  bytes[6] = static_cast<uint8_t>(bytes.size());
  bytes[7] = static_cast<uint8_t>(bytes.size() >> 8);
}

template <typename Message>
bool RoundTrips(const Bytes& bytes, const char* sort) {
  Message message;
  if (Decode(bytes, message) != Status::kOk) return false;
  Accepted(sort);
  Bytes again(bytes.size());
  int size_bytes = 0;
  Require(Encode(message, again, size_bytes) == Status::kOk);
  Require(static_cast<size_t>(size_bytes) == bytes.size() && again == bytes);
  return true;
}

bool ReportRoundTrips(const Bytes& bytes, uint32_t sequence) {
  static control::StatusReport report;
  if (Decode(bytes, report) != Status::kOk) return false;
  Accepted("status");
  Bytes again(bytes.size());
  int size_bytes = 0;
  Require(Encode(report, sequence, again, size_bytes) == Status::kOk);
  Require(static_cast<size_t>(size_bytes) == bytes.size() && again == bytes);
  return true;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size < 2) return 0;
  Bytes bytes(data + 2, data + size);
  if (data[0] % 4 != 0) FixHeader(bytes, data[1]);

  control::Header header;
  const Status status = ReadHeader(bytes, header);
  const int taken = RoundTrips<control::OperatorCommand>(bytes, "command") +
                    RoundTrips<control::Question>(bytes, "question") +
                    RoundTrips<control::Done>(bytes, "done") +
                    RoundTrips<control::ParametersPart>(bytes, "parameters") +
                    ReportRoundTrips(bytes, header.sequence);
  Require(taken <= (status == Status::kOk ? 1 : 0));
  return 0;
}
