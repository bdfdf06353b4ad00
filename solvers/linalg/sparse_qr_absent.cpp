// SparseQr without SuiteSparseQR, whose licence is the GPL: no rows are taken, and dense columns do all the work.
#include <zwang/solvers/linalg/sparse_qr.h>

#include <stdexcept>

namespace zwang {
namespace {

[[noreturn]] void absent() { throw std::logic_error("SparseQr: built without SuiteSparseQR"); }

}  // namespace

bool SparseQr::factorize(const Rows&, const std::vector<Index>&, double, const Deadline&) { return false; }
void SparseQr::reduce(const Rows&, std::span<const Index>, Matrix&) const { absent(); }
void SparseQr::solve(Eigen::Ref<Matrix>) const { absent(); }
void SparseQr::solve_transposed(Vector&) const { absent(); }
void SparseQr::multiply(bool, Eigen::Ref<Matrix>) const { absent(); }

}  // namespace zwang
