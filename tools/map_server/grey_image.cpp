// SPDX-License-Identifier: Apache-2.0
#include "tools/map_server/grey_image.h"

#include <cairo.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <string_view>
#include <system_error>

namespace hardpack::map_server {
namespace {

ReadOutcome Failure(const std::string& path, const std::string& reason,
                    Status status = Status::kInvalidArgument) {
  return {status, path + ": " + reason};
}

ReadOutcome CheckSize(const std::string& path, int64_t width_px, int64_t height_px) {
  const std::string size = std::to_string(width_px) + " x " + std::to_string(height_px);
  if (width_px < 1 || height_px < 1)
    return Failure(path, "image size " + size + " is not positive");
  if (width_px > kMaxSide_px || height_px > kMaxSide_px || width_px * height_px > kMaxPixels) {
    return Failure(path, "image size " + size + " is too large", Status::kCapacityExceeded);
  }
  return {};
}

// Walks through the words of a PGM: white space and comments (# to the end of the line) part them.
class PgmWords {
 public:
  explicit PgmWords(std::string_view bytes) : bytes_(bytes) {}

  size_t position() const { return position_; }

  // False if the next word is missing or not a number from 0 to 2^31 - 1.
  bool NextNumber(int& value) {
    SkipBlank();
    const char* first = bytes_.data() + position_;
    const auto [end, error] = std::from_chars(first, bytes_.data() + bytes_.size(), value);
    if (error != std::errc{} || value < 0) return false;
    position_ += static_cast<size_t>(end - first);
    return position_ == bytes_.size() || IsBlank(bytes_[position_]) || bytes_[position_] == '#';
  }

  // Nothing but white space and comments is left.
  bool AtEnd() {
    SkipBlank();
    return position_ == bytes_.size();
  }

 private:
  static bool IsBlank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

  void SkipBlank() {
    while (position_ < bytes_.size()) {
      if (bytes_[position_] == '#') {
        position_ = std::min(bytes_.find('\n', position_), bytes_.size());
      } else if (IsBlank(bytes_[position_])) {
        ++position_;
      } else {
        return;
      }
    }
  }

