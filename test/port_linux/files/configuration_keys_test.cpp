// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/configuration_keys.h"
#include "port_linux/files/vehicle_types.h"

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <regex>
#include <sstream>
#include <vector>

#include "config/conflicts.h"
#include "core/base/validate.h"
#include "core/costmap/costmap.h"
#include "gtest/gtest.h"
#include "hal/sevcon/sevcon.h"
#include "port_linux/files/configuration.h"
#include "test/port_linux/files/configuration_texts.h"

namespace hardpack {
namespace {

// Writing.

TEST(ToToml, WritesEveryKeyOnce) {
  Configuration configuration;
  const std::string text = ToToml(configuration);
  for (const ConfigurationKey& key : KeysOf(configuration)) {
    const std::string header = std::string("\n[").append(key.group()).append("]\n");
    const size_t group = text.find(header);
    ASSERT_NE(group, std::string::npos);
    EXPECT_EQ(text.find(header, group + 1), std::string::npos);
    const size_t end = std::min(text.find("\n[", group + 1), text.size());
    const size_t at = text.find('\n' + key.name() + " = ", group);
    EXPECT_LT(at, end) << key.full_name;
  }
}

TEST(ToToml, IsReadAsTheSame) {
  const Configuration configuration = Parsed(kRequiredLines);
  EXPECT_EQ(Values(Parsed(ToToml(configuration))), Values(configuration));
}

// Digits that are the same float again, also by way of a double, as a file is read.
TEST(ToToml, WritesFloatsExactly) {
  std::mt19937 random(20260131);
  const auto check = [](float value) {
    const std::string text = NumberText(value);
    const float read = static_cast<float>(std::strtod(text.c_str(), nullptr));
    ASSERT_EQ(std::bit_cast<uint32_t>(read), std::bit_cast<uint32_t>(value)) << text;
    ASSERT_NE(text.find_first_of(".e"), std::string::npos) << text;
  };
  using Limits = std::numeric_limits<float>;
  for (const float value : {0.0f, -0.0f, 1.0f, 0.1f, -2.5f, 1e6f, 16777217.0f, Limits::max(),
                            Limits::lowest(), Limits::min(), Limits::denorm_min(), 7.038531e-26f}) {
    check(value);
  }
  for (int i = 0; i < 300000; ++i) {
    const uint32_t bits = static_cast<uint32_t>(random());
    if ((bits & 0x7f800000u) != 0x7f800000u) check(std::bit_cast<float>(bits));
  }
}

// Any configuration that reading would accept.
class RandomConfiguration {
 public:
  explicit RandomConfiguration(uint32_t seed) : random_(seed) {}

