#include "perf/backend/solver/solver_options.hpp"

#include <map>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace motorcade::perf {
namespace {

const std::map<std::string, IncrementalSolver::Policy> kPolicies{{"fluid", IncrementalSolver::Policy::kFluid},
                                                                 {"every", IncrementalSolver::Policy::kEveryN}};

}  // namespace

void addSolverOptions(CLI::App& app, IncrementalSolver::Params& params) {
  const auto add = [&](const char* name, auto& value, const char* help) {
    app.add_option(name, value, help)->check(CLI::NonNegativeNumber)->capture_default_str()->group("Solver");
  };
  app.add_option("--policy", params.policy, "fluid: relinearize what is off; every: a batch step every N updates")
      ->transform(CLI::CheckedTransformer(kPolicies))
      ->group("Solver");
  add("--every", params.batch_every_updates, "N of --policy every");
  add("--mismatch-tolerance", params.relinearization.mismatch_tolerance,
      "Of a linear model, over the root mean square of the residuals");
  add("--jacobian-drift", params.relinearization.jacobian_drift_sigmas,
      "Summed mismatch of a factor at which its variables are relinearized");
  add("--relinearize", params.relinearization.relinearize_rad, "Turn of a variable at which it is relinearized [rad]");
  add("--leisurely", params.relinearization.leisurely_rad,
      "Turn of a variable from which on it is relinearized at leisure [rad]");
  add("--substitution-tolerance", params.substitution_tolerance, "Steps below that do not spread");
  add("--spread-every", params.spread_every_updates,
      "Updates between those that let all steps spread, while R is larger than caches");
  add("--urgent-flops", params.relinearization.urgent_flops,
      "Work per update that goes into relinearization as soon as possible");
  add("--polish-flops", params.relinearization.polish_flops,
      "Work per update that goes into relinearization at leisure");
  add("--iterations", params.iterations_per_update, "Gauss-Newton steps per update, at most");
  add("--iterated-scalars", params.iterated_scalars,
      "Substituted in an update, up to which it may take a further step; 0: no limit");
  add("--budget", params.budget.scalars, "Scalars eliminated per update beyond what new factors ask for; 0: no limit");
  add("--budget-flops", params.budget.flops,
      "Counted work of an update beyond that, half of it for eliminations; 0: no limit");
  add("--budget-ms", params.budget.ms, "Time of an update beyond that, half of it for eliminations; 0: no limit");
}

nlohmann::ordered_json jsonOf(const IncrementalSolver::Params& params) {
  return {{"policy", params.policy == IncrementalSolver::Policy::kFluid ? "fluid" : "every"},
          {"batch_every_updates", params.batch_every_updates},
          {"mismatch_tolerance", params.relinearization.mismatch_tolerance},
          {"jacobian_drift_sigmas", params.relinearization.jacobian_drift_sigmas},
          {"relinearize_rad", params.relinearization.relinearize_rad},
          {"leisurely_rad", params.relinearization.leisurely_rad},
          {"substitution_tolerance", params.substitution_tolerance},
          {"spread_every_updates", params.spread_every_updates},
          {"urgent_flops", params.relinearization.urgent_flops},
          {"polish_flops", params.relinearization.polish_flops},
          {"iterations_per_update", params.iterations_per_update},
          {"iterated_scalars", params.iterated_scalars},
          {"budget_scalars", params.budget.scalars},
          {"budget_flops", params.budget.flops},
          {"budget_ms", params.budget.ms}};
}

}  // namespace motorcade::perf
