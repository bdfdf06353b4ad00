#include <boost/multiprecision/mpfr.hpp>
// after the number type it describes
#include <boost/multiprecision/eigen.hpp>

#include <zwang/bench/references/kkt_certificate.h>
#include <zwang/bench/references/wide_active_set.h>
#include <zwang/bench/references/witnesses.h>
#include <zwang/core/referee/tolerances.h>

namespace zwang {
namespace {

namespace mp = boost::multiprecision;
using Hundred = mp::number<mp::mpfr_float_backend<100, mp::allocate_stack>, mp::et_off>;

}  // namespace

std::optional<Reference> multiprecision_reference(const Problem& problem, std::string* why_not) {
  const auto none = [why_not](const std::string& reason) -> std::optional<Reference> {
    if (why_not) *why_not = reason;
    return {};
  };
  WideActiveSet<Hundred> method;
  const Status status = method.solve(problem);
  if (status == Status::bad_input) return none("M is not positive definite");
  Reference found{.feasible = status != Status::infeasible, .method = "mpfr 100 digits, KKT certified in 100 digits"};
  const KktCertificate<Hundred> certificate(problem);
  const std::string refused =
      found.feasible ? certificate.refuse(method.z, method.lambda) : certificate.refuse_infeasible(method.certificate);
  if (!refused.empty()) return none("the 100-digit answer fails its certificate: " + refused);
  if (!found.feasible) {
    // The largest entry becomes 1: multipliers of rows of size 2^-500 would not fit a double.
    Hundred largest(0);
    for (Index i = 0; i < problem.rows(); ++i) largest = std::max(largest, Hundred(abs(method.certificate[i])));
    found.certificate = (method.certificate / largest).cast<double>();
    return found;
  }
  // What cancels to the last of the digits is zero; `bound` counts it in.
  Hundred largest(0);
  for (Index j = 0; j < problem.size(); ++j)
    largest = std::max({largest, Hundred(abs(method.z[j])), Hundred(std::abs(problem.z_u[j]))});
  const Hundred nothing = Hundred(tolerances::hundred_digits) * largest;
  found.z = method.z.unaryExpr([&](const Hundred& z) { return abs(z) > nothing ? static_cast<double>(z) : 0.0; });
  // |z - z*|_M / s of z* and its doubles, with what the certificate leaves open.
  const Hundred lost = certificate.norm(method.z - found.z.cast<Hundred>());
  const Hundred s = std::max(certificate.norm(method.z), certificate.norm(problem.z_u.cast<Hundred>()));
  found.bound = (lost > 0 ? referee::up(static_cast<double>(Hundred(lost / s))) : 0) + certificate.limit;
  found.lambda = method.lambda.cast<double>();
  for (Index i = 0; i < problem.rows(); ++i)
    if (!problem.is_equality(i)) found.lambda[i] = std::max(0.0, found.lambda[i]);
  return found;
}

}  // namespace zwang
