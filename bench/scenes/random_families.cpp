#include <algorithm>
#include <cmath>

#include <zwang/bench/scenes/dyadic.h>
#include <zwang/bench/scenes/families.h>
#include <zwang/bench/scenes/known_answer.h>
#include <zwang/bench/scenes/row_by_row.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {

// Pairs of equality rows a and a + eps d with c = J z0. The multipliers (alpha - beta / eps, beta / eps) push by
// alpha a + beta d for every eps, so z_u = z0 - M^-1 J' lambda has the same integers at each knob, and is exact.
Instance near_parallel_equalities(const Knobs& knobs) {
  constexpr Index n = 12, pairs = 3, contacts = 6;
  const double eps = std::exp2(-knobs.at("k"));
  Draw draw(knobs.at("seed"));
  Vector mass(n);
  for (double& m : mass) m = std::exp2(draw.integer(-1, 1));
  const Vector z0 = draw.integers(n, 4);
  Vector force = Vector::Zero(n), lambda = Vector::Zero(2 * pairs + contacts);
  std::vector<Vector> J;
  for (Index k = 0; k < pairs; ++k) {
    const Vector a = draw.integers(n, 4), d = draw.integers(n, 4);
    const double alpha = draw.integer(-2, 2), beta = draw.integer(1, 4);
    J.push_back(a);
    J.push_back(a + eps * d);
    force += alpha * a + beta * d;
    lambda[2 * k] = alpha - beta / eps;
    lambda[2 * k + 1] = beta / eps;
  }
  for (Index k = 0; k < contacts; ++k) {
    J.push_back(draw.integers(n, 4));
    lambda[2 * pairs + k] = k < 2 ? draw.integer(1, 2) : 0;
    force += lambda[2 * pairs + k] * J.back();
  }
  RowByRow rows(mass, z0 - force.cwiseQuotient(mass));
  for (Index i = 0; i < 2 * pairs + contacts; ++i) {
    const Vector& row = J[at(i)];
    const bool equality = i < 2 * pairs;
    const double slack = equality || lambda[i] > 0 ? 0 : draw.integer(1, 30);
    if (equality)
      rows.add_equality(row, row.dot(z0), numbered("equality/pair ", i / 2) + (i % 2 ? " tilted" : ""));
    else
      rows.add_contact(row, row.dot(z0) - slack, std::to_string(i - 2 * pairs));
  }
  return rows.finish({.z = z0, .lambda = lambda, .method = "closed form"});
}

// Six bodies on ball joints, masses 1 and 2^k in turn, one contact each. The structure is drawn; a known answer is put
// on it.
Instance mass_ratio_chain(const Knobs& knobs) {
  constexpr Index bodies = 6, n = 6 * bodies;
  Draw draw(knobs.at("seed"));
  Vector mass(n);
  for (Index b = 0; b < bodies; ++b) {
    mass.segment<6>(6 * b) << 1, 1, 1, .25, .125, .0625;
    if (b % 2 == 1) mass.segment<6>(6 * b) *= std::exp2(knobs.at("k"));
  }
  RowByRow rows(mass, Vector::Zero(n));
  const auto eighths = [&] { return Vec3(draw.eighths(3, 8)); };
  for (Index b = 0; b < bodies; ++b) {
    const Vec3 before = eighths(), here = eighths();
    rows.add_ball_joint(b, here, before);
  }
  for (Index b = 0; b < bodies; ++b) {
    Vector row = Vector::Zero(n);
    Vec3 normal = eighths();
    normal.z() = 1;
    add_point(row, b, 1, eighths(), normal);
    rows.add_contact(row, 0, std::to_string(b));
  }
  return with_known_answer(rows.finish(), static_cast<std::uint64_t>(knobs.at("seed")), .5);
}

