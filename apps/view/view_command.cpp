#include "apps/view/view_command.hpp"

#include <cstdio>
#include <memory>
#include <semaphore>

#include "apps/console/stop_signals.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "apps/view/page_server.hpp"
#include "apps/view/recorded_view.hpp"

namespace motorcade {

int runView(const ViewOptions& options) {
  const ListenAddress address = parseListenAddress(options.address, "--view");
  const RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  RecordedView view(run, sequence);
  if (!options.against.empty()) {
    const RunFolder other = readRunFolder(options.against);
    requireSameDrive(other, sequence);
    view.compareWith(std::make_unique<RecordedView>(other, sequence, worldOfOther(run, other)));
  }
  StopSignals signals;
  Viewers viewers;
  const PageServer server(address, view, viewers);
  viewers.publish(std::make_shared<const std::string>(eventJson(view.snapshot(), "")));
  std::printf("%s  (end with Ctrl-C)\n", server.url().c_str());
  std::fflush(stdout);
  std::binary_semaphore asked_to_end(0);
  const auto watch = signals.watch([&asked_to_end] { asked_to_end.release(); });
  asked_to_end.acquire();
  return 0;
}

}  // namespace motorcade
