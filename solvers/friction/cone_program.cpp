#include <zwang/solvers/friction/cone_program.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace zwang {
namespace {

constexpr Index most_dense = 1000;  // dense where the rows are full, or where that is asked for
constexpr Index few_bodies = 24;    // unknowns: dense rows are as quick for a factor or two

bool rows_are_full(const Problem& p) { return 4 * p.J.nonZeros() > p.rows() * p.size(); }

bool has_equalities(const Problem& p) { return std::ranges::find(p.kind, RowKind::equality) != p.kind.end(); }

}  // namespace

// A contact of a body that cannot move: s = -c is data. False where it contradicts the law, which is then written.
bool ConeProgram::meets_immobile(const Problem& p, Index row, double mu, Solution& solution) const {
  double slip = 0;
  for (Index t = 1; t <= p.tangents(row); ++t) slip = std::hypot(slip, p.c[row + t]);
  if (!(-p.c[row] < mu * (law_.opening() * slip))) return true;  // c_n <= 0: else the row is a conflict
  Vector& u = solution.zero_certificate(p.rows());
  u[row] = 1;
  for (Index t = 1; t <= p.tangents(row); ++t) u[row + t] = mu * p.c[row + t] / slip;
  solution.empty_answer();
  solution.status = Status::infeasible;
  solution.message.append("contact of row ").append(std::to_string(row)).append(" is zero and cannot hold");
  return false;
}

template <class Rows>
bool ConeProgram::collect(const Problem& p, const Rows& rows, Solution& solution) {
  unit_of_.assign(at(p.rows()), -1);
  for (Index k = 0; k < rows.rows(); ++k) unit_of_[at(rows.row[at(k)])] = k;
  row_.clear();
  mu_.clear();
  equality_.clear();
  const auto slips = [&](Index i) { return has_cones_ && !p.is_equality(i) && p.tangents(i) > 0 && p.mu[i] > 0; };
  const auto violation = [&](Index k) {
    return form_ == Form::joints ? rows.h[k] - joints_.rows().dot(k, joints_.y_E()) : rows.h[k];
  };
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_tangent(i) || !slips(i) || !std::isfinite(p.c[i])) continue;
    double longest = 0, trace = 0;
    for (Index q = 0; q <= p.tangents(i); ++q)
      if (const Index k = unit_of_[at(i + q)]; k >= 0) longest = std::max(longest, rows.row_norm[k]);
    if (!(longest > 0)) {
      if (!meets_immobile(p, i, p.mu[i], solution)) return false;
      continue;
    }
    // Squares of rows of 1e200 do not fit a double.
    const int size = std::ilogb(longest);
    const auto norm = [&](Index k) { return std::ldexp(rows.row_norm[k], -size); };
    for (Index q = 0; q <= p.tangents(i); ++q)
      if (const Index k = unit_of_[at(i + q)]; k >= 0) trace += norm(k) * norm(k);
    const double unit = std::sqrt(3 / trace);
    mu_.push_back(p.mu[i]);
    for (Index q = 0; q < 3; ++q) {
      const double own = q == 0 ? unit / p.mu[i] : unit;
      if (q > p.tangents(i))
        row_.push_back({-1, -1, 0, 1, 0});
      else if (const Index k = unit_of_[at(i + q)]; k >= 0)
        row_.push_back({i + q, k, own * norm(k), rows.row_norm[k], own * norm(k) * violation(k)});
      else
        row_.push_back({i + q, -1, std::ldexp(own, -size), 1, std::ldexp(own * p.c[i + q], -rows.exponent - size)});
    }
  }
  for (Index i = 0; i < p.rows(); ++i) {
    const Index k = unit_of_[at(i)];
    if (p.is_tangent(i) || k < 0 || !std::isfinite(p.c[i]) || slips(i)) continue;
    if (p.is_equality(i) && form_ == Form::joints) continue;
    equality_.push_back(p.is_equality(i));
    row_.push_back({i, k, 1, rows.row_norm[k], violation(k)});
  }
  exponent_ = rows.exponent;
  free_norm_ = rows.free_norm;
  return true;
}

