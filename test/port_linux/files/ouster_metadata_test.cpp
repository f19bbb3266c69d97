// SPDX-License-Identifier: Apache-2.0
#include "port_linux/files/ouster_metadata.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>
#include <string>

#include "port_linux/files/read_file.h"

namespace hardpack::ouster {
namespace {

// A JSON array of `count` numbers.
std::string Angles(int count, const std::string& value = "1.5") {
  std::string text = "[";
  for (int i = 0; i < count; ++i) text += (i == 0 ? "" : ", ") + value;
  return text + "]";
}

std::string Beams(int count) {
  return R"("beam_altitude_angles": )" + Angles(count) + R"(, "beam_azimuth_angles": )" +
         Angles(count, "-3.1");
}

// A reduced file with more members.
std::string With(const std::string& members) {
  return "{" + Beams(64) + R"(, "lidar_mode": "1024x10")" +
         (members.empty() ? "" : ", " + members) + "}";
}

void ExpectRefused(const std::string& json, const std::string& message,
                   Status status = Status::kInvalidArgument) {
  Metadata metadata;
  metadata.beams = 5;
  const ReadOutcome outcome = ParseMetadata(json, "scan.json", metadata);
  EXPECT_EQ(outcome.message, message);
  EXPECT_EQ(outcome.status, status) << message;
  EXPECT_EQ(metadata.beams, 0) << "something was left of a refused file";
}

TEST(OusterMetadata, DerivesWhatAReducedFileDoesNotState) {
  Metadata metadata;
  const ReadOutcome outcome = ParseMetadata(With(""), "scan.json", metadata);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  EXPECT_EQ(metadata.profile, Profile::kLegacy);
  EXPECT_EQ(metadata.beams, 64);
  EXPECT_EQ(metadata.columns_per_frame, 1024);
  EXPECT_EQ(metadata.columns_per_packet, 16);
  EXPECT_EQ(metadata.column_window_first, 0);
  EXPECT_EQ(metadata.column_window_last, 1023);
  EXPECT_EQ(metadata.init_id, 0u);
  EXPECT_EQ(metadata.serial_number, 0u);
  EXPECT_FLOAT_EQ(metadata.beam_azimuth_deg[63], -3.1f);
  EXPECT_FLOAT_EQ(metadata.lidar_origin_to_beam_origin_m, 0.012163f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.rotation[0], -1.0f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.translation.z_m, 0.03618f);
  EXPECT_STREQ(metadata.product_line, "");
}

constexpr const char* kFormat =
    R"({"pixels_per_column": 64, "columns_per_frame": 2048, "columns_per_packet": 8,
        "column_window": [2000, 100], "udp_profile_lidar": "RNG19_RFL8_SIG16_NIR16"})";
constexpr const char* kTransform = R"([0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1])";

void ExpectTheFullSensor(const Metadata& metadata) {
  EXPECT_EQ(metadata.profile, Profile::kRng19Rfl8Sig16Nir16);
  EXPECT_EQ(metadata.beams, 64);
  EXPECT_EQ(metadata.columns_per_frame, 2048);
  EXPECT_EQ(metadata.columns_per_packet, 8);
  EXPECT_EQ(metadata.column_window_first, 2000);
  EXPECT_EQ(metadata.column_window_last, 100);
  EXPECT_EQ(metadata.init_id, 5431293u);
  EXPECT_EQ(metadata.serial_number, 992210000957u);
  EXPECT_FLOAT_EQ(metadata.lidar_origin_to_beam_origin_m, 0.015806f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.rotation[1], -1.0f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.rotation[3], 1.0f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.translation.x_m, 0.01f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.translation.y_m, 0.02f);
  EXPECT_FLOAT_EQ(metadata.sensor_from_lidar.translation.z_m, 0.03f);
  EXPECT_STREQ(metadata.product_line, "OS-1-64");
}