  Configuration Next() {
    Configuration configuration;
    const std::vector<ConfigurationKey> keys = KeysOf(configuration);
    for (const ConfigurationKey& key : keys) SetValue(key);
    for (const ConfigurationKey& key : keys) {
      if (!key.not_above.empty()) PutInOrder(key, KeyNamed(keys, key.not_above));
    }
    PlannerParams& planner = configuration.planner;
    if (FirstConflict(planner, configuration.perception, configuration.onboard).name != nullptr ||
        !IsUsable(CheckCostmapParams(planner.costmap))) {
      planner.vehicle = {};
      planner.costmap = {};
      planner.costmap.halo_m = Between(0.0f, 3.0f);
      planner.path.margin_m = 0.1f;
      planner.path.kept_margin_m = Between(0.05f, 0.1f);
      planner.speed.stopping_dead_time_s = 5.0f;
      planner.speed.stopping_lag_s = 5.0f;
      configuration.onboard.dynamics = {};
      configuration.onboard.safety.corridor_margin_m = Between(0.0f, 0.05f);
      configuration.perception.mount = {};
    }
    float& band_m = configuration.perception.segmentation.ground_band_m;
    if (band_m >= planner.costmap.obstacle_height_m) band_m = Between(0.0f, 0.04f);
    configuration.onboard.drive.left_sign = Below(2) == 0 ? 1 : -1;
    configuration.onboard.drive.right_sign = Below(2) == 0 ? 1 : -1;
    if (!IsUsable(sevcon::DrivePair().Configure(configuration.onboard.drive))) {
      configuration.onboard.drive = {};
      configuration.onboard.drive.gear_ratio = Between(0.1f, 500.0f);
    }
    TwistDriveParams& twist = configuration.onboard.twist_drive;
    twist.turn = TwistDriveParams::kYawRate;
    twist.command_id = static_cast<int32_t>(Below(0x200));
    twist.feedback_id = 0x200 + static_cast<int32_t>(Below(0x200));
    twist.status_id = 0x400 + static_cast<int32_t>(Below(0x200));
    configuration.velodyne.model = Below(2) == 0 ? "vlp16" : "vlp32c";
    configuration.velodyne.returns = Below(2) == 0 ? "last" : "dual";
    configuration.velodyne.rpm = 60 * (9 + static_cast<int32_t>(Below(12)));
    configuration.vehicle_type = VehicleTypes()[Below(VehicleTypes().size())];
    configuration.lidar.address.value |= 1;
    configuration.ins.address.value |= 1;
    configuration.label_source.address.value |= 1;
    configuration.lidar.port = 1000 + static_cast<int32_t>(Below(1000));
    configuration.ins.port = 2000 + static_cast<int32_t>(Below(1000));
    configuration.label_source.port = 3000 + static_cast<int32_t>(Below(1000));
    for (ReturnClass& meaning : configuration.labels.class_of) {
      meaning = static_cast<ReturnClass>(Below(kReturnClassNames.size()));
    }
    return configuration;
  }

 private:
  uint32_t Below(size_t end) { return static_cast<uint32_t>(random_() % end); }

  float Between(float low, float high) {
    if (Below(8) == 0) return low;
    if (Below(8) == 0) return high;
    const float share = static_cast<float>(random_()) / 4294967296.0f;
    return std::clamp(low + share * (high - low), low, high);
  }

  int32_t Whole(const ConfigurationKey& key) {
    const double low = static_cast<double>(key.low);
    const double high = static_cast<double>(key.high);
    const double share = static_cast<double>(random_()) / 4294967295.0;
    return static_cast<int32_t>(low + share * (high - low));
  }

  std::string Text(const ConfigurationKey& key) {
    const std::string letters = "aZ09_.-\"\\'#=[]{}$%~";
    const std::vector<std::string> wide = {"\xc3\xa4", "\xe2\x82\xac", "\xf0\x9f\x9a\x9c"};
    std::string text;
    const size_t size = static_cast<size_t>(Whole(key));
    while (text.size() < size) {
      const std::string& more = wide[Below(wide.size())];
      if (Below(6) == 0 && text.size() + more.size() <= size) {
        text += more;
      } else {
        text += letters[Below(letters.size())];
      }
    }
    return text;
  }

  void SetValue(const ConfigurationKey& key) {
    if (auto* const* number = std::get_if<float*>(&key.value))
      **number = Between(key.low, key.high);
    if (auto* const* whole = std::get_if<int32_t*>(&key.value)) **whole = Whole(key);
    if (auto* const* is_on = std::get_if<bool*>(&key.value)) **is_on = Below(2) == 0;
    if (auto* const* text = std::get_if<std::string*>(&key.value)) **text = Text(key);
    if (auto* const* rule = std::get_if<ObstacleRule*>(&key.value)) {
      **rule = static_cast<ObstacleRule>(Below(2));
    }
    if (auto* const* address = std::get_if<Ipv4Address*>(&key.value)) {
      (*address)->value = Below(4) == 0 ? 0u : static_cast<uint32_t>(random_());
    }
  }