void ConeProgram::state(ConeLaw law, const Vector* slips) {
  ++factors_;
  law_ = law;
  h_.resize(rows());
  for (Index r = 0; r < rows(); ++r) h_[r] = row_[at(r)].h;
  if (slips)
    for (Index k = 0; k < cones(); ++k) h_[3 * k] -= (*slips)[k];
  start_ = 0;
  const double opening = law_.opening();
  for (Index k = 0; k < cones(); ++k) {
    const double slip = opening > 0 ? opening * std::hypot(h_[3 * k + 1], h_[3 * k + 2]) : 0;
    start_ = std::max(start_, mu(k) * (h_[3 * k] + slip));
  }
  for (Index r = 0; r < rays(); ++r) {
    const double own = h_[3 * cones() + r];
    start_ = std::max(start_, is_equality(r) ? std::abs(own) : own);
  }
  if (!(start_ > 0)) start_ = std::max(free_norm_, std::numeric_limits<double>::min());
}

void ConeProgram::fill_dense() {
  const Index n = form_ == Form::joints ? joints_.freedom() : whitened_.size();
  dense_face_.reset(n, cones(), rays());
  for (Index r = 0; r < rows(); ++r) {
    const Row& own = row_[at(r)];
    if (own.unit < 0) continue;
    Eigen::Map<Vector> out(dense_face_.row(r), dense_face_.padded());
    if (form_ == Form::joints) {
      joints_.reduce_row(own.unit, out.data());
      out *= own.factor;
    } else {
      whitened_.add(own.unit, own.factor, out);
    }
  }
  dense_face_.rows_are_set();
}

void ConeProgram::fill_sparse(const Problem& p, const SolveOptions& options, const Deadline& deadline) {
  sparse_rows_.begin.assign(1, 0);
  sparse_rows_.column.clear();
  sparse_rows_.value.clear();
  const SparseRows& g = unit_rows_.g;
  // A cone's rows have one pattern, a single row its own.
  for (std::size_t first = 0, count = 3; first < row_.size(); first += count) {
    if (first == at(3 * cones())) count = 1;
    const std::span together(&row_[first], count);
    pattern_.clear();
    for (const Row& row : together)
      if (row.unit >= 0)
        pattern_.insert(pattern_.end(), g.column.begin() + g.begin[at(row.unit)],
                        g.column.begin() + g.begin[at(row.unit) + 1]);
    std::ranges::sort(pattern_);
    pattern_.erase(std::unique(pattern_.begin(), pattern_.end()), pattern_.end());
    for (const Row& row : together) {
      const std::size_t begin = sparse_rows_.column.size();
      sparse_rows_.column.insert(sparse_rows_.column.end(), pattern_.begin(), pattern_.end());
      sparse_rows_.value.resize(sparse_rows_.column.size(), 0);
      sparse_rows_.begin.push_back(static_cast<int>(sparse_rows_.column.size()));
      if (row.unit < 0) continue;
      for (auto e = at(g.begin[at(row.unit)]); e < at(g.begin[at(row.unit) + 1]); ++e) {
        const auto place = std::ranges::lower_bound(pattern_, g.column[e]) - pattern_.begin();
        sparse_rows_.value[begin + at(place)] = row.factor * g.value[e];
      }
    }
  }
  sparse_face_.reset(p, sparse_rows_, cones(), options, deadline);
}

bool ConeProgram::repeats_equalities() const {
  if (form_ == Form::sparse) return zwang::repeats_equalities(unit_rows_, &unit_rows_.g);
  return form_ == Form::whitened && zwang::repeats_equalities(whitened_);
}

bool ConeProgram::can_be_dense(const Problem& p) { return p.size() <= most_dense; }