TEST(OusterMetadata, ReadsTheFlatForm) {
  Metadata metadata;
  const ReadOutcome outcome =
      ParseMetadata("{" + Beams(64) + R"(, "lidar_mode": "2048x10", "prod_line": "OS-1-64",
      "prod_sn": "992210000957", "initialization_id": 5431293,
      "lidar_origin_to_beam_origin_mm": 15.806, "data_format": )" +
                        kFormat + R"(, "lidar_to_sensor_transform": )" + kTransform + "}",
                    "scan.json", metadata);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  ExpectTheFullSensor(metadata);
}

TEST(OusterMetadata, ReadsTheNestedForm) {
  Metadata metadata;
  const ReadOutcome outcome =
      ParseMetadata(R"({"beam_intrinsics": {)" + Beams(64) +
                        R"(, "beam_to_lidar_transform": [1,0,0,15.806, 0,1,0,0, 0,0,1,0, 0,0,0,1]},
      "config_params": {"lidar_mode": "2048x10", "columns_per_packet": 8},
      "sensor_info": {"prod_line": "OS-1-64", "prod_sn": "992210000957",
      "initialization_id": 5431293}, "lidar_data_format": )" +
                        kFormat + R"(, "lidar_intrinsics": {"lidar_to_sensor_transform": )" +
                        kTransform + R"(}, "user_data": null, "calibration_status": {}})",
                    "scan.json", metadata);
  ASSERT_TRUE(outcome.ok()) << outcome.message;
  ExpectTheFullSensor(metadata);
}

TEST(OusterMetadata, KnowsTheBeamOriginOfEachProductLine) {
  const std::pair<const char*, float> lines[] = {
      {"OS-0-128", 0.02767f}, {"OS-1-64", 0.015806f}, {"OS-2-32-U1", 0.013762f}, {"", 0.012163f}};
  for (const auto& [line, origin_m] : lines) {
    Metadata metadata;
    const std::string member = R"("prod_line": ")" + std::string(line) + "\"";
    ASSERT_TRUE(ParseMetadata(With(member), "scan.json", metadata).ok());
    EXPECT_FLOAT_EQ(metadata.lidar_origin_to_beam_origin_m, origin_m) << line;
  }
}

// SR-CFG03
TEST(OusterMetadata, NamesFileAndFieldOfWhatIsWrong) {
  ExpectRefused("", "scan.json: not JSON (at byte 1)");
  ExpectRefused("{\"a\": NaN}", "scan.json: not JSON (at byte 7)");
  ExpectRefused("[1, 2]", "scan.json: expected a JSON object");
  ExpectRefused("{}", "scan.json: beam_altitude_angles: missing or empty");
  ExpectRefused("{\"beam_altitude_angles\": 3}",
                "scan.json: beam_altitude_angles: expected an array of numbers");
  ExpectRefused(R"({"beam_altitude_angles": [1, "2"]})",
                "scan.json: beam_altitude_angles: expected a number");
  ExpectRefused(R"({"beam_altitude_angles": [1, 90.5]})",
                "scan.json: beam_altitude_angles: 90.5 is beyond +-90");
  ExpectRefused(R"({"beam_altitude_angles": [1], "beam_azimuth_angles": [1e999]})",
                "scan.json: a number is too large to represent", Status::kNotFinite);
  ExpectRefused(R"({"beam_altitude_angles": )" + Angles(63) + R"(, "beam_azimuth_angles": )" +
                    Angles(64) + R"(, "data_format": {"pixels_per_column": 64}})",
                "scan.json: beam_altitude_angles: 63 numbers, expected 64");
  ExpectRefused(R"({"beam_altitude_angles": )" + Angles(64) + R"(, "beam_azimuth_angles": )" +
                    Angles(65) + "}",
                "scan.json: beam_azimuth_angles: 65 numbers, expected 64");
  // A beam that looks 67 degrees aside, 191 columns of 1024.
  std::string aside = With("");
  aside.replace(aside.find("-3.1"), 4, "64.0");
  ExpectRefused(aside, "scan.json: beam_azimuth_angles: spread over more than 128 of 1024 columns");
  ExpectRefused("{" + Beams(63) + "}",
                "scan.json: beam_altitude_angles: 63 beams, expected 16, 32, 64 or 128");
  ExpectRefused("{" + Beams(129) + "}",
                "scan.json: beam_altitude_angles: 129 beams, at most 128 are handled",
                Status::kCapacityExceeded);
  ExpectRefused(With(R"("data_format": {"pixels_per_column": -64})"),
                "scan.json: pixels_per_column: must be in 1 .. 2147483647");
  ExpectRefused(With(R"("data_format": {"pixels_per_column": 200})"),
                "scan.json: pixels_per_column: 200 beams, at most 128 are handled",
                Status::kCapacityExceeded);
  ExpectRefused(With(R"("data_format": [1])"), "scan.json: data_format: expected an object");
}

