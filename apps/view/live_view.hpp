#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "apps/pipeline/pipeline_result.hpp"
#include "apps/view/page_server.hpp"
#include "apps/view/replay_gate.hpp"
#include "apps/view/sequence_pictures.hpp"
#include "core/spsc_ring.hpp"
#include "frontend/motion/ground_plane.hpp"

namespace motorcade {

/// Shows a run on a page while it goes on. A thread of its own takes the run's data from bounded queues. If that is too
/// slow, the page misses frames. Without viewers nothing is made for the page.
class LiveView final : public RunListener, public PageSource {
 public:
  /// Number of the last frames that are kept for viewers who come later or look back.
  static constexpr std::size_t kKeptFrames = 600;

  /// Listens at once. Throws OutputError if it cannot.
  LiveView(const ListenAddress& address, const ShownRun& run, const Sequence& sequence);
  /// Tells the page that the run is over.
  ~LiveView() override;
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  /// URL of the page, with the token that holds the run if the run can be held.
  std::string url() const { return run_.can_pause ? server_->controlUrl() : server_->url(); }
  /// Gate that holds the replay; null where the run cannot be held.
  ReplayGate* gate() { return run_.can_pause ? &gate_ : nullptr; }
  void frameEntered(const StereoFrame& frame) override;
  void frameLeft(const PipelineResult& result) override;
  /// Sets the function that other threads ask for the pipeline's state. An empty one takes it back.
  void followPipeline(std::function<PipelineState()> state);

 private:
  struct Picture {
    FrameId frame;
    Image left;
  };
  struct Result {
    FrameEstimate online;
    std::vector<ObjectMask> masks;
    FrameMeasurementsPtr measurements;  // null where nobody looks
    FrameTiming timing;
  };

  ShownRun run() const override { return run_; }
  RunSnapshot snapshot() const override;
  std::string framesJson(std::int64_t from, std::size_t count) const override;
  std::string frameJson(std::int64_t frame) const override;
  std::shared_ptr<const std::string> picture(std::int64_t frame) override;
  bool control(const std::string& action) override;

  void work();
  ShownFrame shownOf(const Result& result);
  std::optional<RoadPlane> roadOf(const Result& result);
  void encodePicture(FrameId frame);
  void publish();

  ShownRun run_;
  SequencePictures older_pictures_;
  Viewers viewers_;
  ReplayGate gate_;
  GroundPlaneEstimator ground_;  // the view's thread only, as the next two
  bool saw_road_ = false;
  std::deque<Picture> entered_;
  SpscRing<Picture> pictures_;
  SpscRing<Result> results_;
  RunCounts counts_;
  mutable std::mutex mutex_;  // of all below; the pipeline's threads never take it
  std::function<PipelineState()> state_;
  PipelineState last_state_;
  bool ended_ = false;
  std::deque<ShownFrame> history_;
  FrameId encoded_frame_;
  std::shared_ptr<const std::string> encoded_;
  std::unique_ptr<PageServer> server_;
  std::jthread thread_;
};

}  // namespace motorcade