bool ConeProgram::build(const Problem& p, Want want, const SolveOptions& options, const Deadline& deadline,
                        Solution& solution, NullSpaceForm* made) {
  has_cones_ = p.has_tangents() && want != Want::normals;
  law_ = has_cones_ ? ConeLaw::of(p.law) : ConeLaw();
  const bool dense = want == Want::dense;
  const auto has_form = [&] {
    if (!made) return false;
    if (joints_.take(p)) return true;
    std::swap(joints_, *made);
    return joints_.take(p);
  };
  const auto make_form = [&] {
    if (!joints_.build(p).empty()) return false;
    if (made) joints_.remember(p);
    return true;
  };
  const bool joints = want != Want::way_back && has_equalities(p) && (has_form() || make_form()) &&
                      joints_.freedom() > 0 && joints_.freedom() <= tolerances::few_unknowns &&
                      joints_.smallest_pivot() >= tolerances::clear_pivot;
  const Index few = want == Want::sparse ? few_bodies : tolerances::few_unknowns;
  const bool full = p.size() <= few || (can_be_dense(p) && (dense || rows_are_full(p)));
  form_ = joints ? Form::joints : full ? Form::whitened : Form::sparse;
  if (form_ == Form::joints) {
    solution.reset(p.size(), p.rows());
    const Preparation preparing;
    if (!collect(p, joints_.rows(), solution)) return false;
    constexpr Index pay_for_N = 48;
    if (rows() >= pay_for_N) joints_.form_basis();
    motion_.setZero(BodyRows::lanes, joints_.rows().bodies());
    rest_.resize(BodyRows::lanes, joints_.rows().bodies());
    mu_E_.resize(std::ssize(joints_.equalities()));
  } else if (form_ == Form::whitened) {
    if (!begin(whitened_, p, options, deadline, solution) || !collect(p, whitened_, solution)) return false;
  } else {
    if (!begin(unit_rows_, p, options, deadline, solution) || !collect(p, unit_rows_, solution)) return false;
  }
  joint_norm_ = joints ? joints_.y_E().norm() : 0;
  const Preparation preparing;
  if (is_dense())
    fill_dense();
  else
    fill_sparse(p, options, deadline);
  work_.setZero(face().unknowns());
  force_.setZero(face().unknowns());
  state(law_);
  return true;
}

bool ConeProgram::restate(const Problem& p, const Deadline& deadline) {
  for (const Index i : form_ == Form::whitened ? whitened_.idle : unit_rows_.idle)
    if (form_ != Form::joints && !p.is_tangent(i) && (p.c[i] > 0 || (p.is_equality(i) && p.c[i] != 0))) return false;
  sparse_face_.end_by(deadline);
  const bool joints = form_ == Form::joints;
  Vector left = p.c;
  free_norm_ = std::sqrt(p.z_u.dot(momentum(p, p.z_u)));
  if (joints) {
    const BodyRows& rows = joints_.rows();
    for (Index k = 0; k < rows.rows(); ++k) left[rows.row[at(k)]] -= rows.dot(k, motion_, rows.J);
    joints_.shift(left);
  } else {
    left -= p.J * p.z_u;
  }
  double size = std::max(free_norm_, joints ? joints_.y_E().lpNorm<Eigen::Infinity>() : 0);
  for (Row& row : row_) {
    if (row.source < 0) continue;
    row.h = row.of_source(left[row.source]);
    if (joints) row.h -= row.factor * joints_.rows().dot(row.unit, joints_.y_E());
    size = std::max(size, std::abs(row.h));
  }
  (void)std::frexp(size, &exponent_);
  whitened_.exponent = exponent_;
  const double unit = std::ldexp(1.0, -exponent_);
  for (Row& row : row_) row.h *= unit;
  free_norm_ *= unit;
  if (joints) joints_.stretch(unit);
  joint_norm_ = joints ? joints_.y_E().norm() : 0;
  state(law_);
  return true;
}

// By bodies, which then are in motion_: M has few entries a column, and columns take their time.
Vector ConeProgram::momentum(const Problem& p, const Vector& z) {
  if (form_ != Form::joints) return p.M * z;
  Vector out(z.size());
  const BodyRows& rows = joints_.rows();
  motion_.topRows<6>() = z.reshaped(6, rows.bodies());
  for (Index b = 0; b < rows.bodies(); ++b)
    out.segment<6>(6 * b) = BodyRows::times(rows.mass[at(b)].M, motion_.col(b)).head<6>();
  return out;
}

double ConeProgram::length(const Vector& v) {
  face().mass(v, work_);
  return std::sqrt(std::max(0.0, work_.dot(v)));
}

double ConeProgram::scale(const Vector& v) { return std::max({free_norm_, length(v), joint_norm_}); }

double ConeProgram::tied() const {
  if (form_ == Form::joints) return joints_.rows().tied() / joints_.smallest_pivot();
  return (form_ == Form::whitened ? whitened_.factor : unit_rows_.factor).tied();
}

double ConeProgram::reach() const { return std::max({free_norm_, start_, joint_norm_}); }

