#include "io/stream/y4m_stream.hpp"

#include <algorithm>
#include <span>
#include <string_view>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kLongestLine = 4096;  // ffmpeg's has about 80 characters

std::string headerLine(StoppableInput& input) {
  std::string line = input.readLine(kLongestLine);
  if (line.empty())
    throw InputError(input.name() +
                     ": ends before it begins; the program that writes it has failed, or nothing is piped into it");
  if (line.ends_with('\n'))
    line.pop_back();
  else if (line.starts_with("YUV4MPEG2") && line.size() < kLongestLine)
    throw InputError(input.name() + ": ends within the stream's header; the program that writes it has failed");
  else if (line.starts_with("YUV4MPEG2"))
    throw InputError(input.name() + ": the stream's header has no end within " + std::to_string(kLongestLine) +
                     " bytes; write the stream anew, as by" + kY4mCommand);
  return line;
}

}  // namespace

Y4mStream::Y4mStream(int descriptor, const std::string& name)
    : input_(descriptor, name), header_(parseY4mHeader(headerLine(input_), name)) {}

/// False where the stream ends before.
bool Y4mStream::skip(std::size_t bytes) {
  constexpr std::size_t kAtOnce = 1 << 16;
  skipped_.resize(std::min(bytes, kAtOnce));
  while (bytes > 0) {
    const std::size_t part = std::min(bytes, skipped_.size());
    if (input_.read(std::span(skipped_).first(part)) < part) return false;
    bytes -= part;
  }
  return true;
}

Y4mStream::Next Y4mStream::next(std::vector<std::uint8_t>& luma) {
  constexpr std::string_view kFrame = "FRAME";
  luma.resize(header_.lumaBytes());
  const std::string line = input_.readLine(kLongestLine);
  if (input_.stopped()) return Next::kStopped;
  if (line.empty()) return Next::kEnd;
  if (!line.ends_with('\n') && line.size() < kLongestLine &&
      line.substr(0, kFrame.size()) == kFrame.substr(0, line.size()))
    return Next::kCutShort;
  const bool begins = line.starts_with(kFrame) && (line[kFrame.size()] == '\n' || line[kFrame.size()] == ' ');
  if (!begins || !line.ends_with('\n'))
    throw InputError(name() + ": a frame should begin with a line FRAME, and there is '" + printable(line) +
                     "': the stream is damaged, or its frames are of another size than its header tells");
  const bool whole = input_.read(luma) == luma.size() && skip(header_.chromaBytes());
  if (input_.stopped()) return Next::kStopped;
  return whole ? Next::kFrame : Next::kCutShort;
}

}  // namespace motorcade
