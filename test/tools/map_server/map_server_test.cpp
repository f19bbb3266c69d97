// SPDX-License-Identifier: Apache-2.0
#include "tools/map_server/map_server.h"

#include "test/tools/map_server/map_files.h"

namespace hardpack::map_server {
namespace {

constexpr const char* kYaml =
    "image: map.pgm\nresolution: 0.05\norigin: [-1.0, -2.0, 0.0]\nnegate: 0\n"
    "occupied_thresh: 0.65\nfree_thresh: 0.196\n";

class MapServer : public MapFiles {
 protected:
  // A row of five pixels: black, dark, 205, light, white.
  void WriteImage() { Write("map.pgm", "P2 5 1 255 0 100 205 210 254\n"); }

  std::vector<Occupancy> PixelsWith(const std::string& yaml) {
    WriteImage();
    OccupancyMap map;
    const ReadOutcome outcome = ReadOccupancyMap(Write("map.yaml", yaml), map);
    EXPECT_TRUE(outcome.ok()) << outcome.message;
    return map.pixels;
  }

  // The map file with one line replaced, or removed when `line` is empty.
  static std::string With(const std::string& key, const std::string& line) {
    std::string yaml = kYaml;
    const size_t from = yaml.find(key + ":");
    const size_t to = yaml.find('\n', from);
    return yaml.replace(from, to - from + 1, line.empty() ? "" : line + "\n");
  }

  void ExpectRefused(const std::string& yaml, const std::string& part) {
    WriteImage();
    OccupancyMap map;
    const std::string path = Write("map.yaml", yaml);
    const ReadOutcome outcome = ReadOccupancyMap(path, map);
    EXPECT_FALSE(outcome.ok()) << yaml;
    EXPECT_NE(outcome.message.find(path), std::string::npos) << outcome.message;
    EXPECT_NE(outcome.message.find(part), std::string::npos) << outcome.message;
    EXPECT_EQ(outcome.message.find('\n'), std::string::npos) << outcome.message;
  }
};

constexpr Occupancy F = Occupancy::kFree;
constexpr Occupancy S = Occupancy::kSoft;
constexpr Occupancy U = Occupancy::kUnknown;
constexpr Occupancy H = Occupancy::kHard;

TEST_F(MapServer, TrinaryTakes205AsUnknownAndOtherGreyAsSoft) {
  EXPECT_EQ(PixelsWith(kYaml), (std::vector<Occupancy>{H, S, U, F, F}));
}

TEST_F(MapServer, Takes205AsUnknownWhateverTheFreeThreshold) {
  EXPECT_EQ(PixelsWith(With("free_thresh", "free_thresh: 0.25")),
            (std::vector<Occupancy>{H, S, U, F, F}));
}

TEST_F(MapServer, ScaleTakes205AsAnyOtherGrey) {
  std::string yaml = kYaml;
  yaml += "mode: scale\n";
  EXPECT_EQ(PixelsWith(yaml), (std::vector<Occupancy>{H, S, S, F, F}));
}

TEST_F(MapServer, NegateTakesWhiteAsOccupied) {
  EXPECT_EQ(PixelsWith(With("negate", "negate: 1")), (std::vector<Occupancy>{F, S, U, H, H}));
}

TEST_F(MapServer, CountsRowsUpwardFromTheOrigin) {
  // The image's upper row is black, its lower one white: y grows upward.
  Write("map.pgm", "P2 2 2 255 0 0 255 255\n");
  OccupancyMap map;
  ASSERT_TRUE(ReadOccupancyMap(Write("map.yaml", kYaml), map).ok());
  EXPECT_EQ(map.pixels, (std::vector<Occupancy>{F, F, H, H}));
  EXPECT_DOUBLE_EQ(map.origin_x_m, -1.0);
  EXPECT_DOUBLE_EQ(map.origin_y_m, -2.0);
  EXPECT_TRUE(map.Contains(-0.95, -1.95));
  EXPECT_FALSE(map.Contains(-0.85, -1.95));
}

TEST_F(MapServer, NamesTheKeyThatIsMissing) {
  for (const char* key :
       {"image", "resolution", "origin", "negate", "occupied_thresh", "free_thresh"}) {
    ExpectRefused(With(key, ""), std::string(key) + ": is missing");
  }
}

TEST_F(MapServer, RefusesValuesThatNoMapHas) {
  for (const char* value : {"0", "-0.05", ".nan", ".inf", "1e9", "wide", "[1]", ""}) {
    ExpectRefused(With("resolution", std::string("resolution: ") + value), "resolution: ");
  }
  ExpectRefused(With("origin", "origin: [1, 2]"), "origin: ");
  ExpectRefused(With("origin", "origin: 3"), "origin: ");
  ExpectRefused(With("origin", "origin: [.nan, 0, 0]"), "origin: x");
  ExpectRefused(With("origin", "origin: [0, 1e30, 0]"), "origin: y");
  ExpectRefused(With("origin", "origin: [0, 0, 0.3]"), "yaw");
  ExpectRefused(With("negate", "negate: 2"), "negate: ");
  ExpectRefused(With("occupied_thresh", "occupied_thresh: 1.5"), "occupied_thresh: ");
  ExpectRefused(With("free_thresh", "free_thresh: 0.65"), "free_thresh: ");
  ExpectRefused(std::string(kYaml) + "mode: raw\n", "mode: ");
  ExpectRefused(With("image", "image: absent.pgm"), "absent.pgm: cannot be opened");
}

TEST_F(MapServer, RefusesWhatIsNoMapFile) {
  ExpectRefused("just words", "not a map description");
  ExpectRefused("", "not a map description");
  ExpectRefused("image: [unclosed\n", "not YAML");
  ExpectRefused(std::string("\x00\x01\x02\xff", 4), "");
  OccupancyMap map;
  EXPECT_NE(ReadOccupancyMap(Path("absent.yaml"), map).message.find("cannot be opened"),
            std::string::npos);
  EXPECT_NE(ReadOccupancyMap(Path(""), map).message.find("folder"), std::string::npos);
}

}  // namespace
}  // namespace hardpack::map_server