ConeProgram::Residual ConeProgram::residual(const Vector& y, const Vector& s) const {
  Residual out;
  if (y.size() > 0) out.rounding = std::numeric_limits<double>::epsilon() * y.lpNorm<Eigen::Infinity>();
  for (Index k = 0; k < cones(); ++k) {
    const ConeLaw::Residual own = law_.residual(&y[3 * k], &s[3 * k], mu(k));
    out.natural = std::max(out.natural, own.natural);
    out.gap += own.gap;
    // And the normal row as a unit row, where its tangents are much longer or shorter.
    if (const Row& row = row_[at(3 * k)]; row.unit >= 0) {
      const double open = s[3 * k] / row.factor;
      const bool blind = law_.lift == 1 && row.factor * tolerances::cone_far < 1;  // to what pushes and is open
      out.natural = std::max({out.natural, -open, blind ? std::min(open, y[3 * k]) : 0});
    }
  }
  for (Index r = 0; r < rays(); ++r) {
    const double l = y[3 * cones() + r], own = s[3 * cones() + r];
    if (is_equality(r)) {
      out.natural = std::max(out.natural, std::abs(own));
      out.gap += 2 * std::abs(l * own);
    } else {
      out.natural = std::max({out.natural, std::abs(l - std::max(0.0, l - own)), -own});
      out.gap += std::abs(l * own) + 2 * std::max(0.0, l) * std::max(0.0, -own);
    }
  }
  return out;
}

bool ConeProgram::accepts(const Residual& r, const Vector& v, const SolveOptions& options, bool settled) {
  const double size = scale(v);
  if (is_out_of_reach(v)) return false;
  const double accepted = accepted_error(options.tolerance) * size;
  // Rows that almost contradict each other push so hard that what is left of their sum is rounding.
  if (r.rounding > std::max(accepted, tolerances::cone_push * size)) return false;
  const bool bounded = std::sqrt(2 * std::max(0.0, r.gap)) <= accepted;
  // Under the convex law the gap bounds the error. A residual of rows that push hard is blind to slacks that are 1e5
  // times as far from the answer as it says, and that a step no longer moves.
  if (!law_.lifts() && r.rounding > tolerances::cone_blind * size)
    return r.natural <= options.tolerance * size && bounded;
  if (r.natural <= tolerances::cone_exact * size) return true;
  return r.natural <= options.tolerance * size && (settled || bounded);
}

double ConeProgram::imbalance(const Vector& v, const Vector& y) {
  face().mass(v, work_);
  face().force(y, force_);
  const double size = work_.lpNorm<Eigen::Infinity>();
  return size > 0 ? (force_ - work_).lpNorm<Eigen::Infinity>() / size : 1;
}

void ConeProgram::scale_multipliers(const Vector& lambda, Vector& y) const {
  for (Index r = 0; r < rows(); ++r) {
    const Row& row = row_[at(r)];
    y[r] = row.unit >= 0 ? std::ldexp(lambda[row.source] * row.norm / row.factor, -exponent_) : 0;
  }
}

void ConeProgram::read(const Problem& p, const Vector& z, const Vector& lambda, Vector& v, Vector& y) {
  y.setZero(rows());
  scale_multipliers(lambda, y);
  v.setZero(face().unknowns());
  if (form_ == Form::sparse) {
    for (Index j = 0; j < v.size(); ++j) {
      const Index column = sparse_face_.column(j);
      v[j] = std::ldexp(z[column] - p.z_u[column], -exponent_);
    }
  } else {
    short_ = z - p.z_u;
    whitened_.factor.multiply_upper(short_);
    for (Index j = 0; j < short_.size(); ++j) v[j] = std::ldexp(short_[j], -exponent_);
  }
}

Vector ConeProgram::scaled_slack(const Vector& slack) const {
  return Vector::NullaryExpr(rows(), [&](Index r) {
    const Row& row = row_[at(r)];
    return row.source < 0 ? 0 : std::ldexp(row.of_source(slack[row.source]), -exponent_);
  });
}

bool ConeProgram::warm(const Problem& p, const WarmStart* warm, Vector& y) {
  y.setZero(rows());
  if (!warm) return false;
  while (all_rows_.rows() < p.rows()) all_rows_.row.push_back(all_rows_.rows());
  all_rows_.row.resize(at(p.rows()));
  all_rows_.equality.assign(at(p.rows()), 1);  // so that no sign is asked for
  warm_rows_.multipliers(p, all_rows_, warm, lambda_);
  read(lambda_, y);
  return y.squaredNorm() > 0 && y.lpNorm<1>() <= tolerances::warm_start;
}

