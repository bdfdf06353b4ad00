#include <zwang/experiments/god_hand/step/simulation.h>

#include <algorithm>
#include <stdexcept>

#include <zwang/experiments/god_hand/step/simulation_state.h>

namespace zwang::god {
namespace {

bool finite(const Pose<double>& pose) { return pose.position.allFinite() && pose.rotation.allFinite(); }

std::string counts(std::size_t there, const char* what, std::size_t given, const char* of_what) {
  return std::to_string(there) + what + std::to_string(given) + of_what;
}

}  // namespace

Simulation::Simulation(Surroundings surroundings, std::span<const hand::Model> models, std::span<const Target> start,
                       const Options& options)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  if (models.size() != start.size() || models.empty())
    throw std::invalid_argument(counts(models.size(), " hands, ", start.size(), " starts"));
  State& s = *state_;
  s.models.assign(models.begin(), models.end());
  const double reach = options.limits == Options::Limits::predictive ? 0.25 : 0;  // rad
  std::vector<GodObjects> clusters;
  std::vector<Pose<double>> easy;
  for (std::size_t h = 0; h < models.size(); ++h) {
    const hand::Poses at = hand::assemble(start[h].palm, start[h].angles, models[h]),
                      straight = hand::assemble(start[h].palm, {}, models[h]);
    if (!std::all_of(at.begin(), at.end(), finite)) throw std::runtime_error("a hand's first target is not finite");
    s.target.insert(s.target.end(), at.begin(), at.end());
    easy.insert(easy.end(), straight.begin(), straight.end());
    if (clusters.empty() || options.clusters) clusters.emplace_back();
    const std::string prefix = models.size() == 1 ? "" : models[h].left ? "left " : "right ";
    add_hand(clusters.back(), models[h], start[h], prefix, reach);
  }
  s.build(std::move(clusters), easy);
}

Simulation::Simulation(Surroundings surroundings, std::vector<GodObjects> clusters, const Options& options)
    : state_(std::make_unique<State>(std::move(surroundings), options)) {
  if (clusters.empty()) throw std::invalid_argument("no god objects");
  for (const GodObjects& objects : clusters) {
    if (objects.shapes.empty() || objects.shapes.size() != objects.scene.bodies.size())
      throw std::invalid_argument(
          counts(objects.scene.bodies.size(), " god objects, ", objects.shapes.size(), " shapes"));
    for (const Body& body : objects.scene.bodies) state_->target.push_back(body.pose);
  }
  const std::vector<Pose<double>> easy = state_->target;
  state_->build(std::move(clusters), easy);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;

void Simulation::watch(Watch watch) { state_->watch = std::move(watch); }

const Surroundings& Simulation::surroundings() const { return state_->surroundings; }

std::span<const Pose<double>> Simulation::object_poses() const { return state_->object; }

std::vector<collision::Shape> Simulation::shapes() const {
  std::vector<collision::Shape> all;
  for (const Cluster& c : state_->clusters) all.insert(all.end(), c.objects().shapes.begin(), c.objects().shapes.end());
  return all;
}

const Frame& Simulation::step(std::span<const Target> targets) {
  State& s = *state_;
  if (targets.size() != s.models.size())
    throw std::invalid_argument(counts(s.models.size(), " hands, ", targets.size(), " targets"));
  s.wanted = s.target;
  bool tracked = true;
  for (std::size_t h = 0; h < targets.size(); ++h) {
    const hand::Poses at = hand::assemble(targets[h].palm, targets[h].angles, s.models[h]);
    const bool usable = targets[h].tracked && std::all_of(at.begin(), at.end(), finite);
    tracked = tracked && usable;
    if (usable) std::copy(at.begin(), at.end(), s.wanted.begin() + static_cast<long>(h * at.size()));
  }
  step(s.wanted);
  s.frame.tracked = tracked;
  return s.frame;
}

const Frame& Simulation::step(std::span<const Pose<double>> targets) {
  State& s = *state_;
  if (targets.size() != s.target.size())
    throw std::invalid_argument(counts(s.target.size(), " god objects, ", targets.size(), " targets"));
  s.frame.reset();
  s.frame.tracked = std::all_of(targets.begin(), targets.end(), finite);
  if (s.frame.tracked) std::copy(targets.begin(), targets.end(), s.target.begin());
  s.frame.number = s.number++;
  s.frame.time = static_cast<double>(s.frame.number) * s.options.dt;
  s.step();
  return s.frame;
}

}  // namespace zwang::god
