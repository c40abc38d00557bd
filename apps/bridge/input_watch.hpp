#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/bridge/messages/diagnostics.hpp"
#include "io/messages/stamp_pairing.hpp"

namespace motorcade {

/// Watches both image topics. Reports once when a side falls silent, or when both sides' images never make a pair.
/// Reports once more when all is well again.
class InputWatch {
 public:
  using Clock = std::chrono::steady_clock;
  struct Params {
    std::array<std::string, 2> topics{};
    std::int64_t tolerance_ns = 0;             // of the pairing, for messages
    std::chrono::milliseconds patience{2000};  // without an image, or a pair
  };
  struct News {
    bool bad = false;
    std::string text{};
    std::optional<StereoSide> side{};  // that fell silent or came back
  };
  InputWatch(Params params, Clock::time_point start);

  void imageCame(StereoSide side, Clock::time_point now) { images_[indexOf(side)].last = now; }
  void pairCame(Clock::time_point now) { pairs_.last = now; }
  /// The changes since the last call; to be called often.
  std::vector<News> look(Clock::time_point now);
  /// The fault as of the last look, in one sentence; empty where all is well.
  const std::string& problem() const { return problem_; }

 private:
  struct Stream {
    Clock::time_point last{};
    bool silent = false;
  };
  /// True where it fell silent or came back.
  bool changed(Stream& stream, Clock::time_point now) const;
  std::string silenceOf(StereoSide side) const;
  std::string problemNow() const;

  Params params_;
  std::array<Stream, 2> images_;
  Stream pairs_;
  std::string problem_{};
};

/// Counts that show the state of the input.
struct InputCounts {
  std::int64_t pairs = 0;                     // handed to the tracker
  std::array<std::int64_t, 2> unpaired{};     // dropped without an image of the other side
  std::int64_t unreadable = 0, rejected = 0;  // pairs: by the bridge, by the tracker
  std::int64_t overtaken = 0;                 // pairs that a newer one replaced before they were converted
};

/// The status of the input: ERROR if it has a problem.
ros::DiagnosticStatus inputStatusOf(const InputCounts& counts, const std::string& problem,
                                    const std::string& hardware_id);

}  // namespace motorcade