TEST(OusterMetadata, NamesTheFieldOfABadFormat) {
  ExpectRefused("{" + Beams(64) + "}", "scan.json: lidar_mode: missing, and no columns_per_frame");
  ExpectRefused("{" + Beams(64) + R"(, "lidar_mode": "fast"})",
                "scan.json: lidar_mode: \"fast\" is not a known mode");
  ExpectRefused("{" + Beams(64) + R"(, "lidar_mode": 1024})",
                "scan.json: lidar_mode: expected a text");
  ExpectRefused(With(R"("columns_per_frame": 2048)"),
                "scan.json: columns_per_frame: 2048, but lidar_mode says 1024");
  ExpectRefused(With(R"("columns_per_frame": -1024)"),
                "scan.json: columns_per_frame: must be in 1 .. 4096");
  ExpectRefused(With(R"("columns_per_frame": 18446744073709551615)"),
                "scan.json: columns_per_frame: must be in 1 .. 4096");
  ExpectRefused(With(R"("columns_per_packet": 0)"),
                "scan.json: columns_per_packet: must be in 1 .. 64");
  ExpectRefused(With(R"("columns_per_packet": 16.0)"),
                "scan.json: columns_per_packet: expected an integer");
  ExpectRefused(With(R"("column_window": [0])"), "scan.json: column_window: expected two integers");
  ExpectRefused(With(R"("column_window": [0, 1024])"),
                "scan.json: column_window: must be in 0 .. 1023");
  ExpectRefused(With(R"("udp_profile_lidar": "FUTURE_\u0007")"),
                "scan.json: udp_profile_lidar: \"FUTURE_?\" is not a known profile",
                Status::kUnsupported);
}

// SR-CFG03
TEST(OusterMetadata, NamesTheFieldOfABadIdentityOrGeometry) {
  ExpectRefused(With(R"("initialization_id": 16777216)"),
                "scan.json: initialization_id: must be in 0 .. 16777215");
  ExpectRefused(With(R"("prod_sn": "12x")"), "scan.json: prod_sn: \"12x\" is not a serial number");
  ExpectRefused(With(R"("prod_sn": "99999999999999999999")"),
                "scan.json: prod_sn: \"99999999999999999999\" is not a serial number");
  ExpectRefused(With(R"("prod_line": "012345678901234567890123")"),
                "scan.json: prod_line: longer than 23 characters", Status::kCapacityExceeded);
  ExpectRefused(With(R"("lidar_origin_to_beam_origin_mm": [1])"),
                "scan.json: lidar_origin_to_beam_origin_mm: expected a number");
  ExpectRefused(With(R"("lidar_origin_to_beam_origin_mm": 1e30)"),
                "scan.json: lidar_origin_to_beam_origin_mm: 1e+30 is beyond +-10000");
  ExpectRefused(With(R"("lidar_to_sensor_transform": [1, 2])"),
                "scan.json: lidar_to_sensor_transform: 2 numbers, expected 16");
  ExpectRefused(With(R"("lidar_to_sensor_transform": [2,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])"),
                "scan.json: lidar_to_sensor_transform: not a rotation and a translation");
  ExpectRefused(With(R"("lidar_to_sensor_transform": [-1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1])"),
                "scan.json: lidar_to_sensor_transform: not a rotation and a translation");
  ExpectRefused(With(R"("beam_to_lidar_transform": [1,0,0,5, 0,1,0,5, 0,0,1,0, 0,0,0,1])"),
                "scan.json: beam_to_lidar_transform: only a shift along x is handled",
                Status::kUnsupported);
}