// Twelve contacts, all touching; six push with lambda = 1 and six with eps: strict complementarity fades.
Instance weak_contacts(const Knobs& knobs) {
  constexpr Index n = 24, m = 12;
  const double eps = small(knobs);
  Draw draw(knobs.at("seed"));
  const Vector z0 = draw.integers(n, 4);
  Vector z_u = z0, lambda(m);
  std::vector<Vector> J;
  for (Index i = 0; i < m; ++i) {
    J.push_back(draw.integers(n, 3));
    lambda[i] = i < m / 2 ? 1 : eps;
    z_u -= lambda[i] * J.back();
  }
  RowByRow rows(Vector::Ones(n), z_u);
  for (Index i = 0; i < m; ++i) {
    const Vector& row = J[at(i)];
    rows.add_contact(row, row.dot(z0), numbered(i < m / 2 ? "strong " : "weak ", i % (m / 2)));
  }
  return rows.finish({.z = z0, .lambda = lambda, .method = "closed form"});
}

// Sparse rows of small integers over pairs of coupled unknowns with masses from 2^(-condition/2) to 2^(condition/2).
// A redundant row is the sum of two rows of its kind.
Instance random_rows(const Knobs& knobs) {
  const auto n = static_cast<Index>(knobs.at("n")), m = static_cast<Index>(knobs.at("m"));
  const Index entries = std::min(n, static_cast<Index>(knobs.at("entries")));
  const auto equalities = static_cast<Index>(std::lround(knobs.at("equalities") * static_cast<double>(m)));
  const int half = static_cast<int>(knobs.at("condition")) / 2;
  Draw draw(knobs.at("seed"));
  Instance instance;
  Problem& p = instance.problem;

  // M = L D L' with L unit lower triangular, one integer below the diagonal of every other column.
  std::vector<Eigen::Triplet<double>> mass;
  const auto diagonal = [&](Index j) { return std::exp2(j == 0 ? half : j == 1 ? -half : draw.integer(-half, half)); };
  for (Index j = 0; j < n; j += 2) {
    const int a = static_cast<int>(j), b = a + 1;
    const double d = diagonal(j);
    const int drawn = draw.integer(-1, 1);
    mass.emplace_back(a, a, d);
    if (j + 1 == n) break;
    const double light = diagonal(j + 1);
    const int l = light >= 0x1p-48 * d ? drawn : 0;  // else M is not positive definite once it is rounded
    mass.emplace_back(b, b, light + l * l * d);
    if (l == 0) continue;
    mass.emplace_back(b, a, l * d);
    mass.emplace_back(a, b, l * d);
  }
  p.M = sparse_of<SparseMatrix>(n, n, mass);
  p.z_u = Vector::Zero(n);

  RowWriter J;
  std::vector<std::vector<std::pair<int, double>>> rows;
  for (Index i = 0; i < m; ++i) {
    const bool equality = i < equalities;
    const Index first = equality ? 0 : equalities, before = i - first;
    const bool redundant = before >= 2 && draw.integer(1, 1000) <= static_cast<int>(1000 * knobs.at("redundancy"));
    std::vector<std::pair<int, double>> row;
    if (redundant) {
      const Index a = first + draw.index(before), b = first + draw.index(before);
      row = rows[at(a)];
      const auto& other = rows[at(b)];
      row.insert(row.end(), other.begin(), other.end());
    } else {
      for (Index k = 0; k < entries; ++k) {
        const int column = static_cast<int>(draw.index(n)), size = draw.integer(1, 4), sign = draw.integer(0, 1);
        row.emplace_back(column, sign == 1 ? size : -size);
      }
    }
    J.add(equality ? RowKind::equality : RowKind::inequality, {static_cast<std::uint64_t>(i) + 1, 0}, 0);
    for (const auto& [column, value] : row) J.entry(column, value);
    rows.push_back(std::move(row));
    instance.origin.push_back({.type = equality ? "equality" : "contact",
                               .label = std::to_string(i - first) + (redundant ? " (a sum)" : ""),
                               .unit = equality ? "" : "m/s^2"});
  }
  J.write(p);
  return with_known_answer(std::move(instance), static_cast<std::uint64_t>(knobs.at("seed")), knobs.at("active"));
}

}  // namespace zwang
