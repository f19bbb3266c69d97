// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/configuration.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "port_linux/files/configuration_keys.h"
#include "test/port_linux/files/configuration_texts.h"

namespace hardpack {
namespace {

// The message for a file that has these lines after the required ones, which are lines 1 to 6.
std::string Message(const std::string& lines) {
  Configuration configuration;
  return ParseConfiguration(kRequiredLines + lines, "f", configuration).message;
}
Status StatusOf(const std::string& lines) {
  Configuration configuration;
  return ParseConfiguration(kRequiredLines + lines, "f", configuration).status;
}

// Reading.

TEST(Configuration, TakesWhatEveryVehicleHasToSet) {
  const Configuration configuration = Parsed(kRequiredLines);
  EXPECT_EQ(configuration.onboard.drive.gear_ratio, 24.5f);
  EXPECT_EQ(configuration.onboard.drive.left_sign, 1);
  EXPECT_EQ(configuration.onboard.drive.right_sign, -1);
  EXPECT_EQ(configuration.lidar.address.value, 0x0a000002u);
  EXPECT_EQ(configuration.lidar.metadata, "os1.json");
  EXPECT_EQ(configuration.ins.address.value, 0x0a000003u);
  EXPECT_EQ(configuration.ins.port, 5000);
}

TEST(Configuration, LeavesTheRestAtItsDefaults) {
  Configuration expected;
  expected.onboard.drive.gear_ratio = 24.5f;
  expected.onboard.drive.right_sign = -1;
  expected.lidar.address = {0x0a000002u};
  expected.lidar.metadata = "os1.json";
  expected.ins.address = {0x0a000003u};
  expected.ins.port = 5000;
  EXPECT_EQ(Values(Parsed(kRequiredLines)), Values(expected));
}

TEST(Configuration, TakesTablesAndEveryKindOfValue) {
  const Configuration c = Parsed(kRequiredLines + R"(
[costmap]
halo_m = 1.25
hard_edge_cost = 3  # a whole number where a fraction may be
obstacle_rule = 0
[optimizer]
max_sweeps = 7.0
[can]
interface = "vcan0"
restart = false
[process]
cpu = -1
[labels]
bind_address = "192.168.1.7"
)");
  EXPECT_EQ(c.planner.costmap.halo_m, 1.25f);
  EXPECT_EQ(c.planner.costmap.hard_edge_cost, 3.0f);
  EXPECT_EQ(c.planner.costmap.obstacle_rule, ObstacleRule::kInCell);
  EXPECT_EQ(c.planner.optimizer.max_sweeps, 7);
  EXPECT_EQ(c.can.interface, "vcan0");
  EXPECT_FALSE(c.can.restart);
  EXPECT_EQ(c.label_source.bind_address.value, 0xc0a80107u);
}

TEST(Configuration, TakesWholeNumbersBeyondTwoTo24Exactly) {
  EXPECT_EQ(Parsed(kRequiredLines + "drive.product_code = 123456789").onboard.drive.product_code,
            123456789);
  EXPECT_EQ(Parsed(kRequiredLines + "drive.product_code = 0x0706000d").onboard.drive.product_code,
            0x0706000d);
}

TEST(Configuration, TakesClassesOfLabels) {
  const Configuration c = Parsed(kRequiredLines + "labels.classes = { 19 = 'hard', '4'='soft' }");
  LabelTable expected = RellisLabelTable();
  expected.class_of[19] = ReturnClass::kHard;
  expected.class_of[4] = ReturnClass::kSoft;
  EXPECT_EQ(std::memcmp(&c.labels, &expected, sizeof(expected)), 0);
}

TEST(Configuration, GivesUnlistedLabelsTheDefaultClass) {
  const Configuration c =
      Parsed(kRequiredLines + "labels.classes = { 0 = 'ground', default = 'person' }");
  EXPECT_EQ(c.labels.class_of[0], ReturnClass::kGround);
  for (size_t code = 1; code < kLabelCodes; ++code) {
    EXPECT_EQ(c.labels.class_of[code], ReturnClass::kPerson) << code;
  }
}

TEST(Configuration, TakesLinesThatEndAsOnWindows) {
  EXPECT_EQ(Parsed(kRequiredLines + "[costmap]\r\nhalo_m = 1.5\r\n").planner.costmap.halo_m, 1.5f);
}

// Every key at both ends of its range, and just beyond them.
// SR-CFG01
TEST(Configuration, HoldsEveryKeyToItsRange) {
  Configuration configuration = Parsed(kRequiredLines);
  const std::string good = ToToml(configuration);
  for (const ConfigurationKey& key : KeysOf(configuration)) {
    if (std::holds_alternative<bool*>(key.value)) continue;
    if (std::holds_alternative<Ipv4Address*>(key.value)) continue;
    const std::string before = ValueText(key);
    const std::string line = "\n" + key.name() + " = ";
    const size_t group = good.find("[" + key.group() + "]");
    const size_t at = good.find(line + before + "\n", group);
    ASSERT_NE(at, std::string::npos) << key.full_name;
    const auto with = [&](const std::string& value) {
      std::string text = good;
      text.replace(at, line.size() + before.size(), line + value);
      Configuration other;
      return ParseConfiguration(text, "f", other).message;
    };
    const bool is_text = std::holds_alternative<std::string*>(key.value);
    const auto value_of = [is_text](double number) {
      std::ostringstream text;
      text.precision(17);
      text << number;
      return is_text ? '"' + std::string(static_cast<size_t>(number), 'x') + '"' : text.str();
    };
    const std::string complaint = key.full_name + ": ";
    const double low = static_cast<double>(key.low);
    const double high = static_cast<double>(key.high);
    // Messages about conflicts and missing keys use other words.
    EXPECT_EQ(with(value_of(low)).find("is not"), std::string::npos) << with(value_of(low));
    EXPECT_EQ(with(value_of(high)).find("is not"), std::string::npos) << with(value_of(high));
    const double step = std::holds_alternative<float*>(key.value) ? high * 1e-6 + 1e-6 : 1.0;
    EXPECT_NE(with(value_of(high + step)).find(complaint), std::string::npos) << key.full_name;
    if (is_text && key.low == 0.0f) continue;
    EXPECT_NE(with(value_of(low - step)).find(complaint), std::string::npos) << key.full_name;
  }
}

// Messages.

// SR-CFG01
TEST(Configuration, NamesTheNearestKeyForAnUnknownOne) {
  EXPECT_EQ(Message("costmap.halo = 2"),
            "f:7: costmap.halo: unknown key, did you mean costmap.halo_m?");
  EXPECT_EQ(Message("astar.halo_m = 2"),
            "f:7: astar.halo_m: unknown key, did you mean costmap.halo_m?");
  EXPECT_EQ(Message("halo_m = 2"), "f:7: halo_m: is not in a table, did you mean costmap.halo_m?");
  EXPECT_EQ(Message("speed.xyzzyxyzzy = 2"), "f:7: speed.xyzzyxyzzy: unknown key");
  EXPECT_EQ(Message("log.directory.x = 2"),
            "f:7: log.directory: a table is not a text of 1 to 500 letters without control "
            "characters");
}

TEST(Configuration, NamesTheNearestTableForAnUnknownOne) {
  EXPECT_EQ(Message("\n[costmapp]\nhalo_m = 2"),
            "f:8: [costmapp]: unknown table, did you mean [costmap]?");
  EXPECT_EQ(Message("[xyzzyxyzzyxyzzy]"), "f:7: [xyzzyxyzzyxyzzy]: unknown table");
  EXPECT_EQ(Message("[[costmap]]\nhalo_m = 2"),
            "f:7: costmap: is a list, expected a table: [costmap]");
  EXPECT_EQ(Message("costmap = 2"), "f:7: costmap: is 2, expected a table: [costmap]");
}

TEST(Configuration, TellsTheRangeWithItsUnit) {
  EXPECT_EQ(Message("costmap.halo_m = 3.5"),
            "f:7: costmap.halo_m: 3.5 is not a number from 0 to 3 m");
  EXPECT_EQ(Message("speed.max_speed_mps = -1"),
            "f:7: speed.max_speed_mps: -1 is not a number from 0.1 to 20 m/s");
  EXPECT_EQ(Message("costmap.ground_window_cells = 3.5"),
            "f:7: costmap.ground_window_cells: 3.5 is not a whole number from 1 to 31 cells");
  EXPECT_EQ(Message("mapping.use_labels = true"), "f:7: mapping.use_labels: true is not 0 or 1");
  EXPECT_EQ(Message("lidar.port = 65536"),
            "f:7: lidar.port: 65536 is not a whole number from 1 to 65535");
  EXPECT_EQ(StatusOf("lidar.port = 65536"), Status::kParameterOutOfRange);
}

// SR-CFG01
TEST(Configuration, RefusesWhatIsNoFiniteNumber) {
  for (const std::string value : {"nan", "inf", "-inf", "+nan", "1e999"}) {
    const std::string message = Message("costmap.halo_m = " + value);
    EXPECT_TRUE(message.starts_with("f:7: ")) << message;
  }
  EXPECT_EQ(StatusOf("costmap.halo_m = nan"), Status::kNotFinite);
  EXPECT_EQ(Message("costmap.halo_m = inf"),
            "f:7: costmap.halo_m: inf is not a number from 0 to 3 m");
  EXPECT_EQ(Message("costmap.ground_window_cells = nan"),
            "f:7: costmap.ground_window_cells: nan is not a whole number from 1 to 31 cells");
}

// SR-CFG01
TEST(Configuration, RefusesOtherTypes) {
  EXPECT_EQ(Message("costmap.halo_m = '2'"),
            "f:7: costmap.halo_m: \"2\" is not a number from 0 to 3 m");
  EXPECT_EQ(Message("costmap.halo_m = [2]"),
            "f:7: costmap.halo_m: a list is not a number from 0 to 3 m");
  EXPECT_EQ(Message("costmap.halo_m = 1979-05-27"),
            "f:7: costmap.halo_m: a date or time is not a number from 0 to 3 m");
  EXPECT_EQ(Message("can.restart = 1"), "f:7: can.restart: 1 is not true or false");
  EXPECT_EQ(Message("can.interface = 0"),
            "f:7: can.interface: 0 is not a text of 1 to 15 letters without control characters");
  EXPECT_EQ(Message("lidar.bind_address = 10"),
            "f:7: lidar.bind_address: 10 is not an IPv4 address like \"10.0.0.5\"");
}

TEST(Configuration, RefusesTextsThatNoPathOrNameIs) {
  EXPECT_NE(Message(R"(log.directory = "a\u0000b")"), "");
  EXPECT_NE(Message(R"(log.directory = "a\nb")"), "");
  EXPECT_NE(Message(R"(log.directory = "")"), "");
  EXPECT_NE(Message("control.socket = '" + std::string(108, 's') + "'"), "");
  EXPECT_EQ(Message("control.socket = '" + std::string(107, 's') + "'"), "");
  EXPECT_NE(Message("can.interface = 'can 0'"), "");
  EXPECT_NE(Message("can.interface = '../x'"), "");
  EXPECT_NE(Message("can.interface = 'sixteen_letters_'"), "");
}

// SR-CFG01
TEST(Configuration, TellsAKeyThatIsThereTwice) {
  const std::string message = Message("costmap.halo_m = 1\ncostmap.halo_m = 2\n");
  EXPECT_TRUE(message.starts_with("f:8: ")) << message;
  EXPECT_NE(message.find("halo_m"), std::string::npos) << message;
}

// SR-CFG01
TEST(Configuration, TellsWhichKeysMustBeSetAndWhy) {
  Configuration configuration;
  EXPECT_EQ(ParseConfiguration("", "f", configuration).message,
            "f: drive.gear_ratio: must be set: the Warthog's is not public: measure it\n"
            "f: drive.left_sign: must be set: 1 or -1: the motor's mounting is not public: "
            "try it with the wheels up\n"
            "f: drive.right_sign: must be set: 1 or -1: the motor's mounting is not public: "
            "try it with the wheels up\n"
            "f: lidar.address: must be set: the address that your lidar sends from\n"
            "f: lidar.metadata: must be set: the file with your lidar's beam angles\n"
            "f: ins.address: must be set: the address that your INS sends from; without an INS set "
            "safety.needs_ins = 0\n"
            "f: ins.port: must be set: the port that your INS sends to; without an INS set "
            "safety.needs_ins = 0");
}

TEST(Configuration, RefusesAnEmptyValueForARequiredKey) {
  std::string text = kRequiredLines;
  text = std::regex_replace(text, std::regex("left_sign = 1"), "left_sign = 0");
  text = std::regex_replace(text, std::regex("10.0.0.2"), "");
  text = std::regex_replace(text, std::regex("5000"), "'TO BE FILLED IN'");
  Configuration configuration;
  EXPECT_EQ(ParseConfiguration(text, "f", configuration).message,
            "f:2: drive.left_sign: must be set: 1 or -1: the motor's mounting is not public: "
            "try it with the wheels up\n"
            "f:4: lidar.address: must be set: the address that your lidar sends from\n"
            "f:6: ins.port: must be set: the port that your INS sends to; without an INS set "
            "safety.needs_ins = 0");
}

TEST(Configuration, NeedsNoInsWhereNoneIsNeeded) {
  const std::string text = kRequiredLines.substr(0, kRequiredLines.find("ins = "));
  EXPECT_EQ(Parsed(text + "safety.needs_ins = 0").ins.port, 0);
  Configuration configuration;
  EXPECT_TRUE(ParseConfiguration(text + "safety.needs_ins = 0\nins.address = '10.0.0.3'", "f",
                                 configuration)
                  .message.starts_with("f: ins.port: must be set"));
}

TEST(Configuration, NeedsAnAddressWhereLabelsAreUsed) {
  EXPECT_EQ(Message("mapping.use_labels = 1"),
            "f: labels.address: must be set: the address that labels come from; "
            "mapping.use_labels = 1 needs it");
  EXPECT_EQ(Message("mapping.use_labels = 1\nlabels.address = '10.0.0.9'"), "");
}

// SR-CFG02, SR-LOW01
TEST(Configuration, TellsWhatDoesNotGoTogether) {
  EXPECT_EQ(Message("speed.max_speed_mps = 1\n"),
            "f:7: speed.min_speed_mps: 2.0 is above speed.max_speed_mps, which is 1.0");
  EXPECT_EQ(Message("log.file_size_mb = 2\nlog.max_total_mb = 1\n"),
            "f:8: log.file_size_mb: 2 is above log.max_total_mb, which is 1");
  EXPECT_EQ(Message("costmap.ground_window_cells = 4\n"),
            "f:7: costmap.ground_window_cells: must be odd, not 4");
  EXPECT_EQ(Message("drive.heartbeat_timeout_ms = 100\n"),
            "f:7: drive.heartbeat_timeout_ms: 100 conflicts with drive.heartbeat_period_ms, which "
            "is 100: it must be greater");
  // What counts as an obstacle is what the vehicle cannot pass over.
  EXPECT_EQ(Message("costmap.obstacle_height_m = 0.3\n"),
            "f:7: costmap.obstacle_height_m: 0.3 conflicts with vehicle.max_step_m, which is 0.2: "
            "it must be no greater: the vehicle cannot drive over anything higher");
  EXPECT_EQ(Message("vehicle.ground_clearance_m = 0.15\n"),
            "f:7: costmap.obstacle_height_m: 0.2 conflicts with vehicle.ground_clearance_m, which "
            "is 0.15: it must be no greater: the vehicle cannot drive over anything higher");
  EXPECT_EQ(Message("segmentation.ground_band_m = 0.2\n"),
            "f:7: segmentation.ground_band_m: 0.2 conflicts with costmap.obstacle_height_m, which "
            "is 0.2: it must be less: returns up to this height are ground");
  EXPECT_EQ(
      Message("drive.max_bus_load_percent = 1\n"),
      "f:7: drive.max_bus_load_percent: is 1, but the frames sent and requested at these periods "
      "take 5 % of the bus");
  EXPECT_EQ(Message("lidar.port = 5000"),
            "f:6: ins.port: is the same as lidar.port: each sensor needs its own");
  EXPECT_EQ(Message("labels.port = 5000"), "");  // no labels are used
}

// SR-GEO08: an error that concerns two keys names both, and where the later of them stands.
TEST(Configuration, NamesBothKeysOfWhatDoesNotGoTogether) {
  struct Case {
    std::string lines;
    std::string key;
    std::string other;
  };
  const std::vector<Case> cases = {
      {"vehicle.axle_offset_m = 0.77", "vehicle.axle_offset_m", "vehicle.length_m"},
      {"vehicle.length_m = 3.0", "mount.self_max_x_m", "vehicle.length_m"},
      {"vehicle.length_m = 6.0\nmount.self_max_x_m = 3.0", "mount.self_min_x_m",
       "vehicle.length_m"},
      {"vehicle.width_m = 1.8", "mount.self_max_abs_y_m", "vehicle.width_m"},
      {"mount.self_max_x_m = 1.3", "mount.self_max_x_m", "vehicle.length_m"},
      {"mount.self_max_abs_y_m = 1.2", "mount.self_max_abs_y_m", "vehicle.width_m"},
      {"mount.self_min_x_m = -2.8", "mount.self_min_x_m", "vehicle.length_m"},
      {"mount.x_m = 1.3", "mount.x_m", "vehicle.length_m"},
      {"mount.y_m = -1.2", "mount.y_m", "vehicle.width_m"},
      {"vehicle.width_m = 4.0\nmount.self_max_abs_y_m = 2.1\ncostmap.hard_edge_cost = 7.0",
       "costmap.hard_slope_per_m", "vehicle.width_m"},
      {"costmap.hard_slope_per_m = 40.0", "costmap.hard_slope_per_m", "costmap.planning_radius_m"},
      {"costmap.clearance_height_m = 0.5", "costmap.clearance_height_m", "costmap.growth_height_m"},
      {"speed.stopping_dead_time_s = 0.1", "speed.stopping_dead_time_s", "dynamics.dead_time_s"},
      {"speed.stopping_lag_s = 0.5", "speed.stopping_lag_s", "dynamics.common_lag_s"},
      {"safety.corridor_margin_m = 0.06", "safety.corridor_margin_m", "path.kept_margin_m"},
      {"path.kept_margin_m = 0.2", "path.kept_margin_m", "path.margin_m"},
      {"drive.left_node = 3", "drive.right_node", "drive.left_node"},
      {"drive.left_node = 1", "drive.master_node", "drive.left_node"},
      {"drive.right_node = 1", "drive.master_node", "drive.right_node"},
      {"drive.command_timeout_ms = 20\ndrive.command_period_ms = 20", "drive.command_timeout_ms",
       "drive.command_period_ms"},
      {"drive.feedback_timeout_ms = 20", "drive.feedback_timeout_ms", "drive.sync_period_ms"}};
  for (const Case& one : cases) {
    const std::string message = Message(one.lines + "\n");
    EXPECT_NE(message.find(": " + one.key + ": "), std::string::npos) << one.lines << message;
    EXPECT_NE(message.find(' ' + one.other + ", which is "), std::string::npos)
        << one.lines << ": " << message;
    EXPECT_TRUE(message.starts_with("f:")) << message;
  }
  EXPECT_EQ(Message("vehicle.length_m = 6.0\nvehicle.width_m = 2.4\nmount.self_min_x_m = -3.0\n"
                    "mount.self_max_x_m = 3.2\nmount.self_max_abs_y_m = 1.3\n"),
            "");
}

TEST(Configuration, SaysWhatReplacesAFormerKey) {
  for (const std::string key :
       {"footprint_disc_radius_m", "footprint_disc_offset_m", "pivot_radius_m"}) {
    EXPECT_EQ(Message("vehicle." + key + " = 1.0\n"),
              "f:7: vehicle." + key +
                  ": is no longer a key: it follows from vehicle.length_m, vehicle.width_m and "
                  "vehicle.axle_offset_m");
  }
}

TEST(Configuration, RefusesClassesAndCodesThatAreNone) {
  EXPECT_EQ(Message("labels.classes.19 = 'bush'"),
            "f:7: labels.classes.19: \"bush\" is not \"ignored\", \"ground\", \"soft\", \"hard\" "
            "or \"person\"");
  for (const std::string code : {"256", "-1", "019", "99999999999999999999", "x", "'1 '"}) {
    const std::string message = Message("labels.classes." + code + " = 'soft'");
    EXPECT_NE(message.find("is neither a code from 0 to 255 nor \"default\""), std::string::npos)
        << message;
  }
  EXPECT_EQ(Message("labels.classes = 2"),
            "f:7: labels.classes: is 2, expected a table: [labels.classes]");
  EXPECT_NE(Message("labels.classes.default = 2"), "");
}

TEST(Configuration, TellsAllProblemsInTheOrderOfTheFile) {
  EXPECT_EQ(Message("[speed]\n"
                    "max_speed_mps = 99\n"
                    "[astar]\n"
                    "max_expansions = 'all'\n"
                    "max_expansion = 5\n"),
            "f:8: speed.max_speed_mps: 99 is not a number from 0.1 to 20 m/s\n"
            "f:10: astar.max_expansions: \"all\" is not a whole number from 1 to 262144\n"
            "f:11: astar.max_expansion: unknown key, did you mean astar.max_expansions?");
  EXPECT_EQ(StatusOf("speed.max_speed_mps = 99\nastar.max_expansions = 'all'"),
            Status::kParameterOutOfRange);
}

TEST(Configuration, TellsABoundedNumberOfProblems) {
  std::string lines = "[costmap]\n";
  for (int i = 0; i < 1000; ++i) lines += 'k' + std::to_string(i) + " = 1\n";
  const std::string message = Message(lines);
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), kMaxConfigurationProblems);
  EXPECT_TRUE(message.ends_with("\nf: and 960 more")) << message;
}