  static void PutInOrder(const ConfigurationKey& lower, const ConfigurationKey& upper) {
    if (auto* const* number = std::get_if<float*>(&lower.value)) {
      float& high = *std::get<float*>(upper.value);
      **number = std::min({**number, high, upper.high});
      if (**number < lower.low) **number = high = std::max(lower.low, upper.low);
    } else {
      int32_t& low = *std::get<int32_t*>(lower.value);
      low = std::min(low, *std::get<int32_t*>(upper.value));
    }
  }

  std::mt19937 random_;
};

TEST(ToToml, OfAnyConfigurationIsReadAsTheSame) {
  for (uint32_t seed = 1; seed <= 300; ++seed) {
    const Configuration configuration = RandomConfiguration(seed).Next();
    const std::string text = ToToml(configuration);
    Configuration read;
    const ReadOutcome outcome = ParseConfiguration(text, "f", read);
    ASSERT_TRUE(outcome.ok()) << "seed " << seed << "\n" << outcome.message << "\n" << text;
    ASSERT_EQ(Values(read), Values(configuration)) << "seed " << seed;
    ASSERT_EQ(ToToml(read), text) << "seed " << seed;
  }
}

// The list of keys.

TEST(ConfigurationKeys, HaveNamesOfTheirOwnAndValuesInTheirRange) {
  Configuration configuration;
  std::vector<std::string> names;
  for (const ConfigurationKey& key : KeysOf(configuration)) {
    names.push_back(key.full_name);
    EXPECT_GT(key.description.size(), 5u) << key.full_name;
    EXPECT_EQ(std::count(key.full_name.begin(), key.full_name.end(), '.'), 1);
  }
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

// A member that no key sets, or that two set, shows here: all are changed by their keys, and each
// structure then differs from its default in each member.
TEST(ConfigurationKeys, SetEveryMember) {
  Configuration c;
  for (const ConfigurationKey& key : KeysOf(c)) {
    if (auto* const* whole = std::get_if<int32_t*>(&key.value)) **whole += 1;
    if (auto* const* is_on = std::get_if<bool*>(&key.value)) **is_on = !**is_on;
    if (auto* const* text = std::get_if<std::string*>(&key.value)) **text += 'x';
    if (auto* const* address = std::get_if<Ipv4Address*>(&key.value)) (*address)->value += 1;
  }
  const Configuration d;
  const auto check_source = [](const DatagramSource& changed, const DatagramSource& other) {
    const auto& [address, port, bind_address, bytes, is_required] = changed;
    EXPECT_EQ(address.value, other.address.value + 1);
    EXPECT_EQ(port, other.port + 1);
    EXPECT_EQ(bind_address.value, other.bind_address.value + 1);
    EXPECT_EQ(bytes, other.receive_buffer_bytes + 1);
    EXPECT_NE(is_required, other.require_receive_buffer);
  };
  check_source(c.lidar, d.lidar);
  check_source(c.ins, d.ins);
  check_source(c.label_source, d.label_source);
  EXPECT_EQ(c.lidar.metadata, d.lidar.metadata + "x");
  const auto& [interface, restart, frame_max_age_ms] = c.can;
  EXPECT_EQ(interface, d.can.interface + "x");
  EXPECT_NE(restart, d.can.restart);
  EXPECT_EQ(frame_max_age_ms, d.can.frame_max_age_ms + 1);
  const auto& [enabled, directory, file_size_mb, max_total_mb, min_free_mb, buffer_mb] = c.log;
  EXPECT_NE(enabled, d.log.enabled);
  EXPECT_EQ(directory, d.log.directory + "x");
  EXPECT_EQ(file_size_mb, d.log.file_size_mb + 1);
  EXPECT_EQ(max_total_mb, d.log.max_total_mb + 1);
  EXPECT_EQ(min_free_mb, d.log.min_free_mb + 1);
  EXPECT_EQ(buffer_mb, d.log.buffer_mb + 1);
  const auto& [socket, group] = c.control;
  EXPECT_EQ(socket, d.control.socket + "x");
  EXPECT_EQ(group, d.control.group + "x");
  const auto& [realtime_priority, lock_memory, cpu, abort_on_allocation] = c.process;
  EXPECT_EQ(realtime_priority, d.process.realtime_priority + 1);
  EXPECT_NE(lock_memory, d.process.lock_memory);
  EXPECT_EQ(cpu, d.process.cpu + 1);
  EXPECT_NE(abort_on_allocation, d.process.abort_on_allocation);
}

TEST(ConfigurationKeys, KnowTheUnitsOfTheirNames) {
  EXPECT_EQ(UnitOf("max_speed_mps"), "m/s");
  EXPECT_EQ(UnitOf("costmap.halo_m"), "m");
  EXPECT_EQ(UnitOf("drive.sdo_timeout_ms"), "ms");
  EXPECT_EQ(UnitOf("optimizer.max_curvature_rate_per_m2"), "1/m^2");
  EXPECT_EQ(UnitOf("optimizer.max_sweeps"), "");
}

// The example.

std::string Example() {
  std::ifstream file(HARDPACK_SOURCE_DIR "/config/warthog.toml");
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::string FilledIn(std::string text) {
  const auto fill = [&text](const std::string& line, const std::string& value) {
    const std::string empty = "\n" + line + " = \"TO BE FILLED IN\"\n";
    const size_t at = text.find(empty);
    ASSERT_NE(at, std::string::npos) << line;
    text.replace(at, empty.size(), "\n" + line + " = " + value + "\n");
  };
  fill("address", "\"10.0.0.2\"");
  fill("metadata", "\"os1.json\"");
  fill("address", "\"10.0.0.3\"");
  fill("port", "5000");
  fill("gear_ratio", "24.5");
  fill("left_sign", "1");
  fill("right_sign", "-1");
  return text;
}

TEST(Example, IsRefusedUntilItIsFilledIn) {
  Configuration configuration;
  const std::string message = ParseConfiguration(Example(), "f", configuration).message;
  for (const std::string key : {"drive.gear_ratio", "drive.left_sign", "drive.right_sign",
                                "lidar.address", "lidar.metadata", "ins.address", "ins.port"}) {
    EXPECT_NE(message.find(": " + key + ": must be set: "), std::string::npos) << message;
  }
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 6) << message;
}

TEST(Example, IsTheDefaultsWhenFilledIn) {
  EXPECT_EQ(Values(Parsed(FilledIn(Example()))), Values(Parsed(kRequiredLines)));
}

// What stands behind a # is what holds without it.
TEST(Example, ShowsTheDefaults) {
  const std::string text = std::regex_replace(Example(), std::regex("\n#([a-z0-9_]+ = )"), "\n$1");
  EXPECT_NE(text, Example());
  EXPECT_EQ(Values(Parsed(FilledIn(text))), Values(Parsed(kRequiredLines)));
}

// SR-STP07: what operators and logs are shown of the configuration has no password in it.
TEST(ConfigurationText, HidesThePasswordWhereItIsToldTo) {
  Configuration configuration = Parsed(kRequiredLines);
  configuration.onboard.drive.login_user = 3;
  configuration.onboard.drive.login_password = 54321;
  const std::string shown = ToToml(configuration, Secrets::kHidden);
  EXPECT_EQ(shown.find("54321"), std::string::npos);
  EXPECT_NE(shown.find(std::string("login_password = 0 ") + std::string(kHiddenSecret)),
            std::string::npos);
  EXPECT_EQ(Parsed(shown).onboard.drive.login_password, 0);
  EXPECT_EQ(Parsed(shown).onboard.drive.login_user, 3);
  EXPECT_NE(ToToml(configuration).find("54321"), std::string::npos);
  configuration.onboard.drive.login_password = 0;
  EXPECT_EQ(ToToml(configuration, Secrets::kHidden), ToToml(configuration));
}

}  // namespace
}  // namespace hardpack