  std::string_view bytes_;
  size_t position_ = 0;
};

struct PgmHeader {
  bool binary = false;
  int maximum = 0;
  size_t data_offset = 0;
};

ReadOutcome ReadPgmHeader(const std::string& path, std::string_view bytes, PgmHeader& header,
                          GreyImage& image) {
  header.binary = bytes[1] == '5';
  PgmWords words(bytes.substr(2));
  int width_px = 0;
  int height_px = 0;
  if (!words.NextNumber(width_px)) return Failure(path, "PGM header: width is not a number");
  if (!words.NextNumber(height_px)) return Failure(path, "PGM header: height is not a number");
  if (!words.NextNumber(header.maximum)) {
    return Failure(path, "PGM header: largest grey value is not a number");
  }
  if (header.maximum < 1 || header.maximum > 65535) {
    return Failure(path, "PGM header: largest grey value " + std::to_string(header.maximum) +
                             " is not within 1 .. 65535");
  }
  if (ReadOutcome size = CheckSize(path, width_px, height_px); !size.ok()) return size;
  image.width_px = width_px;
  image.height_px = height_px;
  header.data_offset = 2 + words.position() + 1;  // exactly one blank after the maximum
  return {};
}

std::string PixelCount(const GreyImage& image) {
  return std::to_string(image.width_px) + " x " + std::to_string(image.height_px) + " pixels";
}

ReadOutcome ReadBinaryPixels(const std::string& path, std::string_view bytes,
                             const PgmHeader& header, GreyImage& image) {
  const size_t sample_bytes = header.maximum > 255 ? 2 : 1;
  const size_t pixels = static_cast<size_t>(image.width_px) * static_cast<size_t>(image.height_px);
  const std::string_view data =
      header.data_offset <= bytes.size() ? bytes.substr(header.data_offset) : std::string_view{};
  if (data.size() < pixels * sample_bytes) {
    return Failure(path, "the header says " + PixelCount(image) + ", the file ends before",
                   Status::kTruncated);
  }
  if (data.find_first_not_of(" \t\r\n", pixels * sample_bytes) != std::string_view::npos) {
    return Failure(path, "the header says " + PixelCount(image) + ", the file holds more",
                   Status::kOversized);
  }
  image.white.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    int value = static_cast<uint8_t>(data[i * sample_bytes]);
    if (sample_bytes == 2) value = value * 256 + static_cast<uint8_t>(data[2 * i + 1]);
    if (value > header.maximum) return Failure(path, "a grey value is above the stated largest");
    image.white[i] = static_cast<float>(value) / static_cast<float>(header.maximum);
  }
  return {};
}

ReadOutcome ReadTextPixels(const std::string& path, std::string_view bytes, const PgmHeader& header,
                           GreyImage& image) {
  const size_t pixels = static_cast<size_t>(image.width_px) * static_cast<size_t>(image.height_px);
  const std::string_view data =
      header.data_offset <= bytes.size() ? bytes.substr(header.data_offset) : std::string_view{};
  if (data.size() + 1 < 2 * pixels) {  // a digit and a blank for each
    return Failure(path, "the header says " + PixelCount(image) + ", the file ends before",
                   Status::kTruncated);
  }
  PgmWords words(data);
  image.white.resize(pixels);
  for (size_t i = 0; i < pixels; ++i) {
    int value = 0;
    if (words.AtEnd()) {
      return Failure(path, "the header says " + PixelCount(image) + ", the file ends before",
                     Status::kTruncated);
    }
    if (!words.NextNumber(value)) {
      return Failure(path, "pixel " + std::to_string(i) + " is not a number");
    }
    if (value > header.maximum) return Failure(path, "a grey value is above the stated largest");
    image.white[i] = static_cast<float>(value) / static_cast<float>(header.maximum);
  }
  if (!words.AtEnd()) {
    return Failure(path, "the header says " + PixelCount(image) + ", the file holds more",
                   Status::kOversized);
  }
  return {};
}

ReadOutcome ReadPgm(const std::string& path, std::string_view bytes, GreyImage& image) {
  PgmHeader header;
  if (ReadOutcome outcome = ReadPgmHeader(path, bytes, header, image); !outcome.ok()) {
    return outcome;
  }
  return header.binary ? ReadBinaryPixels(path, bytes, header, image)
                       : ReadTextPixels(path, bytes, header, image);
}

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;

// The bytes already in memory, for cairo to read from.
struct ByteSource {
  std::string_view left;
};

cairo_status_t TakeBytes(void* closure, unsigned char* target, unsigned int count) {
  auto* source = static_cast<ByteSource*>(closure);
  if (source->left.size() < count) return CAIRO_STATUS_READ_ERROR;
  source->left.copy(reinterpret_cast<char*>(target), count);
  source->left.remove_prefix(count);
  return CAIRO_STATUS_SUCCESS;
}

// Width and height stand at fixed places of a PNG, so they are judged before anything is unpacked.
int64_t PngNumber(std::string_view bytes, size_t offset) {
  int64_t value = 0;
  for (size_t i = 0; i < 4; ++i) value = value * 256 + static_cast<uint8_t>(bytes[offset + i]);
  return value;
}

ReadOutcome ReadPng(const std::string& path, std::string_view bytes, GreyImage& image) {
  if (bytes.size() < 24) return Failure(path, "the PNG header is cut", Status::kTruncated);
  const int64_t width_px = PngNumber(bytes, 16);
  const int64_t height_px = PngNumber(bytes, 20);
  if (ReadOutcome size = CheckSize(path, width_px, height_px); !size.ok()) return size;
  ByteSource source{bytes};
  const Surface surface(cairo_image_surface_create_from_png_stream(&TakeBytes, &source),
                        &cairo_surface_destroy);
  if (cairo_surface_status(surface.get()) != CAIRO_STATUS_SUCCESS ||
      cairo_image_surface_get_width(surface.get()) != width_px ||
      cairo_image_surface_get_height(surface.get()) != height_px) {
    return Failure(path, "the PNG is damaged or cut", Status::kTruncated);
  }
  image.width_px = static_cast<int>(width_px);
  image.height_px = static_cast<int>(height_px);
  const size_t pixels = static_cast<size_t>(width_px * height_px);
  image.white.resize(pixels);
  image.transparent.assign(pixels, 0);
  const bool has_alpha = cairo_image_surface_get_format(surface.get()) == CAIRO_FORMAT_ARGB32;
  const int stride = cairo_image_surface_get_stride(surface.get());
  const unsigned char* data = cairo_image_surface_get_data(surface.get());
  for (size_t i = 0; i < pixels; ++i) {
    const size_t row = i / static_cast<size_t>(width_px);
    const size_t column = i % static_cast<size_t>(width_px);
    const unsigned char* bgra = data + row * static_cast<size_t>(stride) + 4 * column;
    const int alpha = has_alpha ? bgra[3] : 255;
    image.transparent[i] = alpha < 255 ? 1 : 0;
    // Colours come multiplied by alpha.
    const int sum = bgra[0] + bgra[1] + bgra[2];
    image.white[i] = alpha == 0 ? 1.0f : static_cast<float>(sum) / static_cast<float>(3 * alpha);
  }
  return {};
}

}  // namespace

ReadOutcome ReadGreyImage(const std::string& path, GreyImage& image) {
  image = {};
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored))
    return Failure(path, "is a folder, not an image");
  std::ifstream file(path, std::ios::binary);
  if (!file) return Failure(path, "cannot be opened");
  const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  if (bytes.starts_with("P2") || bytes.starts_with("P5")) return ReadPgm(path, bytes, image);
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return ReadPng(path, bytes, image);
  return Failure(path, "is neither a grey PGM (P2, P5) nor a PNG", Status::kUnsupported);
}

}  // namespace hardpack::map_server
