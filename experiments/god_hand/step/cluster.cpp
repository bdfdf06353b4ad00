#include <zwang/experiments/god_hand/step/cluster.h>

#include <algorithm>

#include <zwang/core/model/motion.h>
#include <zwang/core/problem/law.h>
#include <zwang/experiments/god_hand/step/following.h>
#include <zwang/experiments/god_hand/step/lap.h>

namespace zwang::god {
namespace {

constexpr double leg = 0.25;    // rad
constexpr double still = 1e-7;  // m: what moves by less rests

// No point of the shape goes farther than this.
double travel(const collision::Shape& shape, const Vec<double, 6>& twist) {
  return twist.head<3>().norm() + twist.tail<3>().norm() * reach_of(shape);
}

}  // namespace

Cluster::Cluster(GodObjects objects, const Surroundings& surroundings, const Options& options)
    : options_(options),
      objects_(std::move(objects)),
      skeleton_(objects_.scene),
      contacts_(objects_, surroundings),
      solver_(options) {
  for (const Body& body : objects_.scene.bodies) pose_.push_back(body.pose);
  for (const Object& object : surroundings.objects) {
    objects_.scene.add(Body{.pose = object.pose, .motion = zwang::Motion::fixed});
    followed_.push_back(object.pose);
  }
  target_.resize(objects_.scene.bodies.size());
  step_.resize(size());
  swept_step_.resize(size());
  lead_.assign(size(), Vec<double, 6>::Zero());
  place(pose_);
}

void Cluster::place(PoseSpan poses) {
  std::vector<Pose<double>> closed(poses.begin(), poses.end());
  skeleton_.close(closed, options_.limits == Options::Limits::predictive);
  follow(followed_, objects_.scene.bodies, 1);
  restore({closed, closed, std::vector<Vec<double, 6>>(size(), Vec<double, 6>::Zero()), followed_,
           met() ? closed : std::vector<Pose<double>>(), Next::straight, 1});
}

Cluster::Memory Cluster::memory() const {
  return {
      pose_,      {target_.begin(), target_.begin() + static_cast<long>(size())}, last_step_, followed_, met_at_, next_,
      step_scale_};
}

void Cluster::restore(const Memory& memory) {
  end_ = pose_ = memory.pose;
  std::copy(memory.target.begin(), memory.target.end(), target_.begin());
  stand_at(pose_);
  last_step_ = memory.last_step;
  followed_ = memory.followed;
  next_ = memory.next;
  step_scale_ = memory.step_scale;
  met_at_ = memory.met_at;
  solver_.forget();
}

void Cluster::place_object(std::size_t object, const Pose<double>& pose) {
  objects_.scene.bodies[size() + object].pose = pose;
  contacts_.place_object(object, pose);
}

void Cluster::carry(std::span<const Vec<double, 6>> motion, std::span<const std::size_t> held, PoseSpan now) {
  for (std::size_t b = 0; b < size(); ++b) end_[b] = retract(pose_[b], motion[b]);
  skeleton_.close(end_, options_.limits == Options::Limits::predictive);
  const bool clear = way_is_clear_with(contacts_, pose_, end_, held, std::span(objects_.scene.bodies).subspan(size()),
                                       now, swept_step_, along_);
  if (clear) {
    before_carried_ = pose_;
    before_followed_ = followed_;
  }
  stand_at(clear ? end_ : pose_);
  for (const std::size_t o : held) followed_[o] = clear ? now[o] : followed_[o];
}

bool Cluster::put_back() {
  if (before_carried_.empty()) return false;
  stand_at(before_carried_);
  followed_ = before_followed_;
  return true;
}

void Cluster::stand_at(PoseSpan poses) {
  for (std::size_t b = 0; b < size(); ++b) {
    objects_.scene.bodies[b].pose = pose_[b] = poses[b];
    contacts_.place(static_cast<BodyId>(b), pose_[b]);
  }
}

void Cluster::aim(PoseSpan targets) {
  std::copy(targets.begin(), targets.end(), end_.begin());
  skeleton_.close(end_, options_.limits == Options::Limits::predictive);
  for (std::size_t b = 0; b < size(); ++b) {
    step_[b] = twist_between(target_[b], end_[b]);
    target_[b] = end_[b];
  }
  const double most = longest(step_);
  if (most > std::min(options_.jump, options_.fastest * options_.dt)) {
    if (next_ == Next::linear_if_pressed) next_ = Next::straight;
    step_scale_ = 1;
  }
  minimum_step_ = most > options_.fastest * options_.dt ? 0 : std::min(1.2 * most, options_.jump);
  largest_step_ = std::max({1.5 * minimum_step_, 0.4 * options_.activation,
                            std::min(options_.catch_up * options_.dt, 2 * options_.activation)});
  done_ = held_ = counted_ = false;
  solver_.begin();
  sub_step_ = 0;
}

void Cluster::write_rows(bool push) {
  Scene& scene = objects_.scene;
  auto& contacts = scene.list_of<Contact>();
  contacts.all.clear();
  contacts.labels.clear();
  contacts.keys.clear();
  written_ = &contacts;
  for (const auto& [t, key, lift] : rows()) {
    const int object = contacts_.object_of(t.b);
    const BodyId partner = object < 0 ? t.b : object + static_cast<BodyId>(size());
    // Where pushing out to the whole gap contradicts itself (a wedge), rows only keep what gap there is.
    const double keep = options_.gap + lift, room = met() ? 0.0 : push ? t.gap - keep : std::max(t.gap - keep, 0.0);
    Contact contact = contact_at(scene.bodies, t.a, partner, t.point_a, t.normal, room, object < 0 ? 0 : options_.mu);
    if (contact.friction > 0) {
      const Pose<double>& now = scene.bodies[static_cast<std::size_t>(partner)].pose;
      const Vec3 way = surface_way(followed_[static_cast<std::size_t>(object)], now, t.point_a);
      contact.surface = now.rotation.transpose() * way / options_.dt;
    }
    scene.add(std::move(contact), "touch", key);
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
      if (options_.law == Options::Friction::convex) problem_.law = without_lift(problem_.law);
      first_rows(problem_, rows().size(), row_at_);
      if (!options_.correct_drift) problem_.c.head(row_at_.empty() ? problem_.rows() : row_at_[0]).setZero();
    }
    {
      const Lap lap(frame.times.solve);
      solved_ = solver_.solve(problem_, left_of(options_, frame.times.solve), solution_);
    }
    if (frame.verified) {
      const double claimed = claimed_tolerance(solution_, options_.tolerance);
      frame.verified = worse(*frame.verified, measure(problem_, solution_, nullptr, claimed).verdict);
    }
    if (solved_) break;
  }
  frame.claimed = worse(frame.claimed, solver_.claimed());
  if (solver_.limited()) {
    frame.came_from(Origin::limited);
    first_rows(problem_, rows().size(), row_at_);
  }
  if (solved_) take_solution();
  return solved_;
}

