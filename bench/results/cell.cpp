#include <zwang/bench/results/cell.h>

#include <zwang/core/files/stored_file.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

std::string CellKey::name(const std::string& commit) const {
  const std::string digits = printed("%.17g", tolerance);
  return sha256(commit + '\n' + problem_file + '\n' + problem_sha256 + '\n' + solver + '\n' + digits).substr(0, 32);
}

std::string problem_file(std::size_t position) { return printed("problems/%04zu.h5", position); }

}  // namespace zwang