TEST(Configuration, StaysAsItWasOnFailure) {
  Configuration configuration = Parsed(kRequiredLines + "costmap.halo_m = 1.5");
  const std::string before = Values(configuration);
  const ReadOutcome outcome =
      ParseConfiguration(kRequiredLines + "costmap.halo_m = 2.5\nx = 1", "f", configuration);
  EXPECT_FALSE(outcome.ok());
  EXPECT_EQ(Values(configuration), before);
}

// Texts that are no configuration at all.

TEST(Configuration, RefusesWhatIsNoToml) {
  for (const std::string text :
       {"[", "a = ", "a = \"", "= 1", "\xff\xfe", "a = \"\xc3\x28\"", "\xed\xa0\x80 = 1",
        "[a]\n[a]\n", "a = 99999999999999999999", "a.b = 1\na = 2"}) {
    Configuration configuration;
    const ReadOutcome outcome = ParseConfiguration(text, "f", configuration);
    EXPECT_EQ(outcome.status, Status::kInvalidArgument);
    EXPECT_TRUE(outcome.message.starts_with("f:")) << outcome.message;
    for (const char letter : outcome.message) {
      EXPECT_TRUE((letter >= ' ' && letter <= '~') || letter == '\n');
    }
  }
  const std::string with_nul = kRequiredLines + std::string("x\0y = 1", 7);
  Configuration configuration;
  EXPECT_TRUE(ParseConfiguration(with_nul, "f", configuration).message.starts_with("f:7: "));
}

