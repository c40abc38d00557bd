#include <memory>

#include <CLI/CLI.hpp>

#include "apps/commands/commands.hpp"
#include "apps/view/view_command.hpp"

namespace motorcade {

void addView(CLI::App& app, Action& action) {
  const auto options = std::make_shared<ViewOptions>();
  CLI::App* command = app.add_subcommand("view", "Serve a page that shows a run: image, scene, objects and times");
  command->add_option("run", options->run, "Run folder")->required();
  command->add_option("--against", options->against, "Another run of the same drive, shown beside it frame by frame")
      ->type_name("RUN");
  command->add_option("--sequence", options->sequence, "The sequence that was run, where it is no longer where it was");
  command
      ->add_option("--fps", options->fps_hz, "Capture rate where the sequence has no times [Hz]; the run's when absent")
      ->check(CLI::Range(0.001, 100'000.0));
  command->add_option("--view", options->address, "Where the page is served; 127.0.0.1:8080 when absent")
      ->type_name("ADDR:PORT");
  command->footer("Example: motorcade view RUN");
  command->callback([options, &action] { action = [options] { return runView(*options); }; });
}

}  // namespace motorcade
