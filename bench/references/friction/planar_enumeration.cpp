#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <map>
#include <utility>

#include <zwang/bench/references/friction/planar_enumeration.h>

namespace zwang {
namespace {

using Rational = boost::multiprecision::mpq_rational;
using Row = std::vector<Rational>;

constexpr std::size_t most_contacts = 6;
constexpr std::size_t most_parameters = 4;  // of a singular choice: elimination grows with a power of it

struct Affine {  // constant + coefficients . free parameters
  Rational constant = 0;
  Row linear;
};

// What a.t + b >= 0 says of the other parameters than t_k: Fourier and Motzkin's elimination.
std::vector<Affine> eliminated(std::vector<Affine> rows, std::size_t k) {
  std::vector<Affine> next, up, down;
  for (Affine& row : rows) (row.linear[k] == 0 ? next : row.linear[k] > 0 ? up : down).push_back(std::move(row));
  for (const Affine& a : up)
    for (const Affine& b : down) {
      Affine sum{a.constant / a.linear[k] - b.constant / b.linear[k], Row(a.linear.size(), 0)};
      for (std::size_t j = 0; j < sum.linear.size(); ++j)
        sum.linear[j] = a.linear[j] / a.linear[k] - b.linear[j] / b.linear[k];
      next.push_back(std::move(sum));
    }
  return next;
}

bool has_point(std::vector<Affine> rows, std::size_t parameters) {
  for (std::size_t k = 0; k < parameters; ++k) rows = eliminated(std::move(rows), k);
  for (const Affine& row : rows)
    if (row.constant < 0) return false;
  return true;
}

// The least and the greatest value of a linear form on a set that has a point; false where it is unbounded.
bool range(const std::vector<Affine>& rows, const Affine& form, std::size_t parameters, Rational& low, Rational& high) {
  // One more parameter v = form, which elimination leaves.
  std::vector<Affine> all;
  for (Affine row : rows) {
    row.linear.push_back(0);
    all.push_back(std::move(row));
  }
  for (const int sign : {1, -1}) {
    Affine equal{0, Row(parameters + 1, 0)};
    for (std::size_t j = 0; j < parameters; ++j) equal.linear[j] = sign * form.linear[j];
    equal.linear[parameters] = -sign;
    all.push_back(std::move(equal));
  }
  for (std::size_t k = 0; k < parameters; ++k) all = eliminated(std::move(all), k);
  bool below = false, above = false;
  for (const Affine& row : all) {
    const Rational& slope = row.linear[parameters];
    if (slope == 0) continue;
    const Rational edge = -row.constant / slope;
    if (slope > 0 && (!below || edge > low)) low = edge, below = true;
    if (slope < 0 && (!above || edge < high)) high = edge, above = true;
  }
  return below && above;
}

// All solutions of A x = b as x = x_0 + N t; empty where there is none.
std::optional<std::vector<Affine>> general_solution(std::vector<Row> A, Row b, std::size_t columns) {
  std::vector<std::size_t> pivot_of;
  std::size_t rank = 0;
  for (std::size_t j = 0; j < columns && rank < A.size(); ++j) {
    std::size_t i = rank;
    while (i < A.size() && A[i][j] == 0) ++i;
    if (i == A.size()) continue;
    std::swap(A[i], A[rank]);
    std::swap(b[i], b[rank]);
    const Rational pivot = A[rank][j];
    for (std::size_t k = j; k < columns; ++k) A[rank][k] /= pivot;
    b[rank] /= pivot;
    for (std::size_t r = 0; r < A.size(); ++r) {
      if (r == rank || A[r][j] == 0) continue;
      const Rational factor = A[r][j];
      for (std::size_t k = j; k < columns; ++k) A[r][k] -= factor * A[rank][k];
      b[r] -= factor * b[rank];
    }
    pivot_of.push_back(j);
    ++rank;
  }
  for (std::size_t i = rank; i < A.size(); ++i)
    if (b[i] != 0) return {};
  std::vector<std::size_t> free;
  for (std::size_t j = 0, k = 0; j < columns; ++j)
    if (k < pivot_of.size() && pivot_of[k] == j)
      ++k;
    else
      free.push_back(j);
  std::vector<Affine> x(columns, Affine{0, Row(free.size(), 0)});
  for (std::size_t f = 0; f < free.size(); ++f) x[free[f]].linear[f] = 1;
  for (std::size_t k = 0; k < pivot_of.size(); ++k) {
    x[pivot_of[k]].constant = b[k];
    for (std::size_t f = 0; f < free.size(); ++f) x[pivot_of[k]].linear[f] = -A[k][free[f]];
  }
  return x;
}

struct Data {
  std::vector<Row> J, inverse_J;  // m x n; M^-1 J', m x n
  Row z_u, c, q;                  // q = J z_u - c
  std::vector<Row> W;
};

Affine combine(const Row& factors, const std::vector<Affine>& x, const Rational& constant, std::size_t parameters) {
  Affine sum{constant, Row(parameters, 0)};
  for (std::size_t k = 0; k < factors.size(); ++k) {
    if (factors[k] == 0) continue;
    sum.constant += factors[k] * x[k].constant;
    for (std::size_t j = 0; j < parameters; ++j) sum.linear[j] += factors[k] * x[k].linear[j];
  }
  return sum;
}

std::optional<Data> exact_data(const Problem& p) {
  const auto n = static_cast<std::size_t>(p.size()), m = static_cast<std::size_t>(p.rows());
  Data data;
  std::vector<Row> M(n, Row(n, 0));
  for (Index j = 0; j < p.size(); ++j)
    for (Eigen::SparseMatrix<double>::InnerIterator it(p.M, j); it; ++it)
      M[static_cast<std::size_t>(it.row())][static_cast<std::size_t>(j)] = it.value();
  data.J.assign(m, Row(n, 0));
  for (Index i = 0; i < p.rows(); ++i)
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(p.J, i); it; ++it)
      data.J[static_cast<std::size_t>(i)][static_cast<std::size_t>(it.col())] = it.value();
  for (Index j = 0; j < p.size(); ++j) data.z_u.emplace_back(p.z_u[j]);
  for (std::size_t i = 0; i < m; ++i) {
    const auto column = general_solution(M, data.J[i], n);
    if (!column) return {};
    Row values;
    for (const Affine& value : *column) {
      if (!value.linear.empty()) return {};
      values.push_back(value.constant);
    }
    data.inverse_J.push_back(std::move(values));
    const double c = p.c[static_cast<Index>(i)];
    data.q.emplace_back(std::isfinite(c) ? -Rational(c) : Rational(0));  // a contact that says nothing is not asked
    for (std::size_t j = 0; j < n; ++j) data.q[i] += data.J[i][j] * data.z_u[j];
  }
  data.W.assign(m, Row(m, 0));
  for (std::size_t i = 0; i < m; ++i)
    for (std::size_t k = 0; k < m; ++k)
      for (std::size_t j = 0; j < n; ++j) data.W[i][k] += data.J[i][j] * data.inverse_J[k][j];
  return data;
}

}  // namespace

