#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <zwang/bench/packs/pack.h>
#include <zwang/core/problem/solver.h>

namespace zwang {

// What one solver, of any origin, answered to one problem.
struct Answer {
  Solution solution = {};
  double seconds = Solution::unknown;   // of its solve, on the machine of the header
  double residual = Solution::unknown;  // as the solver claims it
};

// One solver's answers to a pack (docs/packs.md): lines of JSON, numpy.savez or HDF5.
struct Answers {
  std::filesystem::path file = {};
  std::string solver = {}, version = {}, settings = {}, machine = {};
  double tolerance = 1e-10;               // that it was asked for
  std::map<std::string, Answer> of = {};  // by the problem's sha256
  std::vector<std::string> missing = {};  // names of the pack's problems that have none
};

// The format is told by the contents. Throws BadFile with one line (file, place, what was expected): a damaged file, a
// number that is not finite, a vector of another length than the problem's, a problem answered twice or not in the
// pack.
Answers read_answers(const std::filesystem::path& file, const Pack& pack);

// What to call each: its solver, and where that is taken the file, too. Throws std::invalid_argument where both are.
std::vector<std::string> names_of(std::span<const Answers> contestants);

// The file's lines, to the last digit.
std::string answers_header(const Answers& answers);
std::string answers_line(const std::string& sha256, const Answer& answer);

}  // namespace zwang
