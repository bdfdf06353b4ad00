#pragma once

#include <vector>

#include <zwang/solvers/active_set/least_distance.h>
#include <zwang/solvers/active_set/null_space_adapter.h>
#include <zwang/solvers/finish/polish.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Least-distance programming by non-negative least squares (least_distance.h), in the whitened coordinates of
// solvers/form/whiten.h. Needs no k with J k = c, unlike the paper's form (solvers/active_set/nnls_paper.h).
//
// The answer itself comes from solvers/finish/polish.h, on the rows that came out active; with polish=off it is the y
// and lambda of the least squares.
struct Nnls {
  static constexpr const char* name = "nnls";
  bool reduce = false;  // the few unknowns that joints leave first (null_space_adapter.h), where there are any
  bool polish = true;   // off: y and lambda as the least squares leave them

  static std::vector<Setting<Nnls>> settings() {
    return {
        {"reduce", &Nnls::reduce, "solve in the few unknowns that the joints leave"},
        {"polish", &Nnls::polish, "solve the active rows again in extended precision (off: the method's own answer)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  class Method {
   public:
    void solve(const Problem& problem, const Nnls& settings, const SolveOptions& options, Solution& solution);

   private:
    bool contradicts_itself(const Problem& problem, bool polish, Solution& solution);
    void write(const Problem& problem, Solution& solution);

    DenseStorage storage_;
    Whitened rows_;
    WarmRows warm_rows_;
    LeastDistance nearest_;
    Polish polish_;
    Vector y_, unit_;
  };

  Reducible<Method> method_;
};

}  // namespace zwang