void Cluster::take_solution() {
  for (std::size_t b = 0; b < size(); ++b)
    step_[b] = solution_.z.segment<6>(6 * static_cast<Index>(b)) * options_.dt * options_.dt;
  share_ = 1;
}

bool Cluster::solve_lazily(Frame& frame) {
  bool solved = solve(frame);
  while (solved) {
    int added = 0;
    {
      const Lap lap(frame.times.completion);
      added = contacts_.complete(step_, options_.gap, pushed_);
    }
    if (added == 0) break;
    frame.completed += added;
    solved = solve(frame);
  }
  return solved;
}

double Cluster::lambda(std::size_t row) const {
  return solved_ && solution_.lambda.size() == problem_.rows() ? solution_.lambda[row_at_[row]] : 0;
}

Vec3 Cluster::friction(std::size_t row) const {
  const Index at = row_at_[row];
  if (lambda(row) == 0 || problem_.tangents(at) == 0) return Vec3::Zero();
  const Mat3 frame = contact_frame(rows()[row].touch.normal);
  return solution_.lambda[at + 1] * frame.col(1) + solution_.lambda[at + 2] * frame.col(2);
}

Vec<double, 6> Cluster::contact_row(std::size_t row, BodyId body) const {
  Vec<double, 6> part = Vec<double, 6>::Zero();
  const Index at = row_at_[row];
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

// A sub-step: how far it goes of what the solve says, and its commit cycle.

double Cluster::longest(std::span<const Vec<double, 6>> ways) const {
  double most = 0;
  for (std::size_t b = 0; b < size(); ++b) most = std::max(most, travel(objects_.shapes[b], ways[b]));
  return most;
}

void Cluster::slow_down() { step_scale_ = std::max(step_scale_ / 2, still / largest_step_); }

// Bounds the motion of a cluster that presses: to 1.5 times what its targets moved in this frame, but at least to
// `catch_up`, and at most to the distance over which contacts are looked for. Each time it reverses, as between two
// contacts that the linear rows put too far apart, the bound is halved, but not below what the targets move. Reversals
// of nanometres, which a cluster at rest always makes, do not count: they would reduce the bound until the cluster
// followed no target any more.
void Cluster::bound() {
  const double most = longest(step_);
  double along = 0;
  for (std::size_t b = 0; b < size(); ++b) along += step_[b].head<3>().dot(last_step_[b].head<3>());
  if (along < 0 && most > std::max(minimum_step_, still))
    slow_down();
  else
    step_scale_ = std::min(1.0, 1.5 * step_scale_);
  const double allowed = std::max(step_scale_ * largest_step_, minimum_step_);
  if (most <= allowed) return;
  origin_ = std::max(origin_, Origin::bounded);
  for (std::size_t b = 0; b < size(); ++b) step_[b] *= allowed / most;
  share_ *= allowed / most;
}

// Gauss' function of what is left to the targets from the poses, less a motion [kg m^2].
double Cluster::constraint(PoseSpan poses, std::span<const Vec<double, 6>> less) const {
  double sum = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    const Body& body = objects_.scene.bodies[b];
    const Vec<double, 6> left = twist_between(poses[b], target_[b]) - lead_[b] - less[b];
    const Vec3 turn = poses[b].rotation.transpose() * left.tail<3>();
    sum += (body.mass * left.head<3>().squaredNorm() + turn.dot(body.inertia * turn)) / 2;
  }
  return sum;
}