// As deep as one line can say it, in each way.
TEST(Configuration, RefusesDeepNesting) {
  std::string dotted = "a";
  while (dotted.size() < 1900) dotted += ".a";
  std::string inline_tables;
  for (int i = 0; i < 4; ++i) inline_tables += "{" + dotted.substr(0, 401) + "=";
  std::string lists(1900, '[');
  for (const std::string& text :
       {dotted + " = 1\n", "[" + dotted + "]\n" + dotted + " = 1\n",
        "[[" + dotted + "]]\n" + dotted + " = " + inline_tables.substr(0, 90) + "1}\n",
        "a = " + lists, "a = " + inline_tables + "1}}}}\n"}) {
    Configuration configuration;
    EXPECT_FALSE(ParseConfiguration(text, "f", configuration).ok());
  }
}

// The parser has undefined behaviour on some of them.
TEST(Configuration, RefusesLettersBeyondAsciiOutsideOfQuotes) {
  EXPECT_EQ(Message("[costmap]\nh\xc3\xb6he = 1"), "f:8: a non-ASCII letter outside quotes");
  EXPECT_EQ(Message("costmap.halo_m = 1 \xc2\xb5"), "f:7: a non-ASCII letter outside quotes");
  EXPECT_EQ(Message("log.directory = 'a' \"b\\\"\" \xc2\xb5 '"),
            "f:7: a non-ASCII letter outside quotes");
  EXPECT_EQ(Message("# Gr\xc3\xb6\xc3\x9f"
                    "e\n"),
            "");
  EXPECT_EQ(Message("can.restart = true # \xc3\x9f\n"), "");
  EXPECT_EQ(Message("log.directory = '/m/\\\xc3\x9f'"), "");
  EXPECT_EQ(Message("log.directory = \"/m/'\\\"#\\\\\xc3\x9f\""), "");
  EXPECT_EQ(Parsed("\xef\xbb\xbf" + kRequiredLines).ins.port, 5000);
}

