#include "io/images/png_fast_decoder.hpp"

#include <algorithm>
#include <functional>

#include <gmock/gmock.h>
#include <zlib.h>

#include "io/files/errors.hpp"
#include "io/images/image_codec.hpp"
#include "tests/io/images/png_sample.hpp"
#include "tests/support/data_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using test::Deflate;
using test::pngChunk;
using test::pngChunksOf;
using test::pngOf;
using test::PngSample;

/// Outcome of decoding a file: pixels, or the message of the error.
struct Verdict {
  std::string message, pixels;
  bool operator==(const Verdict&) const = default;
};

Verdict verdictOf(const std::function<Image()>& decode) {
  Verdict verdict;
  try {
    const Image image = decode();
    for (int y = 0; y < image.height(); ++y)
      verdict.pixels.append(reinterpret_cast<const char*>(image.row(y)), static_cast<std::size_t>(image.width()));
  } catch (const InputError& error) {
    verdict.message = error.what();
  }
  return verdict;
}

enum class Way { kFast, kLibpng };

class PngFastDecoder : public testing::Test {
 protected:
  /// Expects libpng's verdict, and that the image comes, or does not come, by the fast way.
  void expectAsLibpng(std::string_view bytes, Way way) {
    const ImageSize size = pngCodec().header(bytes, "a.png").size;
    EXPECT_EQ(decodeCommonPng(bytes, size, pool_).has_value(), way == Way::kFast);
    expectAsLibpng(bytes);
  }
  void expectAsLibpng(std::string_view bytes) {
    for (const int sample_bits : {8, 10, 12, 15}) {
      EXPECT_TRUE(verdictOf([&] { return pngCodec().decode(bytes, "a.png", pool_, sample_bits); }) ==
                  verdictOf([&] { return decodeAnyPng(bytes, "a.png", pool_, sample_bits); }));
    }
    const Verdict verdict = verdictOf([&] { return pngCodec().decode(bytes, "a.png", pool_, kAllSampleBits); });
    EXPECT_TRUE(verdict == verdictOf([&] { return decodeAnyPng(bytes, "a.png", pool_); }));
    if (verdict.message.empty()) {
      ++accepted_;
    } else {
      ++refused_;
    }
  }

  ImagePool pool_;
  int accepted_ = 0, refused_ = 0;
};

TEST_F(PngFastDecoder, EachFilterComesOffAsInLibpng) {
  for (const int color :
       {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA}) {
    for (const int filters :
         {PNG_FILTER_NONE, PNG_FILTER_SUB, PNG_FILTER_UP, PNG_FILTER_AVG, PNG_FILTER_PAETH, PNG_ALL_FILTERS}) {
      SCOPED_TRACE(testing::Message() << "color " << color << ", filters " << filters);
      expectAsLibpng(PngSample{.color = color, .filters = filters}.write(), Way::kFast);
    }
  }
}

TEST_F(PngFastDecoder, GrayOfSixteenBitsIsDecodedToo) {
  for (const int color : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA})
    for (const int filters :
         {PNG_FILTER_NONE, PNG_FILTER_SUB, PNG_FILTER_UP, PNG_FILTER_AVG, PNG_FILTER_PAETH, PNG_ALL_FILTERS})
      expectAsLibpng(PngSample{.color = color, .bits = 16, .filters = filters}.write(), Way::kFast);
}

TEST_F(PngFastDecoder, EachSizeIsDecoded) {
  for (int width = 16; width < 80; ++width)
    expectAsLibpng(PngSample{.width = width, .height = 16 + width % 5}.write(), Way::kFast);
  expectAsLibpng(PngSample{.width = 1242, .height = 375}.write(), Way::kFast);
}

