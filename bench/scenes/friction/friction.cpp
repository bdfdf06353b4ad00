#include <zwang/bench/scenes/friction/friction.h>

#include <zwang/constraints/contact.h>
#include <zwang/core/problem/law.h>
#include <zwang/core/problem/row_writer.h>

namespace zwang {
void rub(Scene& scene, double mu) {
  if (mu == 0) return;
  for (Contact& contact : scene.list_of<Contact>().all) contact.friction = mu;
}

// Frictionless forces, and nothing slips. Under Coulomb's law there may be others.
std::optional<Reference> known_with_friction(Reference known, const Problem& p) {
  std::vector<Index> place;  // of the rows without friction
  for (Index i = 0; i < p.rows(); ++i)
    if (!p.is_tangent(i)) place.push_back(i);
  if (known.feasible) {
    Vector slip = p.J * known.z;
    slip(place).setZero();
    if ((slip.array() != 0).any()) return {};
  }
  for (Vector* const of_rows : {&known.lambda, &known.certificate}) {
    if (of_rows->size() == 0) continue;
    Vector spread = Vector::Zero(p.rows());
    spread(place) = *of_rows;
    *of_rows = std::move(spread);
  }
  known.unique = false;
  return known;
}

Instance with_friction(const Instance& frictionless, double mu) {
  Instance out = frictionless;
  const Problem& old = frictionless.problem;
  Problem& p = out.problem;
  out.origin.clear();
  RowWriter rows;
  const int pairs = static_cast<int>(old.size()) / 2, slips = pairs == 0 ? 0 : old.size() % 4 == 0 ? 2 : 1;
  for (Index i = 0; i < old.rows(); ++i) {
    const RowOrigin& origin = frictionless.origin[at(i)];
    const RowKey& key = old.key[at(i)];
    const bool slides = !old.is_equality(i) && origin.type == "contact";
    rows.add(old.kind[at(i)], key, old.c[i], slides ? mu : 0);
    rows.entries(old.J, i);
    out.origin.push_back(origin);
    for (int slip = 1; slides && slip <= slips; ++slip) {
      rows.add(RowKind::tangent, {key.constraint, key.row + static_cast<std::uint32_t>(slip)}, 0);
      for (RowMatrix::InnerIterator e(old.J, i); e; ++e) {
        const int j = static_cast<int>(e.col()), of_four = j % 4;
        const bool keeps_sign = slip == 1 ? j % 2 == 0 : of_four == 0 || of_four == 3;
        if (slip == 2 || j / 2 < pairs) rows.entry(j ^ slip, keeps_sign ? e.value() : -e.value());
      }
      out.origin.push_back(origin);
      out.origin.back().row = slip;
    }
  }
  if (rows.rows() == old.rows()) return frictionless;
  rows.write(p);
  p.law = stored_law;
  out.step.reset();
  if (out.reference) out.reference = known_with_friction(*std::move(out.reference), p);
  return out;
}

}  // namespace zwang