std::optional<PlanarSolutions> enumerate_planar(const Problem& p) {
  struct Planar {
    std::size_t row;
    bool slips;
    Rational mu;
  };
  std::vector<Planar> contacts;
  std::vector<std::size_t> equalities;
  for (Index i = 0; i < p.rows(); ++i) {
    if (p.is_equality(i)) {
      equalities.push_back(static_cast<std::size_t>(i));
      continue;
    }
    const Index tangents = p.has_tangents() ? p.tangents(i) : 0;
    if (tangents > 1 && p.mu[i] > 0) return {};
    const bool slips = tangents == 1 && p.mu[i] > 0;
    if (std::isfinite(p.c[i])) contacts.push_back({static_cast<std::size_t>(i), slips, slips ? p.mu[i] : 0});
    i += tangents;
  }
  if (contacts.size() > most_contacts) return {};
  const std::optional<Data> data = exact_data(p);
  if (!data) return {};

  // A closed contact contributes one or two unknowns, each a column of multipliers (row, factor).
  enum Choice { open, stick, forward, backward };
  PlanarSolutions out;
  std::map<Row, bool> seen;
  std::vector<int> choice(contacts.size(), open);
  for (;;) {
    std::vector<std::vector<std::pair<std::size_t, Rational>>> unknown;
    std::vector<std::size_t> zero_rows;
    for (const std::size_t i : equalities) {
      unknown.push_back({{i, 1}});
      zero_rows.push_back(i);
    }
    for (std::size_t k = 0; k < contacts.size(); ++k) {
      const Planar& contact = contacts[k];
      if (choice[k] == open) continue;
      zero_rows.push_back(contact.row);
      if (choice[k] == stick) {
        unknown.push_back({{contact.row, 1}});
        if (!contact.slips) continue;
        unknown.push_back({{contact.row + 1, 1}});
        zero_rows.push_back(contact.row + 1);
      } else {
        const Rational friction = choice[k] == forward ? Rational(-contact.mu) : contact.mu;
        unknown.push_back({{contact.row, 1}, {contact.row + 1, friction}});
      }
    }
    std::vector<Row> A(zero_rows.size(), Row(unknown.size(), 0));
    Row b;
    for (std::size_t r = 0; r < zero_rows.size(); ++r) {
      for (std::size_t k = 0; k < unknown.size(); ++k)
        for (const auto& [row, factor] : unknown[k]) A[r][k] += data->W[zero_rows[r]][row] * factor;
      b.push_back(-data->q[zero_rows[r]]);
    }
    if (const auto x = general_solution(std::move(A), std::move(b), unknown.size())) {
      const std::size_t parameters = x->empty() ? 0 : (*x)[0].linear.size();
      if (parameters > most_parameters) return {};
      std::vector<Affine> lambda(data->q.size(), Affine{0, Row(parameters, 0)});
      for (std::size_t k = 0; k < unknown.size(); ++k)
        for (const auto& [row, factor] : unknown[k]) {
          lambda[row].constant += factor * (*x)[k].constant;
          for (std::size_t j = 0; j < parameters; ++j) lambda[row].linear[j] += factor * (*x)[k].linear[j];
        }
      const auto slack = [&](std::size_t i) { return combine(data->W[i], lambda, data->q[i], parameters); };
      const auto plus = [&](const Affine& a, const Rational& factor, const Affine& d) {
        return combine({1, factor}, {a, d}, 0, parameters);
      };
      std::vector<Affine> wanted;  // >= 0
      for (std::size_t k = 0; k < contacts.size(); ++k) {
        const Planar& contact = contacts[k];
        if (choice[k] == open) {
          wanted.push_back(slack(contact.row));
          continue;
        }
        wanted.push_back(lambda[contact.row]);
        if (!contact.slips) continue;
        if (choice[k] == stick) {
          const Affine most = combine({contact.mu}, {lambda[contact.row]}, 0, parameters);
          wanted.push_back(plus(most, 1, lambda[contact.row + 1]));
          wanted.push_back(plus(most, -1, lambda[contact.row + 1]));
        } else {
          wanted.push_back(combine({choice[k] == forward ? 1 : -1}, {slack(contact.row + 1)}, 0, parameters));
        }
      }
      if (has_point(wanted, parameters)) {
        std::vector<Affine> z;
        bool varies = false;
        for (std::size_t j = 0; j < data->z_u.size(); ++j) {
          Row column;
          for (const Row& row : data->inverse_J) column.push_back(row[j]);
          z.push_back(combine(column, lambda, data->z_u[j], parameters));
          for (const Rational& part : z.back().linear) varies |= part != 0;
        }
        Row point;
        for (const Affine& value : z) {
          if (!varies) {
            point.push_back(value.constant);
            continue;
          }
          // One z, or many: is there room on both sides of some value?
          Affine part = value;
          part.constant = 0;
          Rational bottom = 0, top = 0;
          if (!range(wanted, part, parameters, bottom, top) || bottom != top) {
            out.continuum = true;
            break;
          }
          point.push_back(value.constant + bottom);
        }
        if (point.size() == z.size() && seen.emplace(point, true).second) {
          Vector rounded(static_cast<Index>(point.size()));
          for (std::size_t j = 0; j < point.size(); ++j) rounded[static_cast<Index>(j)] = point[j].convert_to<double>();
          out.z.push_back(std::move(rounded));
        }
      }
    }
    std::size_t k = 0;
    for (; k < contacts.size(); ++k) {
      const int last = contacts[k].slips ? backward : stick;
      if (choice[k]++ < last) break;
      choice[k] = open;
    }
    if (k == contacts.size()) return out;
  }
}

}  // namespace zwang
