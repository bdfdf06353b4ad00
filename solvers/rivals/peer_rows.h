#pragma once

#include <initializer_list>
#include <utility>
#include <vector>

#include <zwang/solvers/form/unit_program.h>

namespace zwang {

// The unit rows in the forms that QP libraries ask for.

// Equality rows apart, each part by columns:  E y = e,  F y >= f.
struct RowsApart {
  using Columns = SparseMatrix;

  std::vector<Index> equalities, inequalities;  // rows of the program
  Columns E, F;
  Vector e, f;

  void build(const UnitProgram& program);
  // Multipliers of the two parts from those of the program, and back.
  void part(const Vector& lambda, Vector& of_E, Vector& of_F) const;
  void join(const Vector& of_E, const Vector& of_F, Vector& lambda) const;
};

// A library's word that no y meets the rows. Where `u`, the multipliers that it ended with, proves it (with the
// multipliers of the equality rows that fit best in place of its own, if need be), the certificate is written.
void write_infeasible(const Problem& problem, const UnitProgram& program, Vector u, Solution& solution);

// What a library ended with, by the status that was made of its word: y and lambda, or nothing where there are none or
// they are not finite; where it says infeasible, `ray` as above.
void write_answer(const Problem& problem, const UnitProgram& program, const Vector& y, const Vector& lambda, Vector ray,
                  Solution& solution);

// What a library's word means: numerical failure where it is none of the known ones.
template <class Word>
Status meaning(Word word, std::initializer_list<std::pair<Word, Status>> known) {
  for (const auto& [one, status] : known)
    if (one == word) return status;
  return Status::numerical_failure;
}

// The seconds left, for a library that takes none for "no limit" as `unlimited`. Throws Stopped where none are.
double seconds_left(const Deadline& deadline, double unlimited);

}  // namespace zwang
