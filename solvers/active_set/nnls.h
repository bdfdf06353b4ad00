#pragma once

#include <vector>

#include <zwang/core/problem/shape_cache.h>
#include <zwang/solvers/active_set/lawson_hanson.h>
#include <zwang/solvers/active_set/null_space_adapter.h>
#include <zwang/solvers/finish/polish.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/form/whiten.h>
#include <zwang/solvers/linalg/dense_storage.h>
#include <zwang/solvers/setting.h>

namespace zwang {

// Least-distance programming by non-negative least squares (Lawson & Hanson 1974, ch. 23, LDP), in the whitened
// coordinates of solvers/form/whiten.h:
//
//   E = [G'; h' / sigma],  f = e_{n+1},  u = argmin |E u - f|, u_I >= 0, u_E free;  r = f - E u
//   y = -sigma r_{1:n} / r_{n+1}   (sign: E u - f in the book),   lambda = sigma u / r_{n+1};   r = 0: infeasible.
//
// Needs no k with J k = c, unlike the paper's form (solvers/active_set/nnls_paper.h).
//
// sigma is the unit of length. Its best value is |y| itself, for then |r|^2 = 1/2; where |y| / sigma is large, r is
// a small difference of large numbers. So sigma starts at the largest violation and follows |y| up, each round warm
// started with the passive set of the one before. With sigma fixed at the largest violation the method broke at mass
// ratios of 4e9; unscaled it breaks near |y| = 1e5.
//
// The answer itself comes from solvers/finish/polish.h, on the rows that came out active; with polish=off it is the y
// and lambda above.
struct Nnls {
  static constexpr const char* name = "nnls";
  bool reduce = false;  // the few unknowns that joints leave first (null_space_adapter.h), where there are any
  bool project = true;  // project the equality rows out first (orthogonally) instead of carrying them as free columns
  bool polish = true;   // off: y and lambda as the least squares leave them

  static std::vector<Setting<Nnls>> settings() {
    return {
        {"reduce", &Nnls::reduce, "solve in the few unknowns that the joints leave"},
        {"project", &Nnls::project, "project the equality rows out first (off: free columns of the least squares)"},
        {"polish", &Nnls::polish, "solve the active rows again in extended precision (off: the method's own answer)"}};
  }

  void solve(const Problem& problem, const SolveOptions& options, Solution& solution);

 private:
  class Method {
   public:
    void solve(const Problem& problem, const Nnls& settings, const SolveOptions& options, Solution& solution);

   private:
    void eliminate(const Problem& problem, bool project, const Deadline& deadline);
    bool least_distance(const Problem& problem, const SolveOptions& options, const Deadline& deadline, bool polish,
                        Solution& solution);
    void balance(const Vector& y);
    void write_iterate(const Problem& problem, Solution& solution);

    DenseStorage storage_;
    Whitened rows_;
    WarmRows warm_rows_;
    LawsonHanson least_squares_;
    QrRows active_;  // the equality rows, then all active rows
    Polish polish_;
    Matrix E_;
    Vector f_, y_E_, h_, length_, y_, unit_, rest_, work_;
    std::vector<Index> column_;  // column of E -> whitened row
    std::vector<Index> warm_;    // columns
    std::vector<char> free_;     // of the columns
    double sigma_ = 1;
  };

  NullSpaceAdapter reduced_;
  ShapeCache<Method> plain_;
};

}  // namespace zwang