TEST(OusterMetadata, KnowsEveryProfileByItsName) {
  const std::pair<const char*, Profile> profiles[] = {
      {"LEGACY", Profile::kLegacy},
      {"RNG19_RFL8_SIG16_NIR16", Profile::kRng19Rfl8Sig16Nir16},
      {"RNG15_RFL8_NIR8", Profile::kRng15Rfl8Nir8},
      {"RNG19_RFL8_SIG16_NIR16_DUAL", Profile::kRng19Rfl8Sig16Nir16Dual}};
  for (const auto& [name, profile] : profiles) {
    Metadata metadata;
    const std::string member = R"("udp_profile_lidar": ")" + std::string(name) + "\"";
    ASSERT_TRUE(ParseMetadata(With(member), "scan.json", metadata).ok()) << name;
    EXPECT_EQ(metadata.profile, profile) << name;
    PacketLayout layout;
    EXPECT_EQ(MakeLayout(metadata, layout), Status::kOk) << name;
  }
}

TEST(OusterMetadata, TakesTheCrcFromTheFirmwaresVersion) {
  struct Case {
    const char* members;
    FirmwareVersion firmware;
    bool crc;
  };
  const Case cases[] = {
      {R"("image_rev": "ousteros-image-prod-aries-v2.3.0+20220415163956")", {2, 3, 0}, false},
      {R"("image_rev": "ousteros-image-prod-bootes-v3.1.0+20240425071424")", {3, 1, 0}, false},
      {R"("image_rev": "ousteros-image-dev-bootes-v3.2.0-alpha.1+20240812193256")",
       {3, 2, 0},
       true},
      {R"("image_rev": "ousteros-image-prod-bootes-v3.2")", {3, 2, 0}, true},
      {R"("image_rev": "ousteros-image-prod-bootes-v10.0.12")", {10, 0, 12}, true},
      // The later field where the first says nothing; the first where both do.
      {R"("image_rev": "", "build_rev": "v3.2.1")", {3, 2, 1}, true},
      {R"("build_rev": "v1.14.0-beta.1-87-gde6f92c")", {1, 14, 0}, false},
      {R"("image_rev": "image-v2.5.3", "build_rev": "v3.2.0")", {2, 5, 3}, false},
      // No version.
      {R"("build_rev": "035522cb7ffa0b1f8c4adff238e03ca3397973c8")", {0, 0, 0}, false},
      {R"("image_rev": "v", "build_rev": "rev3.2.0")", {0, 0, 0}, false},
      {R"("image_rev": "v3", "build_rev": "v3.")", {0, 0, 0}, false},
      {R"("image_rev": "v-3.2.0", "build_rev": "v3.-2.0")", {0, 0, 0}, false},
      {R"("image_rev": "v99999999999.2.0", "build_rev": "v3.10000.0")", {0, 0, 0}, false},
      {R"("image_rev": null)", {0, 0, 0}, false}};
  for (const Case& one : cases) {
    Metadata metadata;
    ASSERT_TRUE(ParseMetadata(With(one.members), "scan.json", metadata).ok()) << one.members;
    EXPECT_EQ(metadata.firmware.first, one.firmware.first) << one.members;
    EXPECT_EQ(metadata.firmware.second, one.firmware.second) << one.members;
    EXPECT_EQ(metadata.firmware.third, one.firmware.third) << one.members;
    EXPECT_EQ(metadata.crc_in_footer, one.crc) << one.members;
  }
}

