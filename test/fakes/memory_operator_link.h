// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "hal/onboard/control/operator_link.h"

namespace hardpack::fakes {

// An OperatorLink whose clients are in memory. The bytes that Receive gives are overwritten by the
// next Receive, so that a use of stale ones shows.
class MemoryOperatorLink final : public OperatorLink {
 public:
  using Bytes = std::vector<uint8_t>;
  static constexpr uint32_t kUser = 1000;

  // A client connects; its number is what the calls below take.
  size_t Connect() {
    clients_.emplace_back();
    ++counters_.clients;
    ++counters_.connected;
    return clients_.size() - 1;
  }
  void Leave(size_t client) {
    clients_[client] = {};
    clients_[client].is_connected = false;
    --counters_.connected;
  }
  void Say(size_t client, const Bytes& bytes) { clients_[client].said.push_back(bytes); }
  // The oldest answer that it has not read; empty: there is none.
  Bytes Read(size_t client) {
    std::deque<Bytes>& answers = clients_[client].answers;
    if (answers.empty()) return {};
    Bytes bytes = answers.front();
    answers.pop_front();
    return bytes;
  }

  [[nodiscard]] bool Receive(ControlMessage& message) override {
    std::fill(given_.begin(), given_.end(), uint8_t{0xdd});
    for (size_t i = 0; i < clients_.size(); ++i) {
      const size_t place = (next_ + i) % clients_.size();
      std::deque<Bytes>& said = clients_[place].said;
      if (said.empty()) continue;
      const Bytes bytes = said.front();
      said.pop_front();
      if (!Take(place, bytes, message)) continue;
      next_ = place + 1;
      return true;
    }
    return false;
  }

  void Answer(const ControlClient& client, std::span<const uint8_t> bytes) override {
    const auto place = static_cast<size_t>(client.place);
    if (client.place < 0 || place >= clients_.size() || client.number != place + 1) return;
    if (clients_[place].is_connected)
      clients_[place].answers.push_back({bytes.begin(), bytes.end()});
  }

  const control::ControlCounters& counters() const override { return counters_; }

 private:
  struct Client {
    bool is_connected = true;
    std::deque<Bytes> said;
    std::deque<Bytes> answers;
  };

  bool Take(size_t place, const Bytes& bytes, ControlMessage& message) {
    control::Header header;
    Status status = control::ReadHeader(bytes, header);
    if (IsUsable(status) && control::IsAnswer(header.kind)) status = Status::kWrongPacketType;
    const ControlClient client = {static_cast<int32_t>(place), place + 1};
    if (!IsUsable(status)) {
      ++counters_.malformed;
      std::array<uint8_t, 32> answer{};
      int size_bytes = 0;
      const control::Done done{header.sequence, status, 0};
      if (!IsUsable(control::Encode(done, answer, size_bytes))) return false;
      Answer(client, std::span(answer).first(static_cast<size_t>(size_bytes)));
      return false;
    }
    ++counters_.messages;
    std::copy(bytes.begin(), bytes.end(), given_.begin());
    message = {client, kUser, header, std::span(given_).first(bytes.size())};
    return true;
  }

  std::deque<Client> clients_;
  size_t next_ = 0;
  std::array<uint8_t, control::kMaxMessageBytes> given_{};
  control::ControlCounters counters_;
};

}  // namespace hardpack::fakes