// A quote within a value begins no text for the parser, and toml++ 3.3 has undefined behaviour on
// U+00A1 to U+0499 there. Only a build with sanitizers notices it.
TEST(Configuration, RefusesEveryLetterBehindAQuoteWithinAValue) {
  for (const char* begun : {"3\"", "3[lis\"", "1979-05-27 \"", "true\"", "[3=\"", "0x1'"}) {
    for (unsigned letter = 0x80; letter < 0x600; ++letter) {
      std::string text = std::string("log.directory = ") + begun;
      text += static_cast<char>(0xc0 | letter >> 6);
      text += static_cast<char>(0x80 | (letter & 0x3f));
      EXPECT_EQ(StatusOf(text), Status::kInvalidArgument) << begun << letter;
    }
  }
}

TEST(Configuration, RefusesTextsOfSeveralLines) {
  EXPECT_EQ(Message("log.directory = \"\"\"\n#\"\"\" \xc3\xb6"),
            "f:7: a multi-line text, which is not supported");
  EXPECT_EQ(Message("log.directory = '''a'''"), "f:7: a multi-line text, which is not supported");
  EXPECT_EQ(Message("control.group = \"\""), "");
  EXPECT_EQ(Message("control.group = '\"\"\"'"), "");
}

TEST(Configuration, RefusesLongLines) {
  EXPECT_EQ(Message("# " + std::string(1998, 'x') + "\n"), "");
  EXPECT_EQ(Message("# " + std::string(1999, 'x') + "\n"), "f:7: longer than 2000 bytes");
  EXPECT_EQ(StatusOf("# " + std::string(1999, 'x')), Status::kOversized);
}