// The linear step neglects that joints turn it into a curve: 30 mm behind its target a finger overshoots by more than
// the step was to correct, and oscillates or diverges (Gauss-Newton with a large residual). So the step is damped: D is
// by how much Gauss' function at its end exceeds the linear prediction, |v|^2 the norm of the step. Along the step the
// function is about E0 - s |v|^2 + s^2 (|v|^2 / 2 + D), least at s = 1 / (1 + 2 D / |v|^2). Where there is no
// curvature, as when a hand slides, D = 0 and the step stays whole.
void Cluster::damp(Frame& frame) {
  candidate(1, frame);
  const Lap lap(frame.times.other);
  std::fill(swept_step_.begin(), swept_step_.end(), Vec<double, 6>::Zero());
  const double bent = constraint(end_, swept_step_) - constraint(pose_, step_);
  double norm = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    const Body& body = objects_.scene.bodies[b];
    const Vec3 turn = pose_[b].rotation.transpose() * step_[b].tail<3>();
    norm += body.mass * step_[b].head<3>().squaredNorm() + turn.dot(body.inertia * turn);
  }
  if (bent <= 1e-9 * constraint(pose_, swept_step_) || norm == 0) return;  // the solver's rounding of the joints
  origin_ = std::max(origin_, Origin::damped);
  for (std::size_t b = 0; b < size(); ++b) step_[b] /= 1 + 2 * bent / norm;
  share_ /= 1 + 2 * bent / norm;
}

// Straight to the targets, by at most `leg` of rotation at a time: on longer screws, each about its own centre, bodies
// that turn together would run through each other. Returns whether there is more to go.
bool Cluster::go_freely() {
  double turn = 0;
  for (std::size_t b = 0; b < size(); ++b) {
    step_[b] = twist_between(pose_[b], target_[b]);
    turn = std::max(turn, step_[b].tail<3>().norm());
  }
  if (turn <= leg) return false;
  for (std::size_t b = 0; b < size(); ++b) step_[b] *= leg / turn;
  return true;
}

bool Cluster::way_is_clear() {
  for (std::size_t b = 0; b < size(); ++b) swept_step_[b] = twist_between(pose_[b], target_[b]);
  return contacts_.time_of_contact(swept_step_) == 1;
}

// end_ = that part of the way, put onto the joints; swept_step_ = how each body gets there.
void Cluster::candidate(double part, Frame& frame) {
  const Lap lap(frame.times.other);
  for (std::size_t b = 0; b < size(); ++b) {
    swept_step_[b] = part * step_[b];
    end_[b] = retract(pose_[b], swept_step_[b]);
  }
  if (printed()) return;
  skeleton_.close(end_, options_.limits == Options::Limits::predictive);
  for (std::size_t b = 0; b < size(); ++b) swept_step_[b] = twist_between(pose_[b], end_[b]);
}

double Cluster::sweep(Frame& frame) {
  const Lap lap(frame.times.sweep);
  return contacts_.time_of_contact(swept_step_);
}

