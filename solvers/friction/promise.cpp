#include <zwang/solvers/friction/promise.h>

#include <cmath>
#include <limits>

#include <zwang/solvers/form/bound_inside.h>
#include <zwang/solvers/solver_entry.h>

namespace zwang {
namespace {

constexpr int most_rounds = 6;  // exchanges of rows
constexpr double share = 10;    // of a method's work to one of looks
constexpr double rarer = 1.4;   // and from one look to the next
constexpr double eps = std::numeric_limits<double>::epsilon();
constexpr double rounding = tolerances::rank * eps;  // of a slack, relative to what it is a difference of

// Where every body's three linear unknowns are its mass times the unit: the least mass, else 0.
double lightest(const Problem& p) {
  double least = infinity;
  if (p.size() % 6 != 0) return 0;
  for (Index j = 0; j < p.size(); ++j)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it) {
      if (j % 6 >= 3 || it.value() == 0) continue;
      if (it.row() != j) return 0;
      least = std::min(least, it.value());
    }
  return std::isfinite(least) ? least : 0;
}

// By how much z may be off, relative to the motion, for being a vector of doubles.
double rounding_of(const Problem& p, const Vector& z) {
  if (z.size() != p.size() || z == p.z_u) return 0;
  double size = 0, motion = 0, free = 0;
  for (Index j = 0; j < p.size(); ++j)
    for (SparseMatrix::InnerIterator it(p.M, j); it; ++it) {
      const double term = z[it.row()] * it.value() * z[j];
      motion += term, size += std::abs(term);
      free += p.z_u[it.row()] * it.value() * p.z_u[j];
    }
  return eps / 2 * std::sqrt(size / std::max(motion, free));
}

}  // namespace

void Promise::begin(const Problem& problem, const SolveOptions& options, ConeProgram* rows, ModeEquations* equations) {
  problem_ = &problem;
  program_ = rows;
  modes_ = equations ? equations : &own_modes_;
  options_ = &options;
  ready_ = failed_ = arrived_ = takes_any_ = hopeless_ = vain_ = false;
  spent_ = 0;
  if (!options.has_accuracy()) return;
  lightest_ = options.speed_accuracy > 0 ? lightest(problem) : 0;
  failed_ = options.speed_accuracy > 0 && lightest_ == 0;
  // To bring the rows into their form, before it is known what a factor costs.
  constexpr double per_entry = 20;
  price_ = per_entry * static_cast<double>(problem.J.nonZeros() + problem.M.nonZeros());
  next_look_ = share * price_;
}

double Promise::enough(double motion, int exponent) const {
  if (takes_any_) return infinity;
  if (failed_) return 0;
  return options_->speed_accuracy > 0 ? std::ldexp(options_->speed_accuracy * std::sqrt(lightest_), -exponent)
                                      : options_->accuracy * motion;
}

bool Promise::is_due(double work, double left, double own) {
  if (!options_->has_accuracy() || failed_) return false;
  const bool arrives = !arrived_ && left <= options_->accuracy;
  arrived_ = arrived_ || arrives;
  if (!arrives && work < std::max(next_look_, share * own)) return false;
  if (own == 0 && !ready_ && (!prepare() || (!arrives && work < share * (spent_ + price_)))) return false;
  const double price = own > 0 ? own : price_;
  spent_ += price, stuck_ = false;  // paid for: of an iteration's forces others may pull
  next_look_ = std::max(rarer * work, share * (spent_ + price));
  return true;
}

// The rows, and what a look at them costs.
bool Promise::prepare() {
  if (ready_ || failed_) return ready_;
  failed_ = true;
  using Want = ConeProgram::Want;
  const Want want = problem_->has_tangents() ? Want::any : Want::sparse;
  if (!program_) {
    ConeProgram& own = own_.open();
    if (!own.build(*problem_, want, *options_, Deadline(options_->time_limit), scratch_)) return false;
    program_ = &own;
  }
  hopeless_ = program_->repeats_equalities();
  if (hopeless_) return false;
  const auto n = static_cast<double>(program_->face().unknowns()), m = static_cast<double>(program_->rows());
  constexpr double lanes = 4;  // multiplications of a dense factor at a time
  spent_ += price_;
  price_ = program_->is_dense() ? n * n * (m / 2 + n / 6) / lanes + ModeEquations::most_passes * n * (n + 3 * m) / lanes
                                : share * static_cast<double>(problem_->J.nonZeros() + problem_->M.nonZeros()) * share;
  if (modes_ == &own_modes_) own_modes_.begin(*program_);
  for (Vector* x : {&y_, &s_, &ds_, &x_, &t_}) x->setZero(program_->rows());
  for (Vector* x : {&v_, &dv_, &force_}) x->setZero(program_->face().unknowns());
  const double tied = program_->tied();
  factor_rounding_ = std::max(rounding, tied * tolerances::violation * eps);
  row_rounding_ = std::sqrt(tied) * rounding;
  failed_ = false;
  return ready_ = true;
}

