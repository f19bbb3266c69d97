// SPDX-License-Identifier: Apache-2.0
#include "tools/map_server/grey_image.h"

#include <cairo.h>

#include "test/tools/map_server/map_files.h"

namespace hardpack::map_server {
namespace {

using GreyImageFile = MapFiles;

// Reads it and expects a failure whose line names the file and holds `part`.
void ExpectRefused(const std::string& path, const std::string& part) {
  GreyImage image;
  const ReadOutcome outcome = ReadGreyImage(path, image);
  EXPECT_FALSE(outcome.ok());
  EXPECT_EQ(outcome.message.find(path), 0u) << outcome.message;
  EXPECT_NE(outcome.message.find(part), std::string::npos) << outcome.message;
  EXPECT_EQ(outcome.message.find('\n'), std::string::npos);
}

TEST_F(GreyImageFile, ReadsTextPgmWithCommentsBetweenAnyTwoWords) {
  const auto path =
      Write("a.pgm", "P2 # kind\n# a line\n3 # width\n2\n# largest\n10\n0 5 10\n# x\n1 2 3\n");
  GreyImage image;
  ASSERT_TRUE(ReadGreyImage(path, image).ok());
  ASSERT_EQ(image.width_px, 3);
  ASSERT_EQ(image.height_px, 2);
  EXPECT_EQ(image.white, (std::vector<float>{0.0f, 0.5f, 1.0f, 0.1f, 0.2f, 0.3f}));
}

TEST_F(GreyImageFile, ReadsBinaryPgmOf8Bit) {
  const auto path = Write("a.pgm", std::string("P5\n2 1\n255\n") + '\xff' + '\0');
  GreyImage image;
  ASSERT_TRUE(ReadGreyImage(path, image).ok());
  EXPECT_EQ(image.white, (std::vector<float>{1.0f, 0.0f}));
}

TEST_F(GreyImageFile, ReadsBinaryPgmOf16BitWithTheHighByteFirst) {
  const std::string pixels("\x10\x00\x00\x10", 4);
  const auto path = Write("a.pgm", "P5\n2 1\n8192\n" + pixels);
  GreyImage image;
  ASSERT_TRUE(ReadGreyImage(path, image).ok());
  EXPECT_EQ(image.white, (std::vector<float>{0.5f, 16.0f / 8192.0f}));
}

TEST_F(GreyImageFile, TakesAPixelThatLooksLikeABlankAsAPixel) {
  const auto path = Write("a.pgm", "P5 2 1 255\n\n ");
  GreyImage image;
  ASSERT_TRUE(ReadGreyImage(path, image).ok());
  EXPECT_EQ(image.white, (std::vector<float>{10.0f / 255.0f, 32.0f / 255.0f}));
}

TEST_F(GreyImageFile, RefusesDamagedPgm) {
  ExpectRefused(Write("no_size.pgm", "P5\n"), "width");
  ExpectRefused(Write("word.pgm", "P2 3 x 255 1 2 3"), "height");
  ExpectRefused(Write("negative.pgm", "P2 -3 1 255 1 2 3"), "width");
  ExpectRefused(Write("zero.pgm", "P5 0 4 255\n"), "not positive");
  ExpectRefused(Write("maximum.pgm", "P5 1 1 0\nx"), "largest grey value");
  ExpectRefused(Write("deep.pgm", "P5 1 1 65536\nxx"), "largest grey value");
  ExpectRefused(Write("short.pgm", "P5 2 2 255\nabc"), "ends before");
  ExpectRefused(Write("long.pgm", "P5 2 2 255\nabcde"), "holds more");
  ExpectRefused(Write("short_text.pgm", "P2 2 2 255\n1 2 3"), "ends before");
  ExpectRefused(Write("long_text.pgm", "P2 2 2 255\n1 2 3 4 5"), "holds more");
  ExpectRefused(Write("bright.pgm", "P2 2 1 9\n9 10"), "above the stated largest");
  ExpectRefused(Write("bright16.pgm", std::string("P5 1 1 256\n\xff\xff")), "above the stated");
  ExpectRefused(Write("letters.pgm", "P2 2 1 9\n9 abc"), "pixel 1");
}

TEST_F(GreyImageFile, RefusesHugeSizesWithoutAllocating) {
  ExpectRefused(Write("wide.pgm", "P5 2000000000 1 255\nx"), "too large");
  ExpectRefused(Write("area.pgm", "P5 32767 32767 255\nx"), "too large");
  ExpectRefused(Write("overflow.pgm", "P5 99999999999999999999 1 255\nx"), "width");
  ExpectRefused(Write("pretends.pgm", "P2 10000 10000 255\n1 2 3"), "ends before");
}

TEST_F(GreyImageFile, RefusesWhatIsNoImage) {
  ExpectRefused(Path("absent.pgm"), "cannot be opened");
  ExpectRefused(Path(""), "folder");
  ExpectRefused(Write("empty.pgm", ""), "neither");
  ExpectRefused(Write("colour.pgm", "P6 1 1 255\nabc"), "neither");
  ExpectRefused(Write("cut.png", "\x89PNG\r\n\x1a\n"), "cut");
}

TEST_F(GreyImageFile, ReadsPngAndItsTransparency) {
  // A 3 x 1 picture: white, black, and clear.
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_ARGB32, 3, 1);
  auto* pixels = reinterpret_cast<uint32_t*>(cairo_image_surface_get_data(surface));
  pixels[0] = 0xffffffffu;
  pixels[1] = 0xff000000u;
  pixels[2] = 0;
  cairo_surface_mark_dirty(surface);
  const std::string path = Path("a.png");
  ASSERT_EQ(cairo_surface_write_to_png(surface, path.c_str()), CAIRO_STATUS_SUCCESS);
  cairo_surface_destroy(surface);
  GreyImage image;
  ASSERT_TRUE(ReadGreyImage(path, image).ok());
  EXPECT_EQ(image.white[0], 1.0f);
  EXPECT_EQ(image.white[1], 0.0f);
  EXPECT_EQ(image.transparent, (std::vector<uint8_t>{0, 0, 1}));
}

TEST_F(GreyImageFile, RefusesDamagedPng) {
  cairo_surface_t* surface = cairo_image_surface_create(CAIRO_FORMAT_RGB24, 40, 40);
  const std::string path = Path("a.png");
  ASSERT_EQ(cairo_surface_write_to_png(surface, path.c_str()), CAIRO_STATUS_SUCCESS);
  cairo_surface_destroy(surface);
  std::ifstream file(path, std::ios::binary);
  std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  ExpectRefused(Write("half.png", bytes.substr(0, bytes.size() / 2)), "damaged or cut");
  std::string huge = bytes;
  huge[16] = '\x7f';  // the width's highest byte
  ExpectRefused(Write("huge.png", huge), "too large");
}

}  // namespace
}  // namespace hardpack::map_server