TEST(Configuration, RefusesLargeTexts) {
  std::string lines;
  while (lines.size() + kRequiredLines.size() <= kMaxConfigurationBytes) lines += "# comment\n";
  EXPECT_EQ(StatusOf(lines), Status::kOversized);
  lines.resize(kMaxConfigurationBytes - kRequiredLines.size());
  EXPECT_EQ(Message(lines), "");
}

TEST(ReadConfiguration, TellsWhatIsWrongWithTheFile) {
  const std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / "hardpack_configuration_test";
  std::filesystem::create_directories(folder);
  Configuration configuration;
  EXPECT_TRUE(ReadConfiguration((folder / "none").string(), configuration)
                  .message.starts_with((folder / "none").string() + ": cannot be opened"));
  EXPECT_FALSE(ReadConfiguration(folder.string(), configuration).ok());
  EXPECT_EQ(ReadConfiguration("/dev/zero", configuration).status, Status::kOversized);

  const std::string path = (folder / "a.toml").string();
  std::ofstream(path) << kRequiredLines << "x = 1";
  EXPECT_EQ(ReadConfiguration(path, configuration).message, path + ":7: x: is not in a table");
  std::ofstream(path) << kRequiredLines << "costmap.halo_m = 1.5";
  EXPECT_TRUE(ReadConfiguration(path, configuration).ok());
  EXPECT_EQ(configuration.planner.costmap.halo_m, 1.5f);
  std::filesystem::remove_all(folder);
}

// Addresses.

TEST(Ipv4Address, IsReadAndWritten) {
  Ipv4Address address;
  for (const char* text : {"0.0.0.0", "255.255.255.255", "10.0.200.3", "192.168.1.1"}) {
    ASSERT_TRUE(ParseIpv4(text, address)) << text;
    EXPECT_EQ(ToText(address), text);
  }
  EXPECT_EQ(address.value, 0xc0a80101u);
  EXPECT_TRUE(ParseIpv4("", address));
  EXPECT_EQ(address.value, 0u);
}

TEST(Ipv4Address, IsNothingElse) {
  Ipv4Address address{7};
  for (const char* text :
       {"1.2.3", "1.2.3.4.5", "1.2.3.4.", ".1.2.3", "1..2.3", "256.0.0.1", "1.2.3.256", "01.2.3.4",
        "1.2.3.04", "1.2.3.-4", "+1.2.3.4", " 1.2.3.4", "1.2.3.4 ", "localhost", "0x1.2.3.4", "::1",
        "1,2,3,4", "1.2.3.4/8", "1.2.3.00"}) {
    EXPECT_FALSE(ParseIpv4(text, address)) << text;
    EXPECT_EQ(address.value, 7u);
  }
}

}  // namespace
}  // namespace hardpack