TEST(OusterMetadata, RefusesOtherPacketHeaders) {
  Metadata metadata;
  EXPECT_TRUE(
      ParseMetadata(With(R"("config_params": {"header_type": "STANDARD"})"), "scan.json", metadata)
          .ok());
  ExpectRefused(With(R"("config_params": {"header_type": "FUSA"})"),
                "scan.json: header_type: \"FUSA\" is not handled", Status::kUnsupported);
  ExpectRefused(With(R"("header_type": 1)"), "scan.json: header_type: expected a text");
  ExpectRefused(With(R"("image_rev": 3.2)"), "scan.json: image_rev: expected a text");
  ExpectRefused(With(R"("build_rev": ["v3.2.0"])"), "scan.json: build_rev: expected a text");
}

TEST(OusterMetadata, RefusesDeepNestingAndLargeTexts) {
  ExpectRefused(std::string(kMaxMetadataBytes + 1, ' '),
                "scan.json: larger than 1048576 bytes; not a lidar's metadata", Status::kOversized);
  const std::string deep(100000, '[');
  Metadata metadata;
  EXPECT_FALSE(ParseMetadata(deep, "scan.json", metadata).ok());
}

TEST(OusterMetadata, SaysWhyAFileCannotBeRead) {
  Metadata metadata;
  ReadOutcome outcome = ReadMetadata("/nowhere/scan.json", metadata);
  EXPECT_EQ(outcome.message, "/nowhere/scan.json: cannot be opened (No such file or directory)");
  EXPECT_EQ(outcome.status, Status::kInvalidArgument);
  outcome = ReadMetadata("/", metadata);
  EXPECT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.message.substr(0, 3), "/: ");
  // A file without end.
  outcome = ReadMetadata("/dev/zero", metadata);
  EXPECT_EQ(outcome.status, Status::kOversized);
  EXPECT_EQ(outcome.message, "/dev/zero: larger than 1048576 bytes");
}

// Changed anywhere, a file is read or refused; what is read is within the stated limits.
// SR-CFG03, SR-INP01
TEST(OusterMetadata, WithstandsDamage) {
  const std::string original = "{" + Beams(16) + R"(, "lidar_mode": "2048x10", "prod_line": "OS-1",
      "prod_sn": "992210000957", "initialization_id": 5431293, "image_rev": "image-v3.2.0+1",
      "data_format": {"column_window": [2000, 100], "columns_per_packet": 8}, "lidar_to_sensor_transform": )" +
                               kTransform + "}";
  const unsigned seed = 9001;
  SCOPED_TRACE(seed);
  std::mt19937 random(seed);
  int accepted = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text = original;
    for (size_t changes = 1 + random() % 3; changes > 0; --changes) {
      text[random() % text.size()] = static_cast<char>(random() % 256);
    }
    if (random() % 8 == 0) text.resize(random() % text.size());
    Metadata metadata;
    const ReadOutcome outcome = ParseMetadata(text, "scan.json", metadata);
    EXPECT_EQ(outcome.ok(), outcome.message.empty());
    EXPECT_EQ(outcome.message.find('\n'), std::string::npos);
    if (!outcome.ok()) continue;
    ++accepted;
    ASSERT_TRUE(metadata.beams >= 1 && metadata.beams <= kMaxBeams);
    ASSERT_TRUE(metadata.columns_per_frame >= 1 && metadata.columns_per_frame <= 4096);
    ASSERT_LT(metadata.column_window_last, metadata.columns_per_frame);
    ASSERT_GE(metadata.column_window_first, 0);
    ASSERT_TRUE(std::isfinite(metadata.lidar_origin_to_beam_origin_m));
    for (int row = 0; row < metadata.beams; ++row) {
      ASSERT_LE(std::abs(metadata.beam_altitude_deg[row]), 90.0f);
    }
  }
  EXPECT_GT(accepted, 0);
}

