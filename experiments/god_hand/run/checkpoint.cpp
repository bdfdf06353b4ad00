#include <stdexcept>

#include <zwang/experiments/god_hand/step/simulation_state.h>

namespace zwang::god {
namespace {

// Of poses, vectors and lists of them, in the order they have.
template <class Visit>
void each(double& x, const Visit& visit) {
  visit(x);
}
template <int Rows, int Columns, class Visit>
void each(Eigen::Matrix<double, Rows, Columns>& m, const Visit& visit) {
  for (double& x : m.reshaped()) visit(x);
}
template <class Visit>
void each(Pose<double>& pose, const Visit& visit) {
  each(pose.position, visit), each(pose.rotation, visit);
}
template <class Visit>
void each(bool& flag, const Visit& visit) {
  double x = flag;
  visit(x);
  flag = x != 0;
}
template <class T, class Visit>
void each(std::vector<T>& all, const Visit& visit) {
  for (T& one : all) each(one, visit);
}

}  // namespace

template <class Visit>
void Simulation::State::each_number(bool reading, const Visit& visit) {
  auto frames = static_cast<double>(number);
  visit(frames);
  number = static_cast<long>(frames);
  each(target, visit);
  for (Cluster& c : clusters) {
    Cluster::Memory m = c.memory();
    each(m.pose, visit), each(m.target, visit), each(m.last_way, visit);
    each(m.blocked, visit), each(m.bent, visit), each(m.caution, visit);
    if (reading) c.restore(m);
  }
  Coupling::Memory coupled = coupling->memory();
  each(coupled.hand_speed, visit), each(coupled.wrench, visit);
  Measures::Memory seen = measures->memory();
  for (int k = 0; k < 2; ++k) each(seen.god[k], visit), each(seen.target[k], visit);
  each(object, visit);
  for (std::size_t o = 0; physics && o < object.size(); ++o) {
    if (!surroundings.objects[o].loose()) continue;
    Pose<double> pose = physics->pose(o);
    Vec<double, 6> velocity = physics->velocity(o);
    each(pose, visit), each(velocity, visit);
    if (!reading) continue;
    physics->place(o, pose, velocity);
    for (Cluster& c : clusters) c.place_object(o, object[o]);
  }
  if (!reading) return;
  if (physics) physics->forget();
  coupling->restore(coupled);
  measures->restore(seen);
}

std::vector<double> Simulation::checkpoint() {
  std::vector<double> numbers;
  state_->each_number(false, [&](double& x) { numbers.push_back(x); });
  restore(numbers);
  return numbers;
}

void Simulation::restore(std::span<const double> checkpoint) {
  std::size_t count = 0;
  state_->each_number(false, [&](double&) { ++count; });
  if (checkpoint.size() != count) throw std::runtime_error("not a checkpoint of this simulation");
  const double* at = checkpoint.data();
  state_->each_number(true, [&](double& x) { x = *at++; });
}

}  // namespace zwang::god
