#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "io/images/image_file.hpp"
#include "io/images/png_fast_decoder.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/remap.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/support/data_folder.hpp"

/// Cost of rectifying a pair on the way, beside that of decoding it and that of libpng. Items are pairs of euroc_v101.
namespace motorcade::perf {
namespace {

constexpr std::size_t kPairs = 16;

/// Opens the recording; empty where it is not there.
std::optional<Sequence> recording() {
  const auto folder = test::dataFolder() / "euroc_v101";
  if (!std::filesystem::exists(folder)) return std::nullopt;
  return openSequence(folder);
}

ImageSize sizeOf(const Sequence& sequence) { return {sequence.camera.width_px, sequence.camera.height_px}; }

Remap remapOf(const Sequence& sequence, StereoSide side) {
  const Rectification& rig = *sequence.rectification;
  const bool left = side == StereoSide::kLeft;
  return {left ? rig.left : rig.right, left ? rig.R_left : rig.R_right, rig.camera, sizeOf(sequence)};
}

/// Runs the work that `make_work(sequence)` returns once per iteration, or says that there is no data.
template <class Work>
void overRecording(benchmark::State& state, const Work& make_work) {
  const auto sequence = recording();
  if (!sequence) return state.SkipWithError("MOTORCADE_DATA holds no euroc_v101");
  auto work = make_work(*sequence);
  std::size_t index = 0;
  for (auto _ : state) work(index++ % kPairs);
  state.SetItemsProcessed(state.iterations());
}

void overFiles(benchmark::State& state, Image (*decode)(const std::string& bytes, ImagePool& pool)) {
  overRecording(state, [&](const Sequence& sequence) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < kPairs; ++i)
      for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight})
        files.push_back(readImageBytes(sequence.frames[i].of(side)));
    return [files, decode, pool = ImagePool()](std::size_t index) mutable {
      for (const std::size_t side : {0, 1}) benchmark::DoNotOptimize(decode(files[2 * index + side], pool).data());
    };
  });
}

void BM_DecodePair(benchmark::State& state) {
  overFiles(state, [](const std::string& bytes, ImagePool& pool) { return decodeImage(bytes, "pair", pool); });
}
BENCHMARK(BM_DecodePair)->Unit(benchmark::kMillisecond);

/// The unit of costs, on this drive.
void BM_DecodePairByLibpng(benchmark::State& state) {
  overFiles(state, [](const std::string& bytes, ImagePool& pool) { return decodeAnyPng(bytes, "pair", pool); });
}
BENCHMARK(BM_DecodePairByLibpng)->Unit(benchmark::kMillisecond);

void BM_RectifyPair(benchmark::State& state) {
  overRecording(state, [](const Sequence& sequence) {
    ImagePool pool;
    std::vector<Image> images;
    for (std::size_t i = 0; i < kPairs; ++i)
      for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight})
        images.push_back(readImage(sequence.frames[i].of(side), pool));
    return [images, pool, left = remapOf(sequence, StereoSide::kLeft),
            right = remapOf(sequence, StereoSide::kRight)](std::size_t index) mutable {
      benchmark::DoNotOptimize(left(images[2 * index], pool).data());
      benchmark::DoNotOptimize(right(images[2 * index + 1], pool).data());
    };
  });
}
BENCHMARK(BM_RectifyPair)->Unit(benchmark::kMillisecond);

/// Both maps, as it is done once per run.
void BM_BuildMaps(benchmark::State& state) {
  overRecording(state, [](const Sequence& sequence) {
    return [sequence](std::size_t) {
      benchmark::DoNotOptimize(remapOf(sequence, StereoSide::kLeft));
      benchmark::DoNotOptimize(remapOf(sequence, StereoSide::kRight));
    };
  });
}
BENCHMARK(BM_BuildMaps)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace motorcade::perf