bool Promise::holds(const Vector& lambda, Solution& solution) {
  if (!options_->has_accuracy() || !prepare()) return false;
  program_->read(lambda, y_);
  return holds_at(y_, solution);
}

bool Promise::holds_at(const Vector& y) {
  if (!options_->has_accuracy() || !prepare()) return false;
  y_ = y;
  bound_ = look();
  return bound_.is_enough;
}

bool Promise::holds_at(const Vector& y, Solution& solution) {
  if (!holds_at(y)) return false;
  program_->write(*problem_, v_, y_, solution);
  solution.error_bound = bound_.relative;
  solution.status = Status::solved;
  return true;
}

void Promise::judge(const Problem& problem, const SolveOptions& options, Solution& solution, double work) {
  const bool is_solved = solution.status == Status::solved || solution.status == Status::solved_ill_conditioned;
  if (!options.has_accuracy() || !is_solved) return;
  if (solution.lambda.size() != problem.rows() || solution.z.size() != problem.size()) return;
  if (problem_ != &problem) begin(problem, options);
  failed_ = hopeless_;
  solution.error_bound = options.prover ? infinity : Solution::unknown;
  if (!prepare()) return;
  program_->read(solution.lambda, y_);
  Bound bound = work < price_ ? look(true) : Bound();
  takes_any_ = true;
  if (!bound.is_enough) bound = look();
  if (!std::isfinite(bound.relative)) return;
  program_->write(problem, v_, y_, scratch_);
  const auto length = [&](const Vector& x) { return std::sqrt(std::max(0.0, x.dot(problem.M * x))); };
  const double far = length(scratch_.z - solution.z), free = length(problem.z_u), step = length(solution.z);
  const double apart = far > 0 ? far / std::max(free, step) : 0;
  if (!program_->law().lifts()) {
    // max(free, |z*|) >= max(free, step - both errors); the first is at most this share of it.
    const double motion = std::max(free, (step - far) / (1 + bound.relative));
    const double most = far > 0 ? bound.relative + far / motion : bound.relative;
    if (std::isfinite(most)) solution.error_bound = most;
  } else if (apart <= accepted_error(options.tolerance)) {
    solution.z = scratch_.z;
    solution.lambda = scratch_.lambda;
    solution.error_bound = bound.relative;
  }
}

// From y_. `stands`: v is not moved, and opens the rows itself, as at rest. No factor is made.
Promise::Bound Promise::look(bool stands) {
  h_ = program_->h();
  program_->face().force(y_, v_);
  program_->divide_by_mass(v_);
  program_->face().slack(v_, s_);
  s_ -= h_;
  reach_ = 0;
  for (Index i = 0; i < h_.size(); ++i)
    if (s_[i] < 0 || y_[i] != 0) reach_ = std::max(reach_, std::abs(h_[i]));
  double most = infinity;
  if (stands) {
    ds_ = s_ + h_, w_ = v_, half_ = 0, gap_ = y_.dot(s_);
    for (Index k = 0; k < program_->cones(); ++k) gap_ += program_->law().shift(&s_[3 * k]) * y_[3 * k];
    most = along(0, std::max(program_->scale(v_), reach_));
  }
  double before = infinity;
  const bool was_vain = std::exchange(vain_, true);
  const auto sticks = [&] { return 3 * std::ranges::count(modes_->mode, Mode::stick) == program_->rows(); };
  for (int round = 0; round < most_rounds && !stands; ++round) {
    const bool others = modes_->choose(*program_, y_, s_);
    if (round == 0 && was_vain && stuck_ && sticks()) break;  // it would end as the last
    if (!(round == 0 ? modes_->has_factor(*program_) || factorize() : (others || modes_->slides()) && factorize()))
      break;
    const double still = settle(), size = std::max(program_->scale(v_), reach_), missed = modes_->missed(*program_, s_);
    const bool met = missed <= rounding * size;
    if (!met && !(missed <= before)) break;  // it runs away
    before = missed;
    if (!met || !distance()) continue;
    const double first = still + factor_rounding_ * size + far_from(2 * half_, gap_);
    const bool is_near = first <= enough(program_->least_motion(v_), program_->exponent());
    vain_ = vain_ && is_near;
    if (!is_near) continue;
    most = with_rounding(first, still, size);
    break;
  }
  const double motion = program_->least_motion(v_) - most;
  const bool is_known = most < infinity && (motion > 0 || most == 0);
  vain_ = vain_ && !is_known && !modes_->slides();  // of what slides another factor may lead there
  stuck_ = !stands && sticks();
  return is_known ? Bound{most > 0 ? most / motion : 0, most <= enough(motion, program_->exponent())} : Bound();
}