// The way straight to the targets is for a hand that nothing presses on. A finger that unrolls along it may go down
// before it goes up, where the linear rows see it leave. If it is stopped by something nearer than the activation
// distance, the linear step, whose rows include that contact, is taken instead. Otherwise the hand would approach the
// obstacle by ever smaller times of contact and stop there.
//
// Algorithm 1, lines 2 to 10: the way of every god object is chosen here, and swept against all objects at once. The
// paper's own choice is the linear step alone.
double Cluster::propose(Frame& frame) {
  {
    const Lap lap(frame.times.other);
    couple_to_targets(objects_.scene, target_, reaching_stiffness(options_.dt), z_u_);
    for (std::size_t b = 0; b < size(); ++b)
      z_u_.segment<6>(6 * static_cast<Index>(b)) -= reaching_stiffness(options_.dt) * lead_[b];
  }
  // Two bodies may each go so far toward the other: the sweep then asks for nothing new.
  find_rows(met() ? options_.gap : std::max(options_.activation, 2.3 * largest_step_), frame);
  if (!counted_) {
    frame.raw += static_cast<int>(contacts_.raw());
    frame.kept += static_cast<int>(rows().size());
  }
  counted_ = true;
  solved_at_ = pose_;
  std::fill(step_.begin(), step_.end(), Vec<double, 6>::Zero());
  way_ = Way::none;
  origin_ = Origin::held;
  if (!solve_lazily(frame)) {
    std::fill(step_.begin(), step_.end(), Vec<double, 6>::Zero());
    candidate(1, frame);
    return 1;
  }
  const bool pressing = presses();
  if (may_go_straight(pressing)) {
    const bool part_of_it = go_freely();
    candidate(1, frame);
    const double toc = sweep(frame);
    if (toc == 1 || (!pressing && toc * longest(swept_step_) > options_.activation)) {
      way_ = part_of_it ? Way::leg : Way::straight;
      origin_ = Origin::free;
      solution_.lambda.setZero();  // nothing is held back
      return toc;
    }
    take_solution();
  }
  way_ = Way::linear;
  origin_ = !pressing ? Origin::free : pushed_ ? Origin::constrained : Origin::relaxed;
  next_ = pressing ? Next::linear_if_pressed : Next::straight;
  if (options_.damped && !printed()) damp(frame);
  if (options_.bounded) bound();
  candidate(1, frame);
  return sweep(frame);
}

bool Cluster::may_go_straight(bool pressing) const {
  if (printed() || !options_.straight || next_ == Next::linear) return false;
  return !pressing || next_ == Next::straight;
}

// Algorithm 1, line 13, as printed: the contacts that the last step ran into are looked for at its time of contact.
// With the time of contact applied twice the god objects did not get there.
void Cluster::find_rows(double reach, Frame& frame) {
  const Lap lap(frame.times.search);
  using Choice = Contacts::Choice;
  const Choice choice = !options_.reduce_contacts ? Choice::raw : options_.lazy_contacts ? Choice::few : Choice::all;
  for (std::size_t b = 0; b < met_at_.size(); ++b) contacts_.place(static_cast<BodyId>(b), met_at_[b]);
  contacts_.find_rows(reach, choice);
  for (std::size_t b = 0; b < met_at_.size(); ++b) contacts_.place(static_cast<BodyId>(b), pose_[b]);
}

// The TOC counts once, or twice as Eq. 29-30 print it. As printed, the linear step ends there: the way before a time of
// contact is clear. In the cycle the pose at that part of the way is put onto the joints, which changes the way: it is
// swept again from the start, and shortened again where it meets something. The change by the joints falls with the
// square of the step, so that shorter steps are taken after one that was held. A straight way of which almost nothing
// is left is not taken; a linear step takes its place.
//
// Algorithm 1, lines 11 to 14.
void Cluster::commit(double toc, Frame& frame) {
  const bool leg = way_ == Way::leg, unobstructed = leg || way_ == Way::straight;
  double part = options_.toc_twice ? toc * toc : toc;
  if (part < 1 || !leg) ++sub_step_;
  frame.sub_steps = std::max(frame.sub_steps, sub_step_);
  done_ = sub_step_ == options_.sub_steps || (part == 1 && !leg);
  held_ = !solved_;
  bool clear = part == 1;
  for (std::size_t b = 0; b < met_at_.size(); ++b)
    met_at_[b] = printed() ? retract(pose_[b], Vec<double, 6>(toc * step_[b])) : pose_[b];
  if (printed()) candidate(part, frame), clear = true;
  for (const double less : {0.99, 0.9, 0.5}) {
    if (clear) break;
    part *= less;
    candidate(part, frame);
    const double again = sweep(frame);
    clear = again == 1;
    part *= again;
  }
  if (unobstructed && part < 1 && (!clear || longest(swept_step_) <= options_.activation)) {
    next_ = Next::linear;
    --sub_step_;
    done_ = false;
    return;
  }
  if (!clear) {
    held_ = true;
    slow_down();
    minimum_step_ /= 2;
    follow(followed_, objects_.scene.bodies, 1);
    return;
  }
  follow(followed_, objects_.scene.bodies, unobstructed ? 1 : part * share_);
  frame.came_from(origin_);
  const Lap lap(frame.times.sweep);
  std::ranges::copy(swept_step_, last_step_.begin());
  if (met() && !printed()) std::copy_n(end_.begin(), size(), met_at_.begin());
  stand_at(end_);
}

}  // namespace zwang::god
