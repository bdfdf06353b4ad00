#include <zwang/bench/scenes/friction/friction.h>

#include <zwang/constraints/contact.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {
namespace {

// Where the rows of the problem without tangent rows stand in the one with them.
Vector spread(const Vector& v, const std::vector<Index>& place, Index rows) {
  if (v.size() == 0) return {};
  Vector out = Vector::Zero(rows);
  for (std::size_t i = 0; i < place.size(); ++i) out[place[i]] = v[static_cast<Index>(i)];
  return out;
}

// A reference stays where it is a solution still: frictionless forces, and nothing slips. Under Coulomb's law there may
// be others.
void keep_reference(const Instance& from, const std::vector<Index>& place, Instance& to) {
  if (!from.reference) return;
  Reference known = *from.reference;
  if (known.feasible) {
    const Vector motion = to.problem.J * known.z;
    for (Index i = 0; i < to.problem.rows(); ++i)
      if (to.problem.is_tangent(i) && motion[i] != 0) return;
  }
  known.lambda = spread(known.lambda, place, to.problem.rows());
  known.certificate = spread(known.certificate, place, to.problem.rows());
  known.unique = false;
  to.reference = std::move(known);
}

}  // namespace

void rub(Scene& scene, double mu) {
  if (mu == 0) return;
  for (Contact& contact : scene.list_of<Contact>().all) contact.friction = mu;
}

Instance with_friction(const Instance& frictionless, double mu, const std::vector<SlipRow>& slips) {
  Instance out = frictionless;
  if (slips.empty()) return out;
  const Problem& old = frictionless.problem;
  Problem& p = out.problem;
  out.origin.clear();
  out.reference.reset();
  out.step.reset();
  p.law = stored_law;
  RowWriter rows;
  std::vector<Index> place;
  auto slip = slips.begin();
  for (Index i = 0; i < old.rows(); ++i) {
    const auto s = at(i);
    const bool slides = slip != slips.end() && slip->contact == i;
    place.push_back(rows.rows());
    rows.add(old.kind[s], old.key[s], old.c[i], slides ? mu : 0);
    rows.entries(old.J, i);
    out.origin.push_back(frictionless.origin[s]);
    for (std::uint32_t number = 1; slip != slips.end() && slip->contact == i; ++slip, ++number) {
      rows.add(RowKind::tangent, {old.key[s].constraint, old.key[s].row + number}, 0);
      for (const auto& [column, value] : slip->entries) rows.entry(column, value);
      out.origin.push_back(frictionless.origin[s]);
      out.origin.back().row = static_cast<int>(number);
    }
  }
  rows.write(p);
  keep_reference(frictionless, place, out);
  return out;
}

Instance with_friction(const Instance& frictionless, double mu) {
  const Problem& p = frictionless.problem;
  const Index pairs = p.size() / 2;
  std::vector<SlipRow> slips;
  for (Index i = 0; i < p.rows() && pairs > 0; ++i) {
    if (p.is_equality(i) || frictionless.origin[at(i)].type != "contact") continue;
    SlipRow first{.contact = i}, second{.contact = i};
    for (decltype(p.J)::InnerIterator e(p.J, i); e; ++e) {
      const int j = static_cast<int>(e.col()), of_four = j % 4;
      if (j / 2 < pairs) first.entries.emplace_back(j ^ 1, j % 2 == 0 ? e.value() : -e.value());
      second.entries.emplace_back(j ^ 2, of_four == 0 || of_four == 3 ? e.value() : -e.value());
    }
    slips.push_back(std::move(first));
    if (p.size() % 4 == 0) slips.push_back(std::move(second));
  }
  return with_friction(frictionless, mu, slips);
}

}  // namespace zwang
