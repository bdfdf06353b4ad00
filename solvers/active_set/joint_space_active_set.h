#pragma once

#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <zwang/solvers/active_set/dense_dual_active_set.h>
#include <zwang/solvers/finish/body_point.h>
#include <zwang/solvers/form/null_space_form.h>
#include <zwang/solvers/form/warm_rows.h>

namespace zwang {

// The dual active-set method on the reduced form: the fast path of dual_active_set for clear problems of jointed
// bodies.
//
// The answer is refined as in extended_polish.h, with residuals of the problem's own M, J, c in twice the digits
// (body_point.h), and every row outside the active set is held against it to that precision. Anything less than clear
// is left to the careful path, whatever it costs: solve() then returns false and `reason` says why.
class JointSpaceActiveSet {
 public:
  // True with solution solved; false where the careful path must decide.
  bool solve(const Problem& problem, const SolveOptions& options, Solution& solution);
  std::string_view reason() const { return reason_; }
  void swap_form(NullSpaceForm& other) { std::swap(form_, other); }

  bool polish = true;  // off: the climb's point as it is; the refinement only tells its error

  // The same in steps, for another method in between (null_space_adapter.h) and for a clock (bench/timing/stages.h).
  // prepare() eliminates the joints; state() writes the reduced problem, its storage reused; climb() goes from active
  // rows of that one to the optimum in double; finish() does, refines it, and adds to the iterations.
  bool prepare(const Problem& problem);
  void state(const Problem& problem, Problem& reduced);
  bool climb(const SolveOptions& options, const Deadline& deadline, std::span<const Index> active, int& iterations);
  bool finish(const SolveOptions& options, const Deadline& deadline, std::span<const Index> active, Solution& solution);

 private:
  using Motion = NullSpaceForm::Motion;

  bool refuse(std::string_view why) {
    reason_ = why;
    return false;
  }
  void take(Index j);
  bool take_violated();
  void order_by_body();
  bool settle(const SolveOptions& options, const Deadline& deadline, int& iterations);
  void locate();
  void begin_from_climb();
  bool refine();
  bool clearly_independent() const;
  void push(const Vector& mu_E, const Vector& mu_I);
  void compute_residuals();
  double correct();
  bool rest_holds(double limit);
  bool falls_short(Index j) {
    short_ = j;
    return false;
  }
  bool enter_short();
  double error_bound();
  double inside(double unbalanced);
  double left(Index i, double far) const;
  bool is_active(Index j) const {
    const Index place = place_[at(j)];
    return place >= 0 && climb_.is_active(place);
  }
  Index active_row(Index k) const { return taken_[at(climb_.active()[at(k)])]; }

  NullSpaceForm form_;
  DenseDualActiveSet climb_;
  WarmRows warm_;
  std::vector<Index> place_;                        // of an inequality row in the climb, or -1
  std::vector<Index> taken_;                        // rows of form_, in the climb's order
  std::vector<std::pair<double, Index>> violated_;  // slack, inequality row
  std::vector<Index> ordered_;                      // inequality rows
  std::vector<std::size_t> place_of_body_;          // in ordered_
  std::vector<Index> column_, start_, listed_;      // of a row of form_ among its inequalities; warm rows; active rows
  std::vector<NearRow> near_;
  BodyPoint point_;
  Motion y_, own_y_, step_, rest_, rho_;
  Vector v_, mu_, mu_E_, sigma_E_, sigma_I_, dv_, dmu_, s_v_;
  std::vector<double> violation_;
  Index short_ = -1;        // an inequality row outside the active set that the refined answer does not meet
  double last_change_ = 0;  // of the refinement
  double doubt_ = 0;        // by how much rows outside the active set may move y; infinite: unknown
  std::string_view reason_;
};

}  // namespace zwang
