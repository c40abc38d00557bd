#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/stream/stoppable_input.hpp"
#include "io/stream/y4m_header.hpp"

namespace motorcade {

/// Reads a YUV4MPEG2 stream frame by frame, as it comes. One thread reads, any thread may stop.
class Y4mStream {
 public:
  enum class Next {
    kFrame,
    kEnd,
    kCutShort,  // the stream ends within a frame
    kStopped,
  };

  /// Waits for the stream's header. The caller keeps the descriptor; `name` is for messages. Throws InputError.
  Y4mStream(int descriptor, const std::string& name);

  const Y4mHeader& header() const { return header_; }
  const std::string& name() const { return input_.name(); }

  /// Waits for the next frame and fills `luma`, which is made as large as the plane. Throws InputError where no frame
  /// begins although one should.
  Next next(std::vector<std::uint8_t>& luma);
  void stop() { input_.stop(); }

 private:
  bool skip(std::size_t bytes);

  StoppableInput input_;
  Y4mHeader header_;
  std::vector<std::uint8_t> skipped_;
};

}  // namespace motorcade