class RecordedMetadata : public testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("HARDPACK_DATA");
    if (folder == nullptr || !std::filesystem::exists(std::string(folder) + "/ouster")) {
      GTEST_SKIP() << "HARDPACK_DATA names no folder with ouster/";
    }
    folder_ = folder;
  }
  Metadata Read(const std::string& file) const {
    Metadata metadata;
    const ReadOutcome outcome = ReadMetadata(folder_ + "/" + file, metadata);
    EXPECT_TRUE(outcome.ok()) << outcome.message;
    return metadata;
  }

  std::string folder_;
};

TEST_F(RecordedMetadata, OfEveryFormIsRead) {
  const Metadata os2 = Read("ouster/OS-2-128-U1_v2.3.0_1024x10.json");
  EXPECT_EQ(os2.profile, Profile::kRng19Rfl8Sig16Nir16);
  EXPECT_EQ(os2.beams, 128);
  EXPECT_EQ(os2.init_id, 5431293u);
  EXPECT_EQ(os2.serial_number, 992210000957u);
  EXPECT_FLOAT_EQ(os2.sensor_from_lidar.translation.z_m, 0.078296f);
  EXPECT_STREQ(os2.product_line, "OS-2-128");
  EXPECT_EQ(os2.firmware.second, 3);
  EXPECT_FALSE(os2.crc_in_footer);

  const Metadata os1 = Read("ouster/OS-1-128_v2.3.0_1024x10.json");
  EXPECT_EQ(os1.profile, Profile::kRng15Rfl8Nir8);

  const Metadata reduced = Read("ouster/OS-1-64_sensor_config_reduced.json");
  EXPECT_EQ(reduced.profile, Profile::kLegacy);
  EXPECT_EQ(reduced.beams, 64);
  EXPECT_EQ(reduced.columns_per_frame, 1024);
  EXPECT_EQ(reduced.firmware.first, 0);
  EXPECT_FALSE(reduced.crc_in_footer);

  const Metadata gen1 = Read("ouster/meta_1_14_os1-64_legacy.json");
  EXPECT_EQ(gen1.profile, Profile::kLegacy);
  EXPECT_EQ(gen1.firmware.second, 14);
  EXPECT_EQ(gen1.serial_number, 991937000062u);
  EXPECT_FLOAT_EQ(gen1.beam_altitude_deg[0], 16.509f);

  const Metadata windowed = Read("ouster/windowed_frame1_0.json");
  EXPECT_EQ(windowed.columns_per_frame, 512);
  EXPECT_EQ(windowed.column_window_first, 1);
  EXPECT_EQ(windowed.column_window_last, 256);
  EXPECT_FLOAT_EQ(windowed.lidar_origin_to_beam_origin_m, 0.02767f);
  EXPECT_FALSE(windowed.crc_in_footer);

  const Metadata crc = Read("ouster/crc_test.json");
  EXPECT_EQ(crc.init_id, 11394290u);
  EXPECT_EQ(crc.firmware.first, 3);
  EXPECT_EQ(crc.firmware.second, 2);
  EXPECT_TRUE(crc.crc_in_footer);
  EXPECT_FLOAT_EQ(crc.lidar_origin_to_beam_origin_m, 0.027116f);
  EXPECT_FLOAT_EQ(crc.sensor_from_lidar.translation.z_m, 0.038195f);

  const Metadata rellis = Read("rellis/rellis_000104_os1-64_2048x10_legacy_reencoded.json");
  EXPECT_EQ(rellis.columns_per_frame, 2048);
  EXPECT_EQ(rellis.lidar_origin_to_beam_origin_m, 0.0f);
}

}  // namespace
}  // namespace hardpack::ouster
