// SPDX-License-Identifier: Apache-2.0
#include "tools/sim/sim_ins.h"

#include <bit>
#include <cmath>
#include <numbers>

namespace hardpack::sim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kEarth_m = 6'371'000.0;  // a sphere will do for some hundred metres
constexpr uint64_t kGpsStart_ns = 1'400'000'000'000'000'000;

void Append(std::vector<uint8_t>& bytes, uint64_t value, int size) {
  for (int i = 0; i < size; ++i) bytes.push_back(static_cast<uint8_t>(value >> (8 * i)));
}
void AppendFloat(std::vector<uint8_t>& bytes, double value) {
  Append(bytes, std::bit_cast<uint32_t>(static_cast<float>(value)), 4);
}
void AppendDouble(std::vector<uint8_t>& bytes, double value) {
  Append(bytes, std::bit_cast<uint64_t>(value), 8);
}

// CCITT, highest bit first, from zero.
uint16_t Crc16(const std::vector<uint8_t>& bytes, size_t from) {
  uint32_t crc = 0;
  for (size_t i = from; i < bytes.size(); ++i) {
    crc ^= uint32_t{bytes[i]} << 8;
    for (int bit = 0; bit < 8; ++bit) crc = crc << 1 ^ ((crc & 0x8000u) != 0 ? 0x11021u : 0u);
  }
  return static_cast<uint16_t>(crc);
}

}  // namespace

SimIns::SimIns(const InsSettings& settings, uint64_t start_ns)
    : settings_(settings), random_(settings.seed), start_ns_(start_ns) {}

void SimIns::Advance(uint64_t now_ns, const SimVehicle& vehicle,
                     std::vector<std::vector<uint8_t>>& datagrams) {
  const auto per_s = static_cast<uint64_t>(settings_.messages_per_s);
  while (start_ns_ + (sent_ + 1) * 1'000'000'000 / per_s <= now_ns) {
    ++sent_;
    const std::vector<uint8_t> message = Message(sent_ * 1'000'000'000 / per_s, vehicle);
    buffer_.insert(buffer_.end(), message.begin(), message.end());
  }
  if (settings_.cut_bytes == 0) {
    if (!buffer_.empty()) datagrams.push_back(buffer_);
    buffer_.clear();
    return;
  }
  while (true) {
    if (next_cut_bytes_ == 0) {
      next_cut_bytes_ = 1 + random_() % static_cast<uint32_t>(settings_.cut_bytes);
    }
    if (buffer_.size() < next_cut_bytes_) return;
    const auto end = buffer_.begin() + static_cast<ptrdiff_t>(next_cut_bytes_);
    datagrams.emplace_back(buffer_.begin(), end);
    buffer_.erase(buffer_.begin(), end);
    next_cut_bytes_ = 0;
  }
}

std::vector<uint8_t> SimIns::Message(uint64_t since_start_ns, const SimVehicle& vehicle) const {
  const Pose& pose = vehicle.pose();
  // North, east and yaw are clockwise, the world is not.
  const double c = std::cos(settings_.north_rad);
  const double s = std::sin(settings_.north_rad);
  const double north_m = c * pose.x_m + s * pose.y_m;
  const double east_m = s * pose.x_m - c * pose.y_m;
  const double yaw_rad = std::remainder(settings_.north_rad - pose.theta_rad, 2.0 * kPi);
  const double meters_per_deg = kEarth_m * kPi / 180.0;
  std::vector<uint8_t> bytes = {0xfa, 0x01, 0xeb, 0x10};
  Append(bytes, since_start_ns, 8);
  Append(bytes, kGpsStart_ns + since_start_ns, 8);
  AppendFloat(bytes, yaw_rad * 180.0 / kPi);
  AppendFloat(bytes, 0.0);
  AppendFloat(bytes, 0.0);
  AppendFloat(bytes, 0.0);
  AppendFloat(bytes, 0.0);
  AppendFloat(bytes, -vehicle.yaw_rate_radps());  // z down
  AppendDouble(bytes, settings_.latitude_deg + north_m / meters_per_deg);
  AppendDouble(bytes,
               settings_.longitude_deg +
                   east_m / (meters_per_deg * std::cos(settings_.latitude_deg * kPi / 180.0)));
  AppendDouble(bytes, settings_.altitude_m);
  AppendFloat(bytes, vehicle.speed_mps() * std::cos(yaw_rad));
  AppendFloat(bytes, vehicle.speed_mps() * std::sin(yaw_rad));
  AppendFloat(bytes, 0.0);
  const uint32_t fix = settings_.mode == 2 ? 0x304u : 0u;  // satellites, and heading by them
  Append(bytes, fix | settings_.mode, 2);
  const uint16_t crc = Crc16(bytes, 1);
  bytes.push_back(static_cast<uint8_t>(crc >> 8));
  bytes.push_back(static_cast<uint8_t>(crc));
  return bytes;
}

}  // namespace hardpack::sim