// At (y_, s_), as contacts slide there.
void Promise::linearize(bool anew) {
  for (Index k = 0; k < program_->cones(); ++k)
    if (modes_->mode[at(k)] == Mode::slide) (void)program_->law().mode(&y_[3 * k], &s_[3 * k], modes_->slide[at(k)]);
  modes_->linearize(*program_, y_, s_, anew);
}

bool Promise::factorize() {
  modes_->softness = modes_->across = tolerances::promise_softness;
  linearize(true);
  return modes_->factorize(*program_);
}

// Newton's steps by the one factor, as far as they go. Returns how much v would still move.
double Promise::settle() {
  double last = infinity, length = infinity;
  for (int pass = 0; pass < ModeEquations::most_passes; ++pass) {
    linearize(false);
    modes_->step(*program_, v_, y_);
    program_->face().slack(v_, s_);
    s_ -= h_;
    last = length;
    length = program_->length(modes_->dv);
    if (!(length > rounding * program_->scale(v_))) return 2 * length;
    if (length > last / 2) break;
  }
  return length < last ? length * length / (last - length) + length : infinity;
}

// `first`, with what rounding in rows can do. Rows that are clearly independent, and the only ones that v touches, are
// met exactly near v; of a contact that hardly slides all three, as no plane is its cone's there.
double Promise::with_rounding(double first, double still, double size) {
  const double touching = tolerances::promise_touching * size;
  double least = infinity;  // slack of those that carry no force
  double steepest = 1;      // what a miss of the row N / mu is in one of N, whose share is taken
  bool changed = false;
  Index held = 0;
  for (Index k = 0; k < program_->cones(); ++k) {
    Mode& mode = modes_->mode[at(k)];
    if (mode == Mode::open) least = std::min(least, opened(k));
    if (mode == Mode::slide && second_order_cone::tangential(&s_[3 * k]) <= touching)
      mode = Mode::stick, changed = true;
    held += mode == Mode::open ? 0 : mode == Mode::slide ? 1 : program_->source(3 * k + 2) < 0 ? 2 : 3;
    if (mode != Mode::open) steepest = std::max(steepest, program_->tilt(k));
  }
  for (Index r = 0; r < program_->rays(); ++r) {
    if (!modes_->active[at(r)]) least = std::min(least, s_[3 * program_->cones() + r]);
    held += modes_->active[at(r)];
  }
  if (changed) modes_->forget_factor();
  const bool may_hold = least > touching && held <= v_.size();
  if (may_hold && changed && !factorize()) return infinity;
  const double share = may_hold ? modes_->least_share(*program_) : 0;
  constexpr double part = 1.0 * tolerances::violation / tolerances::rank;
  if (!(share > 0)) return inside(still, size);
  return first + steepest * (modes_->missed(*program_, s_) + part * row_rounding_ * size) / share;
}

