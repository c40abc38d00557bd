#include "apps/bridge/messages/diagnostics.hpp"

#include <array>
#include <cstddef>

#include <fmt/format.h>

#include "apps/bridge/messages/message_conversion.hpp"

namespace motorcade {
namespace {

using Level = ros::DiagnosticStatus::Level;

struct CauseWords {
  const char* name;  // as in the Python module
  const char* sentence;
};
/// The causes, in the order of `Result::Cause`.
constexpr std::array<CauseWords, 9> kCauses{{{"none", "measured"},
                                             {"after_gap", "measured across missing frames"},
                                             {"few_points", "measured by hardly points enough"},
                                             {"no_points", "nothing of the frames before is found again"},
                                             {"unlinked", "points are seen, but not how the camera moved"},
                                             {"failed", "a stage could not work"},
                                             {"unusable", "the images are of no use"},
                                             {"out_of_order", "its time does not follow that of the frame before"},
                                             {"too_late", "it did not come in time"}}};
static_assert(kCauses.size() == static_cast<std::size_t>(Result::Cause::kTooLate) + 1);

const CauseWords& wordsOf(Result::Cause cause) { return kCauses.at(static_cast<std::size_t>(cause)); }

Level levelOf(const Result& result) {
  if (result.status != Result::Status::kGood || !result.problem.empty()) return Level::kError;
  return result.cause == Result::Cause::kNone ? Level::kOk : Level::kWarn;
}

const char* prefixOf(Result::Status status) {
  if (status == Result::Status::kGood) return "";
  return status == Result::Status::kLost ? "lost: " : "rejected: ";
}

std::string messageOf(const Result& result) {
  const std::string sentence = std::string(prefixOf(result.status)) + wordsOf(result.cause).sentence;
  return result.problem.empty() ? sentence : sentence + "; " + result.problem;
}

}  // namespace

ros::DiagnosticArray diagnosticsOf(const Result& result, const std::string& hardware_id) {
  ros::DiagnosticStatus status;
  status.level = levelOf(result);
  status.name = "motorcade: tracker";
  status.message = messageOf(result);
  status.hardware_id = hardware_id;
  status.values = {{"frame", std::to_string(result.frame)},
                   {"cause", wordsOf(result.cause).name},
                   {"segment", std::to_string(result.segment)},
                   {"latency_ms", fmt::format("{:.1f}", result.latency_ms)},
                   {"dropped_before", std::to_string(result.dropped_before)},
                   {"objects", std::to_string(result.objects.size())}};
  return {.header = headerOf(result, ""), .status = {status}};
}

}  // namespace motorcade
