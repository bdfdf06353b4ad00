#include <zwang/experiments/god_hand/step/cluster.h>

#include <algorithm>

#include <zwang/constraints/contact.h>
#include <zwang/core/model/motion.h>
#include <zwang/experiments/god_hand/step/lap.h>
#include <zwang/experiments/god_hand/step/solver_choice.h>

namespace zwang::god {
namespace {

constexpr double catch_up = 0.8;  // m/s
constexpr double jump = 8;        // activation distances that targets may go in a frame before it is one
constexpr double fastest = 8;     // m/s, of a hand: targets that go faster are not kept pace with

}  // namespace

Cluster::Cluster(GodObjects objects, const Surroundings& surroundings, const Options& options)
    : options_(options),
      objects_(std::move(objects)),
      skeleton_(objects_.scene),
      encounters_(objects_, surroundings),
      solver_(solver_of(options)) {
  for (const Body& body : objects_.scene.bodies) pose_.push_back(body.pose);
  for (const Object& object : surroundings.objects)
    objects_.scene.add(Body{.pose = object.pose, .motion = zwang::Motion::fixed});
  target_.resize(objects_.scene.bodies.size());
  way_.resize(size());
  screw_.resize(size());
  place(pose_);
}

void Cluster::place(std::span<const Pose<double>> poses) {
  std::vector<Pose<double>> closed(poses.begin(), poses.end());
  skeleton_.close(closed, options_.limits == Options::Limits::predictive);
  restore({closed, closed, std::vector<Vec<double, 6>>(size(), Vec<double, 6>::Zero()), false, false, 1});
}

Cluster::Memory Cluster::memory() const {
  return {pose_, {target_.begin(), target_.begin() + static_cast<long>(size())}, last_way_, blocked_, bent_, caution_};
}

void Cluster::restore(const Memory& memory) {
  end_ = pose_ = memory.pose;
  std::copy(memory.target.begin(), memory.target.end(), target_.begin());
  for (std::size_t b = 0; b < size(); ++b) {
    objects_.scene.bodies[b].pose = pose_[b];
    encounters_.place(static_cast<BodyId>(b), pose_[b]);
  }
  last_way_ = memory.last_way;
  blocked_ = memory.blocked;
  bent_ = memory.bent;
  caution_ = memory.caution;
  warm_ = {};
  solver_ = solver_of(options_);
}

void Cluster::place_object(std::size_t object, const Pose<double>& pose) {
  objects_.scene.bodies[size() + object].pose = pose;
  encounters_.place_object(object, pose);
}

void Cluster::aim(std::span<const Pose<double>> targets) {
  std::copy(targets.begin(), targets.end(), end_.begin());
  skeleton_.close(end_, options_.limits == Options::Limits::predictive);
  for (std::size_t b = 0; b < size(); ++b) {
    way_[b] = twist_between(target_[b], end_[b]);
    target_[b] = end_[b];
  }
  const double most = longest(way_);
  if (most > std::min(jump * options_.activation, fastest * options_.dt)) {
    blocked_ = false;
    caution_ = 1;
  }
  pace_ = most > fastest * options_.dt ? 0 : std::min(1.2 * most, jump * options_.activation);
  allowed_ =
      std::max({1.5 * pace_, 0.4 * options_.activation, std::min(catch_up * options_.dt, 2 * options_.activation)});
  done_ = held_ = counted_ = false;
  sub_step_ = 0;
}

void Cluster::write_rows(bool push) {
  Scene& scene = objects_.scene;
  auto& contacts = scene.list_of<Contact>();
  contacts.all.clear();
  contacts.labels.clear();
  contacts.keys.clear();
  for (const auto& [t, key, lift] : rows()) {
    const int object = encounters_.object_of(t.b);
    const BodyId partner = object < 0 ? t.b : object + static_cast<BodyId>(size());
    // Where pushing out to the whole gap contradicts itself (a wedge), rows only keep what gap there is.
    const double keep = options_.gap + lift, room = push ? t.gap - keep : std::max(t.gap - keep, 0.0);
    scene.add(contact_at(scene.bodies, t.a, partner, t.point_a, t.normal, room), "touch", key);
  }
}

bool Cluster::solve(Frame& frame) {
  solved_ = false;
  for (const bool push : {true, false}) {
    pushed_ = push;
    {
      const Lap lap(frame.times.assembly);
      write_rows(push);
      assembler_.assemble(objects_.scene, z_u_, {.dt = options_.dt}, problem_);
    }
    {
      const Lap lap(frame.times.solve);
      solver_.solve(problem_, {.tolerance = options_.tolerance, .warm_start = &warm_}, solution_);
    }
    if (frame.verified)
      frame.verified = worse(*frame.verified, measure(problem_, solution_, nullptr, options_.tolerance).verdict);
    solved_ = has_answer(problem_, solution_);
    if (solved_) break;
  }
  frame.claimed = worse(frame.claimed, solution_.status);
  if (!solved_) return false;
  complete_multipliers(problem_, solution_);
  warm_.key = problem_.key;
  warm_.lambda = solution_.lambda;
  take_solution();
  return true;
}

void Cluster::take_solution() {
  for (std::size_t b = 0; b < size(); ++b)
    way_[b] = solution_.z.segment<6>(6 * static_cast<Index>(b)) * options_.dt * options_.dt;
}

bool Cluster::solve_lazily(Frame& frame) {
  bool solved = solve(frame);
  while (solved) {
    int added = 0;
    {
      const Lap lap(frame.times.completion);
      added = encounters_.complete(way_, options_.gap, pushed_);
    }
    if (added == 0) break;
    frame.completed += added;
    solved = solve(frame);
  }
  return solved;
}

double Cluster::lambda(std::size_t row) const {
  return solved_ && solution_.lambda.size() == problem_.rows()
             ? solution_.lambda[problem_.rows() - static_cast<Index>(rows().size() - row)]
             : 0;
}

Vec<double, 6> Cluster::contact_row(std::size_t row, BodyId body) const {
  Vec<double, 6> part = Vec<double, 6>::Zero();
  const Index at = problem_.rows() - static_cast<Index>(rows().size() - row);
  for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator entry(problem_.J, at); entry; ++entry)
    if (entry.col() / 6 == body) part[entry.col() % 6] = entry.value();
  return part;
}

bool Cluster::presses() const {
  const double nothing = 1e-12 / (options_.dt * options_.dt);  // N: a kilogram, a picometre
  for (std::size_t r = 0; r < rows().size(); ++r)
    if (lambda(r) > nothing) return true;
  return false;
}

}  // namespace zwang::god
