#pragma once

#include <span>
#include <vector>

#include <zwang/solvers/active_set/null_space_adapter.h>
#include <zwang/solvers/factor/cholesky_rows.h>
#include <zwang/solvers/factor/dual_climb.h>
#include <zwang/solvers/finish/polish.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Sparse Cholesky projection: the dual active-set method (Goldfarb & Idnani 1983, Math. Prog. 27) on the Delassus form
//
//   minimize 1/2 l'S l - h'l,  l_I >= 0,   S = G G',   y = G'l,
//
// with S_A factorized by CHOLMOD, one row added or taken out per step (its modify module is under the GPL). y is the
// nearest point to 0 of the active rows; the most violated row r moves it by
//
//   l_A -= t S_A^-1 S_Ar,  l_r += t,  y += t (g_r - G_A' S_A^-1 S_Ar),
//
// until r holds (r enters) or a multiplier reaches zero (that row leaves).
//
// Forming S squares the condition number: alone, CHOLMOD's updates broke at 3e-5 between near-parallel joints and
// solved a redundant four-bar linkage wrongly. So after every change the KKT residuals are corrected in the primal
// space; where the correction is large the factor is built anew; and where that does not help, or the polish
// (solvers/finish/polish.h) finds the factor too coarse for its extended residuals, the same method goes on with
// orthogonal factors from the rows found so far. Solution::fallback tells. Tried before: the polish alone from there;
// it has no merit function, and from a set far from the solution's (a hand with many touching rows) it circled.
struct Cholesky {
  static constexpr const char* name = "cholesky";
  double refactor_above = 1e-8;  // relative correction of y after a change that makes the factor be built anew

  bool reduce = false;  // the few unknowns that joints leave first (null_space_adapter.h), where there are any
  bool polish = true;   // off: y and lambda as the steps leave them

  static std::vector<Setting<Cholesky>> settings() {
    return {{"refactor_above", &Cholesky::refactor_above, "correction of y, relative, that makes S_A be refactorized"},
            {"reduce", &Cholesky::reduce, "solve in the few unknowns that the joints leave"},
            {"polish", &Cholesky::polish,
             "solve the active rows again in extended precision (off: the method's own answer)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  class Method {
   public:
    void solve(const Problem& problem, const Cholesky& settings, const SolveOptions& options, Solution& solution);

    // What dual_climb.h asks for. A row that no other can leave for is left to the polish, which proves it.
    Index choose() const;
    double split(Index p);
    bool is_dependent(double share) const { return !active_->accepts(share); }
    double violation(Index p) const { return w_.h[p] - active_->dot(p, y_); }
    static constexpr bool is_satisfied(Index, double) { return false; }
    Blocking<double> blocking() const;
    bool contradicts(Index p, double share);
    static constexpr void retire(Index) {}
    void move(double step, bool dependent);
    void drop(Index position);
    void append(Index p, double multiplier, double share);
    bool is_stuck() const { return stuck_; }

   private:
    bool attempt(const Problem& problem, ActiveRows& active, std::span<const Index> guess, const SolveOptions& options,
                 const Deadline& deadline, Solution& solution);
    void start(ActiveRows& active, std::span<const Index> guess, const Deadline& deadline);
    bool settle();
    bool correct(ActiveRows& active);

    DenseStorage storage_;
    Whitened w_;
    WarmRows warm_rows_;
    CholeskyRows sparse_;
    QrRows orthogonal_;
    Polish polish_;
    Vector y_, l_, direction_, rate_, r2_;
    Vector proof_;  // of a contradiction, on unit rows
    double refactor_above_ = 0;
    bool polishes_ = true, stuck_ = false;
    ActiveRows* active_ = nullptr;  // of the attempt under way
    std::vector<Index> found_;      // by the method alone
    std::vector<char> set_aside_;   // active, or an equality row that depends on the active ones
  };

  Reducible<Method> method_;
};

}  // namespace zwang
