#include <zwang/bench/fuzz/frictional_problem.h>

#include <array>

#include <zwang/bench/fuzz/small_problem.h>
#include <zwang/bench/scenes/dyadic.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {
namespace {

constexpr std::array coefficients{0., .125, .25, .5, .75, 1., 2.};

struct DrawnContact {
  std::vector<DrawnRow> rows = {};  // normal, tangents
  double mu = 0;
};

void set_contacts(Problem& p, const std::vector<DrawnRow>& equalities, const std::vector<DrawnContact>& contacts) {
  RowWriter out;
  for (const DrawnRow& row : equalities) {
    out.add(RowKind::equality, {static_cast<std::uint64_t>(out.rows()) + 1, 0}, row.c);
    out.entries(row.J);
  }
  for (std::size_t k = 0; k < contacts.size(); ++k)
    for (std::uint32_t t = 0; const DrawnRow& row : contacts[k].rows) {
      out.add(t == 0 ? RowKind::inequality : RowKind::tangent, {k + 100, t}, row.c, t == 0 ? contacts[k].mu : 0);
      out.entries(row.J);
      ++t;
    }
  out.write(p);
  p.law = stored_law;
}

Vector masses(Index n, int spread, Draw& draw) {
  Vector D(n);
  for (double& d : D) d = std::exp2(draw.integer(-spread, spread));
  return D;
}

DrawnContact any_contact(Index n, int tangents, const std::vector<DrawnContact>& before, Draw& draw) {
  if (!before.empty() && draw.integer(0, 3) == 0) {
    DrawnContact copy = before[at(draw.index(std::ssize(before)))];
    const bool opposed = draw.integer(0, 2) == 0;
    if (opposed) copy.rows[0] = {-copy.rows[0].J, -copy.rows[0].c - draw.integer(0, 2)};
    if (!opposed && draw.integer(0, 1) == 0) copy.rows[0].c -= draw.integer(0, 1);
    return copy;
  }
  DrawnContact out{.mu = coefficients[at(draw.integer(0, 6))]};
  for (int t = 0; t <= tangents; ++t) {
    const bool empty = draw.integer(0, 29) == 0;
    out.rows.push_back({empty ? Vector(Vector::Zero(n)) : draw.integers(n, 1),
                        t == 0                    ? static_cast<double>(draw.integer(-1, 1)) / 2
                        : draw.integer(0, 3) == 0 ? static_cast<double>(draw.integer(-1, 1))
                                                  : 0.});
  }
  return out;
}

void small_integers(Problem& p, int tangents, Draw& draw) {
  const Index n = draw.integer(2, 6);
  const int contacts = draw.integer(1, 4), equalities = draw.integer(0, 3) == 0 ? 1 : 0;
  const Vector D = masses(n, 1, draw);
  p.M = (draw.integer(0, 2) == 0 ? coupled_mass(D, 1, draw) : Matrix(D.asDiagonal())).sparseView();
  p.z_u = draw.integers(n, 2);
  std::vector<DrawnRow> equal;
  for (int k = 0; k < equalities; ++k) equal.push_back({draw.integers(n, 1), 0});
  std::vector<DrawnContact> all;
  for (int k = 0; k < contacts; ++k) all.push_back(any_contact(n, tangents, all, draw));
  set_contacts(p, equal, all);
}

// z* and lambda* first, mode by mode; then c = J z* - s* and, M being diagonal in powers of two, z_u without rounding.
Reference planted(Problem& p, Draw& draw, int bodies, Law law = stored_law, int mu_bits = 0) {
  const Index n = 3 * draw.integer(1, bodies);
  const int contacts = draw.integer(1, static_cast<int>(n)), spread = draw.integer(0, 2) == 0 ? 12 : 2;
  const double lift = 1 - lift_of(law);
  p.M = Matrix(masses(n, spread, draw).asDiagonal()).sparseView();
  const Vector z = draw.integers(n, 16) / 16;
  std::vector<DrawnContact> all;
  Vector push = Vector::Zero(n);
  std::vector<double> lambda;
  for (int k = 0; k < contacts; ++k) {
    DrawnContact contact{.mu = std::ldexp(coefficients[at(draw.integer(1, 6))], -mu_bits)};
    const bool copied = k > 0 && draw.integer(0, 4) == 0;
    for (int t = 0; t <= 2; ++t) contact.rows.push_back({copied ? all.back().rows[at(t)].J : draw.integers(n, 2), 0});
    if (copied) contact.mu = all.back().mu;
    std::array<double, 3> s{}, l{};
    const double size = std::exp2(draw.integer(-3, 1)), slip = std::exp2(draw.integer(-3, 1));
    switch (draw.integer(0, 6)) {
      case 0:  // open
        s = {size + lift * 2 * contact.mu, draw.integer(-3, 3) / 4., draw.integer(-3, 3) / 4.};
        break;
      case 1:  // rests without force, slides or not
        s = {lift * 4 * contact.mu * slip, draw.integer(0, 1) * slip * 3, slip * draw.integer(0, 1)};
        break;
      case 2:  // on the cone's edge without slip
        l = {5 * size, 3 * contact.mu * size, -4 * contact.mu * size};
        break;
      case 3:
      case 4:  // slides
        s = {lift * 5 * contact.mu * slip, 3 * slip, 4 * slip};
        l = {5 * size, -3 * contact.mu * size, -4 * contact.mu * size};
        break;
      default:  // sticks
        l = {5 * size, contact.mu * size * draw.integer(-2, 2), contact.mu * size * draw.integer(-2, 2)};
    }
    for (std::size_t t = 0; t < 3; ++t) {
      contact.rows[t].c = contact.rows[t].J.dot(z) - s[t];
      push += l[t] * contact.rows[t].J;
      lambda.push_back(l[t]);
    }
    all.push_back(std::move(contact));
  }
  p.z_u = z - push.cwiseQuotient(Vector(p.M.diagonal()));
  set_contacts(p, {}, all);
  p.law = law;
  return {.z = z, .lambda = Eigen::Map<const Vector>(lambda.data(), std::ssize(lambda)), .method = "planted"};
}

}  // namespace

Problem frictional_problem(std::uint64_t seed, std::uint64_t number) {
  Draw draw(static_cast<double>(mix_bits(seed ^ 0x5f3759df, number) >> 12));
  Problem p{.name = "friction " + std::to_string(seed) + " " + std::to_string(number)};
  const auto kind = number % 10;
  if (kind < 4)
    small_integers(p, 1, draw);
  else if (kind < 7)
    small_integers(p, 2, draw);
  else
    planted(p, draw, 6);
  return p;
}

Instance planted_problem(std::uint64_t seed, std::uint64_t number, Law law) {
  Draw draw(static_cast<double>(mix_bits(seed ^ 0x2545f491, number) >> 12));
  Instance out{.problem = {.name = "planted " + std::to_string(seed) + " " + std::to_string(number)}};
  const int mu_bits = draw.integer(0, 6);
  out.reference = planted(out.problem, draw, 2, law, mu_bits);
  return out;
}

}  // namespace zwang