// The bound at a point that meets all rows whatever rounding hides: v moved along w, which opens those near v. No force
// of the answer needs to be known for that, and rows may repeat each other. Infinite where no motion opens them; beside
// equality rows none is looked for.
double Promise::inside(double still, double size) {
  ConeFace& face = program_->face();
  const Index nc = program_->cones();
  const double near = tolerances::promise_near * size;
  x_.setZero(program_->rows());  // what is to be opened, by how much
  for (Index k = 0; k < nc; ++k) {
    if (modes_->mode[at(k)] == Mode::open && opened(k) > near) continue;
    if (modes_->mode[at(k)] != Mode::stick) modes_->forget_factor();
    modes_->mode[at(k)] = Mode::stick;
    x_[3 * k] = 1;
  }
  for (Index r = 0; r < program_->rays(); ++r) {
    if (program_->is_equality(r)) return infinity;
    if (!modes_->active[at(r)] && s_[3 * nc + r] > near) continue;
    if (!modes_->active[at(r)]) modes_->forget_factor();
    modes_->active[at(r)] = 1;
    x_[3 * nc + r] = 1;
  }
  w_.setZero(v_.size());
  t_.setZero(y_.size());
  const auto swap = [&] { v_.swap(w_), y_.swap(t_), h_.swap(x_); };
  swap();
  s_ = -h_;
  bool found = modes_->has_factor(*program_) || factorize();
  // Near its aim is enough. (A look that decides an answer keeps to what it was, for the same bits.)
  const bool is_asked = takes_any_ || options_->prover;
  if (found && is_asked) linearize(false), modes_->step(*program_, v_, y_);
  found = found && (is_asked || settle() < infinity);
  swap();
  if (!found) return infinity;
  program_->slack(v_, s_);
  face.slack(w_, ds_);
  return along(still, size);
}

// The same along w, by which slacks move as ds_.
double Promise::along(double still, double size) {
  const Index nc = program_->cones();
  const double rest = row_rounding_ * size;
  near_.clear();
  near_.reserve(at(nc + program_->rays() + 1));
  for (Index k = 0; k < nc; ++k) near_.push_back({k, rest - opened(k), 0, 0, second_order_cone::smallest(&ds_[3 * k])});
  for (Index i = 3 * nc; i < s_.size(); ++i)
    near_.push_back({i, program_->is_equality(i - 3 * nc) ? infinity : rest - s_[i], 0, 0, ds_[i]});
  near_.push_back({-1, -infinity, gap_ + rest * y_.lpNorm<1>(), 1, std::max(0.0, y_.dot(ds_))});  // the work of all
  return still + factor_rounding_ * size + bound_inside(near_, program_->length(w_), 2 * half_);
}

// The terms of the bound above, y_ being cut to the cones. False where a row without force is violated.
bool Promise::distance() {
  ConeFace& face = program_->face();
  const Index nc = program_->cones();
  const double size = rounding * std::max(program_->scale(v_), reach_);
  gap_ = 0;
  const auto counts = [&](double slack) { return slack > size ? slack : 0; };
  for (Index k = 0; k < nc; ++k) {
    const double *s = &s_[3 * k], slip = second_order_cone::tangential(s);
    auto y = y_.segment<3>(3 * k);
    const double open = opened(k);
    if (modes_->mode[at(k)] == Mode::open && -open > size) return false;
    if (modes_->mode[at(k)] == Mode::slide && slip > size) {
      const double push = std::max(0.0, y[0]);
      y = Vec3(push, -push * s[1] / slip, -push * s[2] / slip);
      gap_ += push * (counts(open) + 2 * counts(-open));
    } else {
      y = second_order_cone::projected(y);
    }
  }
  for (Index i = 3 * nc; i < program_->rows(); ++i) {
    if (program_->is_equality(i - 3 * nc)) continue;
    if (!modes_->active[at(i - 3 * nc)] && -s_[i] > size) return false;
    y_[i] = std::max(0.0, y_[i]);
  }
  face.force(y_, force_);
  face.mass(v_, dv_);
  force_ -= dv_;
  dv_ = force_;
  program_->divide_by_mass(dv_);
  half_ = std::sqrt(std::max(0.0, force_.dot(dv_))) / 2;
  return std::isfinite(half_ + gap_);
}

Prover& prover_in(Session<Promise>& kept) {
  kept.open().forget();
  return *kept;
}

void Promise::end(const Problem& problem, const SolveOptions& options, Solution& solution) {
  double& bound = solution.error_bound;
  if (std::isnan(bound)) judge(problem, options, solution);
  if (!std::isfinite(bound)) bound = options.prover ? infinity : Solution::unknown;
  bound += rounding_of(problem, solution.z);
}

}  // namespace zwang
