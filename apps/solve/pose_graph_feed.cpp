#include "apps/solve/pose_graph_feed.hpp"

#include <algorithm>
#include <cassert>
#include <utility>

#include "backend/factors/pose_factors.hpp"
#include "backend/graph/held_end_factor.hpp"
#include "backend/graph/relative_pose_factor.hpp"
#include "backend/solver/problem_finder.hpp"
#include "core/thread_placement.hpp"

namespace motorcade {
namespace {

constexpr double kGaugeSigma = 1e-4;  // m and rad; no edge disagrees with it, so that any small number does

std::vector<std::size_t> updateEnds(const PoseGraph& graph, const PoseGraphIndex& index, PoseGraphFeed::Pace pace) {
  std::vector<std::size_t> ends;
  if (pace == PoseGraphFeed::Pace::kByPose && graph.frame_ends.empty()) {
    for (std::size_t pose = 0; pose < index.size(); ++pose) ends.push_back(pose + 1);
    return ends;
  }
  if (pace == PoseGraphFeed::Pace::kByPose)
    for (const std::int64_t id : graph.frame_ends) ends.push_back(index.after(id));
  ends.push_back(index.size());  // the last frame may have no end yet
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  if (ends.front() == 0) ends.erase(ends.begin());
  return ends;
}

std::unique_ptr<JacobianFactor> gaugeOf(VariableId v, bool planar) {
  const double weight = 1 / kGaugeSigma;
  if (planar) return std::make_unique<PriorFactorSE2>(v, SE2{}, Eigen::Matrix3d::Identity() * weight * weight);
  return std::make_unique<PriorFactor>(std::array{v}, PriorModel{},
                                       PoseNoise{.sqrt_information = Matrix6d::Identity() * weight});
}

std::unique_ptr<JacobianFactor> factorOf(const PoseGraph::Edge& edge, VariableId from, VariableId to) {
  if (const auto* planar = std::get_if<SE2>(&edge.measured))
    return std::make_unique<RelativePoseFactorSE2>(from, to, *planar, edge.information);
  return std::make_unique<RelativePoseFactorSE3>(from, to, std::get<SE3>(edge.measured), edge.information);
}

PoseGraph::Pose poseIn(const Value& value) {
  if (const auto* planar = std::get_if<SE2>(&value)) return *planar;
  return std::get<SE3>(value);
}

PoseGraph::Pose movedBy(const PoseGraph::Pose& move, const Value& value) {
  if (const auto* planar = std::get_if<SE2>(&value)) return std::get<SE2>(move) * *planar;
  return (std::get<SE3>(move) * std::get<SE3>(value)).normalized();
}

}  // namespace

IncrementalSolver::Params PoseGraphFeed::solverParams() {
  IncrementalSolver::Params params;
  params.spread_every_updates = 4;
  params.kept_bytes = std::size_t{8} << 20;  // what caches hold anyway is not made again
  params.kept_eliminations = 200;            // by which most cliques near the root are eliminated anew anyway
  return params;
}

PoseGraphFeed::PoseGraphFeed(const PoseGraph& graph, const IncrementalSolver::Params& params, Pace pace)
    : graph_(graph),
      index_(graph),
      gauge_(graph, index_),
      solver_(params),
      update_ends_(updateEnds(graph, index_, pace)),
      variable_(index_.size()),
      waits_(index_.size(), 0) {}

PoseGraphFeed::Update PoseGraphFeed::next() {
  assert(!atEnd());
  const double start_ms = threadCpu_ms();
  Update update;
  for (const std::size_t end = update_ends_[updates_done_++]; fed_ < end; ++fed_) feedPose(fed_, update);
  if (atEnd()) solver_.spreadAllNext();
  const auto& report = solver_.update();
  update.cpu_ms = threadCpu_ms() - start_ms;
  update.report = report;
  return update;
}

PoseGraphFeed::Update PoseGraphFeed::settle() {
  const double start_ms = threadCpu_ms();
  const auto& report = solver_.update();
  return {.cpu_ms = threadCpu_ms() - start_ms, .report = report};
}

void PoseGraphFeed::feedPose(std::size_t pose, Update& update) {
  const PoseGraphGauge::Part& part = gauge_.parts()[gauge_.partOf(pose)];
  if (part.size == 1) return;
  if (gauge_.isConstant(pose)) {
    feedConstant(pose, update);
  } else if (pose == part.first && part.held.size() == 1) {
    add(pose, graph_.planar ? Value(SE2{}) : Value(SE3{}), update);
    solver_.addFactor(gaugeOf(variable_[pose], graph_.planar));
  } else if (const auto joint = joinedTo(pose)) {
    addWithWaiting(pose, *joint, update);
  } else {
    waits_[pose] = 1;
  }
}

/// Feeds a constant. Its edges to variables enter with those; edges between constants count in chi2 alone.
void PoseGraphFeed::feedConstant(std::size_t pose, Update& update) {
  ++constants_, ++update.poses;
  for (const Neighbor& neighbor : index_.neighbors(pose))
    if (gauge_.isConstant(neighbor.pose) && neighbor.pose < pose) ++edge_count_, ++update.edges;
}

/// Finds the edge to a present pose that gives `pose` its initial value. Edges that constrain all directions come
/// first, then odometry, then the first edge in the file.
std::optional<PoseGraphFeed::Neighbor> PoseGraphFeed::joinedTo(std::size_t pose) const {
  std::optional<Neighbor> best;
  int best_rank = 0;
  for (const Neighbor& neighbor : index_.neighbors(pose)) {
    if (!present(neighbor.pose)) continue;
    const int rank =
        1 + (index_.id(neighbor.pose) == index_.id(pose) - 1 ? 1 : 0) + (graph_.edges[neighbor.edge].definite ? 2 : 0);
    if (rank > best_rank) best = neighbor;
    best_rank = std::max(best_rank, rank);
  }
  return best;
}

/// Goes breadth first, so that the initial value of a waiting pose comes over as few edges as possible.
void PoseGraphFeed::addWithWaiting(std::size_t pose, const Neighbor& joint, Update& update) {
  struct Joining {
    std::size_t pose;
    Neighbor joint;
  };
  std::vector<Joining> queue{{pose, joint}};
  for (std::size_t i = 0; i < queue.size(); ++i) {
    const Joining joining = queue[i];
    add(joining.pose, moved(valueOf(joining.joint.pose), joining.joint, joining.pose), update);
    for (const Neighbor& neighbor : index_.neighbors(joining.pose)) {
      if (waits_[neighbor.pose] == 0) continue;
      waits_[neighbor.pose] = 0;
      queue.push_back({neighbor.pose, {joining.pose, neighbor.edge}});
    }
  }
  if (queue.size() == 1) return;
  LateJoin late{.joining = index_.id(pose), .waited = {}};
  for (std::size_t i = 1; i < queue.size(); ++i) late.waited.push_back(index_.id(queue[i].pose));
  std::ranges::sort(late.waited);
  late_joins_.push_back(std::move(late));
}

void PoseGraphFeed::add(std::size_t pose, const Value& initial, Update& update) {
  variable_[pose] = solver_.addVariable(initial);
  assert(std::cmp_equal(variable_[pose].value, pose_of_variable_.size()));
  pose_of_variable_.push_back(pose);
  ++update.poses;
  for (const Neighbor& neighbor : index_.neighbors(pose)) {
    if (!present(neighbor.pose)) continue;
    if (!solver_.addFactor(factorTo(pose, neighbor))) {
      refused_edges_.push_back(neighbor.edge);
      continue;
    }
    ++edge_count_, ++update.edges;
  }
}

/// Value of a pose in the frame that the solver uses for its part.
Value PoseGraphFeed::valueOf(std::size_t pose) const {
  if (!gauge_.isConstant(pose)) return solver_.estimate(variable_[pose]);
  return std::visit([](const auto& value) { return Value(value); }, gauge_.valueOf(pose));
}

/// Factor between a variable and its neighbor, which may be a constant.
std::unique_ptr<JacobianFactor> PoseGraphFeed::factorTo(std::size_t pose, const Neighbor& neighbor) const {
  using Held = HeldEndFactor::Held;
  const auto& edge = graph_.edges[neighbor.edge];
  const bool forward = edge.to == index_.id(pose);
  const VariableId variable = variable_[pose], other = variable_[neighbor.pose];
  auto factor = factorOf(edge, forward ? other : variable, forward ? variable : other);
  if (!gauge_.isConstant(neighbor.pose)) return factor;
  return std::make_unique<HeldEndFactor>(std::move(factor), forward ? Held::kFirst : Held::kSecond,
                                         valueOf(neighbor.pose), variable);
}

/// Moves a pose at `start` over an edge to its neighbor.
Value PoseGraphFeed::moved(const Value& start, const Neighbor& from, std::size_t to) const {
  const auto& edge = graph_.edges[from.edge];
  const bool forward = edge.to == index_.id(to);
  if (const auto* pose = std::get_if<SE2>(&start)) {
    const SE2& Z = std::get<SE2>(edge.measured);
    return *pose * (forward ? Z : Z.inverse());
  }
  const SE3& Z = std::get<SE3>(edge.measured);
  return (std::get<SE3>(start) * (forward ? Z : Z.inverse())).normalized();
}

std::optional<VariableId> PoseGraphFeed::variableOf(std::int64_t pose_id) const {
  const std::size_t pose = index_.at(pose_id);
  if (pose == index_.size() || index_.id(pose) != pose_id || !variable_[pose].valid()) return std::nullopt;
  return variable_[pose];
}

double PoseGraphFeed::chi2() const {
  double sum = 0;
  Eigen::VectorXd r(graph_.planar ? 3 : 6);
  for (std::size_t pose = 0; pose < fed_; ++pose) {
    for (const Neighbor& neighbor : index_.neighbors(pose)) {
      const auto& edge = graph_.edges[neighbor.edge];
      if (edge.from != index_.id(pose) || !present(pose) || !present(neighbor.pose)) continue;
      if (std::ranges::find(refused_edges_, neighbor.edge) != refused_edges_.end()) continue;
      const Value from = valueOf(pose), to = valueOf(neighbor.pose);
      factorOf(edge, variable_[pose], variable_[neighbor.pose])->residual(std::array{&from, &to}, r);
      sum += r.squaredNorm();
    }
  }
  return sum;
}

std::vector<SolverProblem> PoseGraphFeed::problemsNow() const { return findProblems(solver_.graph(), solver_.tree()); }

std::vector<std::vector<std::int64_t>> PoseGraphFeed::disconnectedParts() const {
  std::vector<std::vector<std::int64_t>> parts(gauge_.parts().size());
  for (std::size_t pose = 0; pose < fed_; ++pose)
    if (gauge_.partOf(pose) != gauge_.mainPart()) parts[gauge_.partOf(pose)].push_back(index_.id(pose));
  std::erase_if(parts, [](const auto& part) { return part.empty(); });
  return parts;
}

/// Transform from the solver's frame of a part to the graph's; it takes the one held pose to its given value.
PoseGraph::Pose PoseGraphFeed::moveOf(std::size_t part) const {
  const auto& held = gauge_.parts()[part].held;
  if (held.size() > 1 || !present(held.front())) return graph_.planar ? PoseGraph::Pose(SE2{}) : PoseGraph::Pose(SE3{});
  const Value from = valueOf(held.front());
  const PoseGraph::Pose to = gauge_.valueOf(held.front());
  if (graph_.planar) return std::get<SE2>(to) * std::get<SE2>(from).inverse();
  return (std::get<SE3>(to) * std::get<SE3>(from).inverse()).normalized();
}

std::vector<PoseGraph::Vertex> PoseGraphFeed::vertices() const {
  std::vector<PoseGraph::Pose> moves;
  for (std::size_t part = 0; part < gauge_.parts().size(); ++part) moves.push_back(moveOf(part));
  std::vector<PoseGraph::Vertex> vertices;
  std::vector<char> placed(index_.size(), 0);
  for (std::size_t pose = 0; pose < fed_; ++pose) {
    const auto& part = gauge_.parts()[gauge_.partOf(pose)];
    if (part.size == 1 || (present(pose) && std::ranges::find(part.held, pose) != part.held.end())) {
      vertices.push_back({index_.id(pose), gauge_.valueOf(pose)});
    } else if (present(pose)) {
      vertices.push_back({index_.id(pose), movedBy(moves[gauge_.partOf(pose)], valueOf(pose))});
    } else if (placed[pose] == 0) {
      const auto waiting = placedPart(pose, placed);
      vertices.insert(vertices.end(), waiting.begin(), waiting.end());
    }
  }
  std::ranges::sort(vertices, {}, &PoseGraph::Vertex::id);
  return vertices;
}

/// The poses that wait together with `first`, at their positions along the edges.
std::vector<PoseGraph::Vertex> PoseGraphFeed::placedPart(std::size_t first, std::vector<char>& placed) const {
  std::vector<std::pair<std::size_t, Value>> part{{first, graph_.planar ? Value(SE2{}) : Value(SE3{})}};
  placed[first] = 1;
  std::vector<PoseGraph::Vertex> vertices;
  for (std::size_t i = 0; i < part.size(); ++i) {
    const auto [pose, value] = part[i];
    vertices.push_back({index_.id(pose), poseIn(value)});
    for (const Neighbor& neighbor : index_.neighbors(pose)) {
      if (waits_[neighbor.pose] == 0 || placed[neighbor.pose] != 0) continue;
      placed[neighbor.pose] = 1;
      part.emplace_back(neighbor.pose, moved(value, {pose, neighbor.edge}, neighbor.pose));
    }
  }
  return vertices;
}

}  // namespace motorcade