void ConeProgram::read(const Vector& lambda, Vector& y) const {
  scale_multipliers(lambda, y);
  cut(y);
}

void ConeProgram::cut(Vector& y) const {
  for (Index k = 0; k < cones(); ++k) y.segment<3>(3 * k) = second_order_cone::projected(y.segment<3>(3 * k));
  for (Index r = 0; r < rays(); ++r)
    if (!is_equality(r)) y[3 * cones() + r] = std::max(0.0, y[3 * cones() + r]);
}

void ConeProgram::divide_by_mass(Vector& f) {
  if (form_ != Form::sparse) return;
  short_.setZero(unit_rows_.size());
  for (Index j = 0; j < f.size(); ++j) short_[sparse_face_.column(j)] = f[j];
  move_freely(short_);
  for (Index j = 0; j < f.size(); ++j) f[j] = short_[sparse_face_.column(j)];
}

void ConeProgram::move_freely(Vector& f) {
  if (form_ != Form::joints) {
    const SparseCholesky<double>& L = form_ == Form::whitened ? whitened_.factor : unit_rows_.factor;
    L.solve_lower(f);
    return L.solve_upper(f);
  }
  for (Index b = 0; b < joints_.rows().bodies(); ++b) {
    const BodyRows::Mass& mass = joints_.rows().mass[at(b)];
    BodyRows::Lanes x = BodyRows::Lanes::Zero();
    x.head<6>() = f.segment<6>(6 * b);
    f.segment<6>(6 * b) = BodyRows::times(mass.L_inverse_t, BodyRows::times(mass.L_inverse, x)).head<6>();
  }
}

// Multipliers of the problem's rows from y; with joints, what these carry of y and of the force in rest_.
void ConeProgram::write_multipliers(const Vector& y, int exponent, Vector& lambda) {
  const Whitened::PowerOfTwo unit(exponent);
  for (Index r = 0; r < rows(); ++r)
    if (const Row& row = row_[at(r)]; row.source >= 0) lambda[row.source] = unit * row.of_source(y[r]);
  if (form_ != Form::joints) return;
  const BodyRows& rows = joints_.rows();
  for (Index r = 0; r < y.size(); ++r)
    if (const Row& row = row_[at(r)]; row.unit >= 0) rows.add(row.unit, -y[r] * row.factor, rest_);
  joints_.multipliers(rest_, mu_E_);
  for (std::size_t e = 0; e < joints_.equalities().size(); ++e) {
    const Index k = joints_.equalities()[e];
    lambda[rows.row[at(k)]] = unit * (mu_E_[static_cast<Index>(e)] / rows.row_norm[k]);
  }
}

void ConeProgram::write(const Problem& p, const Vector& v, const Vector& y, Solution& solution) {
  Solution& s = solution;
  if (s.lambda.size() != p.rows()) s.spare.lambda.set_zero(s.lambda, p.rows());
  if (s.z.size() != p.size()) s.spare.z.set_zero(s.z, p.size());
  s.lambda.setZero();
  if (form_ == Form::joints) {
    joints_.expand(v, motion_);
    motion_ += joints_.y_E();
    rest_ = motion_;
  }
  write_multipliers(y, exponent_, s.lambda);
  if (form_ == Form::whitened) {
    short_ = v.head(whitened_.size());
    whitened_.primal(p, short_, s.z);
    return;
  }
  s.z = p.z_u;
  if (form_ == Form::sparse) {
    for (Index j = 0; j < v.size(); ++j) s.z[sparse_face_.column(j)] += std::ldexp(v[j], exponent_);
    unit_rows_.move_faint(s.lambda, s.z);
    return;
  }
  const Whitened::PowerOfTwo unit(exponent_);
  for (Index b = 0; b < joints_.rows().bodies(); ++b) {
    const BodyRows::Lanes step = BodyRows::times(joints_.rows().mass[at(b)].L_inverse_t, motion_.col(b));
    for (Index j = 0; j < 6; ++j) s.z[6 * b + j] += unit * step[j];
  }
}

void ConeProgram::write_certificate(const Problem& p, const Vector& y, Solution& solution) {
  solution.empty_answer();
  rest_.setZero();
  write_multipliers(y, 0, solution.zero_certificate(p.rows()));
  solution.status = Status::infeasible;
}

}  // namespace zwang