TEST_F(PngFastDecoder, EachDivisionIntoChunksIsDecoded) {
  for (const int idat_bytes : {6, 7, 100, 1001, 100'000})
    expectAsLibpng(PngSample{.idat_bytes = idat_bytes, .text = true}.write(), Way::kFast);
  auto chunks = pngChunksOf(PngSample{.idat_bytes = 500}.write());
  chunks.insert(chunks.end() - 1, pngChunk("IDAT"));
  chunks.insert(chunks.begin() + 2, pngChunk("IDAT"));
  chunks.insert(chunks.begin() + 1, pngChunk("IDAT"));
  expectAsLibpng(pngOf(chunks), Way::kFast);
  expectAsLibpng(pngOf(chunks) + "more", Way::kFast);
}

TEST_F(PngFastDecoder, EachKindOfStreamIsDecoded) {
  const std::string file = PngSample{.width = 300, .height = 200, .idat_bytes = 100'000}.write(),
                    rows = test::unpackedIdat(file);
  for (const int strategy : {Z_DEFAULT_STRATEGY, Z_FILTERED, Z_HUFFMAN_ONLY, Z_RLE, Z_FIXED})
    expectAsLibpng(test::withIdat(file, Deflate{.strategy = strategy}(rows)), Way::kFast);
  for (const int level : {0, 1, 9}) expectAsLibpng(test::withIdat(file, Deflate{.level = level}(rows)), Way::kFast);
  expectAsLibpng(test::withIdat(file, Deflate{.window_bits = 12}(rows)), Way::kLibpng);
}

TEST_F(PngFastDecoder, UnusualImagesAreLeftToLibpng) {
  for (const PngSample& sample :
       {PngSample{.bits = 4}, PngSample{.color = PNG_COLOR_TYPE_RGB, .bits = 16},
        PngSample{.color = PNG_COLOR_TYPE_PALETTE}, PngSample{.interlace = PNG_INTERLACE_ADAM7},
        PngSample{.bits = 16, .interlace = PNG_INTERLACE_ADAM7}, PngSample{.transparent = true},
        PngSample{.color = PNG_COLOR_TYPE_RGB, .transparent = true}})
    expectAsLibpng(sample.write(), Way::kLibpng);
  EXPECT_EQ(accepted_, 7);
}

TEST_F(PngFastDecoder, ImagesOfOneSizeTakeNoNewMemory) {
  for (const int level : {6, 0, 9, 1}) {
    decodeImage(PngSample{.level = level}.write(), "a.png", pool_);
    EXPECT_EQ(pool_.buffersMade(), 2U) << "the image and the work space";
  }
}

TEST_F(PngFastDecoder, ImagesOfDrivesComeOutAsFromLibpng) {
  constexpr std::size_t kPerDrive = 12;
  if (!fs::exists(test::dataFolder())) GTEST_SKIP() << "MOTORCADE_DATA holds no drives";
  for (const auto& drive : fs::directory_iterator(test::dataFolder())) {
    if (!drive.is_directory()) continue;
    std::vector<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(drive))
      if (entry.path().extension() == ".png") files.push_back(entry.path());
    std::ranges::sort(files);
    for (std::size_t i = 0; i < files.size(); i += 1 + files.size() / kPerDrive) {
      SCOPED_TRACE(files[i]);
      expectAsLibpng(readImageBytes(files[i]));
    }
  }
  EXPECT_EQ(refused_, 0);
}

/// Damaged files get libpng's verdict.
class DamagedPng : public PngFastDecoder {
 protected:
  static std::vector<std::string> wholeFiles() {
    return {PngSample{.width = 24, .height = 18, .idat_bytes = 150, .text = true}.write(),
            PngSample{.width = 18, .height = 16, .color = PNG_COLOR_TYPE_RGB}.write()};
  }
};

TEST_F(DamagedPng, WhereABitIsWrong) {
  for (const std::string& whole : wholeFiles()) {
    for (std::size_t at = 16; at < whole.size(); ++at) {
      for (const int bits : {0x01, 0x20, 0x80, 0xff}) {
        std::string file = whole;
        file[at] = static_cast<char>(file[at] ^ bits);
        SCOPED_TRACE(testing::Message() << "byte " << at << ", bits " << bits);
        expectAsLibpng(file);
      }
    }
  }
  EXPECT_GT(accepted_, 100);  // errors in texts
  EXPECT_GT(refused_, 1000);
}

TEST_F(DamagedPng, WhereABitIsWrongAndItsChecksumIsMadeRight) {
  for (const std::string& whole : wholeFiles()) {
    const auto chunks = pngChunksOf(whole);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      for (std::size_t at = 4; at + 4 < chunks[i].size(); ++at) {
        auto damaged = chunks;
        damaged[i][at] = static_cast<char>(damaged[i][at] ^ 1 << at % 8);
        damaged[i] = pngChunk(damaged[i].substr(4, damaged[i].size() - 8));
        SCOPED_TRACE(testing::Message() << "chunk " << i << ", byte " << at);
        expectAsLibpng(pngOf(damaged));
      }
    }
  }
  EXPECT_GT(refused_, 500);
}

TEST_F(DamagedPng, WhereItIsCut) {
  for (const std::string& whole : wholeFiles())
    for (std::size_t length = 0; length < whole.size(); ++length) expectAsLibpng(whole.substr(0, length));
  EXPECT_GT(refused_, 500);
}

TEST_F(DamagedPng, WhereChunksAreMissingDoubledOrExchanged) {
  for (const std::string& whole : wholeFiles()) {
    const auto chunks = pngChunksOf(whole);
    for (std::size_t i = 0; i < chunks.size(); ++i) {
      auto missing = chunks;
      missing.erase(missing.begin() + static_cast<std::ptrdiff_t>(i));
      expectAsLibpng(pngOf(missing));
      for (std::size_t j = 0; j < chunks.size(); ++j) {
        auto doubled = chunks, exchanged = chunks;
        doubled.insert(doubled.begin() + static_cast<std::ptrdiff_t>(j), chunks[i]);
        std::swap(exchanged[i], exchanged[j]);
        expectAsLibpng(pngOf(doubled));
        expectAsLibpng(pngOf(exchanged));
      }
    }
  }
}

TEST_F(DamagedPng, WhereOtherChunksComeBetween) {
  const std::string palette(9, '\x50');
  for (const std::string& whole : wholeFiles()) {
    for (const std::string& other :
         {std::string("tEXtkey\0text", 12), std::string("tRNS\0\x50\0\x50\0\x50", 10), "PLTE" + palette,
          std::string("gAMA\0\1\0\0", 8), std::string("ABCDunknown"), std::string("abcdunknown"), std::string("abCDx"),
          std::string("ab1Dx"), std::string("IENDx"), "tEXt" + std::string(8'100'000, 'x')}) {
      for (std::size_t i = 0; i <= pngChunksOf(whole).size(); ++i) {
        auto chunks = pngChunksOf(whole);
        chunks.insert(chunks.begin() + static_cast<std::ptrdiff_t>(i), pngChunk(other));
        SCOPED_TRACE(testing::Message() << other.substr(0, 4) << " at " << i);
        expectAsLibpng(pngOf(chunks));
      }
    }
  }
  EXPECT_GT(accepted_, 20);
  EXPECT_GT(refused_, 20);
}

TEST_F(DamagedPng, WhereTheStreamIsNotThatOfTheImage) {
  const std::string file = PngSample{}.write(), rows = test::unpackedIdat(file), packed = Deflate{}(rows);
  const auto expect = [&](const std::string& stream) { expectAsLibpng(test::withIdat(file, stream), Way::kLibpng); };
  expect(Deflate{}(rows + "x"));
  expect(Deflate{}(rows + rows + rows));
  expect(Deflate{}(rows.substr(0, rows.size() - 1)));
  expect(Deflate{}(""));
  expect(packed + "x");
  expect(packed + std::string(100'000, 'x'));
  for (std::size_t missing = 1; missing < packed.size(); ++missing) expect(packed.substr(missing));
  for (std::size_t length = 0; length < packed.size(); ++length) expect(packed.substr(0, length));
  for (const char filter : {'\5', '\x40', '\xff'}) {
    std::string wrong = rows;
    wrong[62 * 20] = filter;  // of the twentieth row
    expect(Deflate{}(wrong));
  }
}

TEST_F(DamagedPng, WhereItReachesBeyondItsWindow) {
  const std::string file = PngSample{.width = 300, .height = 200, .idat_bytes = 100'000}.write();
  std::string rows = test::unpackedIdat(file);
  constexpr int kRow_bytes = 301;
  std::ranges::copy(rows.substr(0, 10 * kRow_bytes), rows.begin() + 80 * kRow_bytes);  // the same ten rows again
  std::string packed = Deflate{}(rows);
  expectAsLibpng(test::withIdat(file, packed), Way::kFast);
  for (int bits = 0; bits < 7; ++bits) {
    packed[0] = static_cast<char>(bits << 4 | 8);
    packed[1] = static_cast<char>(31 - (static_cast<std::uint8_t>(packed[0]) << 8) % 31);
    expectAsLibpng(test::withIdat(file, packed), Way::kLibpng);
  }
}

}  // namespace
}  // namespace motorcade
