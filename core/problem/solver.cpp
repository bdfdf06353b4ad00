#include <zwang/core/problem/solver.h>

#include <charconv>
#include <cmath>
#include <new>
#include <stdexcept>

#include <zwang/core/problem/law.h>
#include <zwang/core/problem/wording.h>

namespace zwang {

void SolveOptions::read_accuracy(std::string_view text) {
  accuracy = speed_accuracy = 0;
  if (text.empty()) return;
  const bool of_speed = text.ends_with("m/s");
  const std::string_view digits = of_speed ? text.substr(0, text.size() - 3) : text;
  double& value = of_speed ? speed_accuracy : accuracy;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error == std::errc() && end == digits.data() + digits.size() && value > 0 && std::isfinite(value) &&
      (of_speed || value < 1))
    return;
  throw std::invalid_argument(
      "accuracy: expected a number between 0 and 1, as in 1e-4, or a speed, as in 1e-4m/s; got '" + std::string(text) +
      "'");
}

std::string AnySolver::cannot_read(Law law) {
  return "it does not solve problems with friction under the law " + std::string(to_string(law)) +
         " (./zwang solvers lists the laws of each)";
}

void AnySolver::solve(const Problem& problem, const SolveOptions& options, Solution& solution) {
  require_matching_sizes(problem);
  const auto give_up = [&](Status status, const std::string& reason) {
    solution.reset(0, 0);
    solution.status = status;
    solution.message = reason;
  };
  if (const std::string reason = bad_input(problem); !reason.empty()) return give_up(Status::bad_input, reason);
  try {
    method_->solve(problem, options, solution);
  } catch (const Stopped& stopped) {
    return give_up(stopped.status, stopped.message);
  } catch (const std::bad_alloc&) {
    return give_up(Status::numerical_failure, "out of memory");
  } catch (const std::exception& thrown) {
    return give_up(Status::numerical_failure, std::string("threw: ") + thrown.what());
  } catch (...) {
    return give_up(Status::numerical_failure, "threw: what is no std::exception");
  }
  const bool claims_z = solution.status == Status::solved || solution.status == Status::solved_ill_conditioned;
  const auto refuse_unless = [&](const Vector& x, Index size, const char* name) {
    if ((x.size() == size && x.allFinite()) || solution.status == Status::numerical_failure) return;
    solution.status = Status::numerical_failure;
    solution.message = x.size() != size ? printed("%s has %td entries, expected %td", name, x.size(), size)
                                        : std::string(name) + " holds a number that does not fit doubles";
  };
  if (!claims_z) return;
  refuse_unless(solution.z, problem.size(), "z");
  if (solution.lambda.size() > 0) refuse_unless(solution.lambda, problem.rows(), "lambda");
}

Solution AnySolver::solve(const Problem& problem, const SolveOptions& options) {
  Solution solution;
  solve(problem, options, solution);
  return solution;
}

}  // namespace zwang
