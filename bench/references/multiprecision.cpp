#include <boost/multiprecision/mpfr.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>

#include <zwang/bench/references/witnesses.h>
#include <zwang/solvers/active_set/goldfarb_idnani.h>

namespace zwang {
namespace {

namespace mp = boost::multiprecision;
using Hundred = mp::number<mp::mpfr_float_backend<100, mp::allocate_stack>, mp::et_off>;

}  // namespace

std::optional<Reference> multiprecision_reference(const Problem& problem) {
  GoldfarbIdnani<Hundred> method;
  const Status status = method.solve(cast<Hundred>(problem), {});
  Reference found{.method = "mpfr 100 digits"};
  if (status == Status::infeasible) {
    found.feasible = false;
    // The largest entry becomes 1: multipliers of rows of size 2^-500 would not fit a double.
    Hundred largest(0);
    for (Index i = 0; i < problem.rows(); ++i) largest = std::max(largest, Hundred(abs(method.certificate[i])));
    found.certificate = (method.certificate / largest).cast<double>();
    return found;
  }
  if (status != Status::solved || !method.contracted) return {};
  found.z = method.z().cast<double>();
  found.lambda = method.lambda().cast<double>();
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_equality(i)) found.lambda[i] = std::max(0.0, found.lambda[i]);
  return found;
}

}  // namespace zwang
