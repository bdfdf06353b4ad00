#pragma once

#include <vector>

#include <zwang/core/problem/problem.h>
#include <zwang/solvers/factor/dense_face.h>
#include <zwang/solvers/factor/sparse_face.h>
#include <zwang/solvers/form/null_space_form.h>
#include <zwang/solvers/form/unit_rows.h>
#include <zwang/solvers/form/warm_rows.h>
#include <zwang/solvers/law/cone_law.h>
#include <zwang/solvers/linalg/tolerances.h>

namespace zwang {

// A problem with friction in standard second-order cones, L = {x_0 >= |x_t|}: with v a motion in a unit of length near
// the worst violation,
//
//   M v = G'y,   s = G v - h,   cones:       y and s under a ConeLaw
//                               single rows: s >= 0 ⊥ y >= 0; equality rows s = 0.
//
// A contact (N, T1, T2) of coefficient mu becomes the cone (N / mu, T1, T2) with y = (mu l_n, l_t), all rows times one
// factor that makes the mean diagonal of its Delassus block 1. Limits and contacts without friction (mu = 0) are single
// unit rows. Jointed bodies are stated in the freedoms that their joints leave (null_space_form.h), problems of few
// unknowns or full rows in whitened coordinates, both on a DenseFace with M = I; the rest on a SparseFace.
class ConeProgram {
 public:
  enum class Want {
    any,
    dense,     // rows, whatever they are, where can_be_dense()
    sparse,    // rows that are not full keep their zeros, for a factor or two
    way_back,  // joints stay, so that read() knows the way back from z
    normals    // every contact is taken for one without friction
  };
  // Under the problem's law. Resets the solution. False where the answer is known, and then written. made:
  // where there may be a form of these bodies; it, or the last, is taken where it is theirs, and then h is void until
  // restate().
  bool build(const Problem& problem, Want want, const SolveOptions& options, const Deadline& deadline,
             Solution& solution, NullSpaceForm* made = nullptr);
  // The problem as it was built, less its z_u and c: those of this one. False where it asks what no motion changes.
  bool restate(const Problem& problem, const Deadline& deadline);
  // The same rows under another law of cones; with the cones lifted by slips, as if each contact slid so fast.
  void state(ConeLaw law, const Vector* slips = nullptr);
  static bool can_be_dense(const Problem& problem);

  ConeLaw law() const { return law_; }
  Index cones() const { return std::ssize(mu_); }
  Index rays() const { return std::ssize(equality_); }
  Index rows() const { return std::ssize(row_); }
  double mu(Index k) const { return mu_[at(k)]; }
  // mu where it is so far from 1 that the rows N / mu and T of a cone are of different sizes; else 1.
  double tilt(Index k) const { return mu(k) < 1 / tolerances::cone_far || mu(k) > tolerances::cone_far ? mu(k) : 1; }
  bool is_equality(Index ray) const { return equality_[at(ray)] != 0; }
  bool repeats_equalities() const;
  Index source(Index r) const { return row_[at(r)].source; }  // the problem's; -1: a planar contact's second tangent
  const Vector& h() const { return h_; }
  ConeFace& face() { return is_dense() ? static_cast<ConeFace&>(dense_face_) : sparse_face_; }
  bool is_dense() const { return form_ != Form::sparse; }
  void couple() { sparse_face_.couple(); }  // of sparse rows: as of dense ones from now on
  // Does slip lift, and is that differentiated?
  bool couples() { return law_.lifts() && face().takes_unsymmetric(); }
  DenseFace& dense_face() { return dense_face_; }  // where it is
  // As the face's; and how many were made so far, of these rows and others.
  bool factorize(const std::vector<double>& D, const Vector& ray_weight, bool symmetric) {
    ++factors_;
    return face().factorize(D, ray_weight, symmetric);
  }
  long factors() const { return factors_; }
  double length(const Vector& v);  // |v|_M
  double scale(const Vector& v);   // max(|z_u|_M, |v|_M)
  double reach() const;            // of what is known of the motion before it is solved for
  // A motion next to which the rows' right sides are nothing: rows that contradict each other are met so, not solved.
  bool is_out_of_reach(const Vector& v) { return scale(v) > tolerances::out_of_reach * reach(); }
  double start() const { return start_; }  // the worst violation at v = 0, or a small number

  // s = G v - h.
  void slack(const Vector& v, Vector& s) {
    face().slack(v, s);
    s -= h_;
  }
  // What is wrong with (s, y): the natural residual, the largest entry of a contact's l - P_K(l - s) in unit rows (with
  // the law's shift of s), and the gap y's with the violations charged, by which |v - v*|_M <= sqrt(2 gap) under the
  // convex law.
  struct Residual {
    double natural = 0, gap = 0;
    double rounding = 0;  // of the sum of what all rows push
  };
  Residual residual(const Vector& y, const Vector& s) const;
  // Does that answer the problem to the tolerance? What `solved` of the solvers on cones says. `settled`: a method that
  // knows its error, as ModeNewton, has found it below the tolerance.
  bool accepts(const Residual& residual, const Vector& v, const SolveOptions& options, bool settled = false);
  // What M v and G'y are apart, relative to M v.
  double imbalance(const Vector& v, const Vector& y);

  // For promises (promise.h). Multipliers of the problem's rows, cut to the cones; f := M^-1 f; and max(|z_u|_M, |z|_M)
  // at the least.
  void read(const Vector& lambda, Vector& y) const;
  void scale_multipliers(const Vector& lambda, Vector& y) const;  // read(), less the cut
  Vector scaled_slack(const Vector& slack) const;                 // of the problem's rows
  void cut(Vector& y) const;                                      // to the cones, and to what is not negative
  void divide_by_mass(Vector& f);
  void move_freely(Vector& f);                               // the same of the problem's unknowns
  Vector momentum(const Problem& problem, const Vector& z);  // M z of the problem
  double least_motion(const Vector& v) { return std::max(free_norm_, scale(v) - free_norm_); }
  double tied() const;                        // as SparseCholesky's, over the smallest pivot of joints
  int exponent() const { return exponent_; }  // lengths are in units of 2^exponent

  // Multipliers of an earlier frame; false where there are none.
  bool warm(const Problem& problem, const WarmStart* warm, Vector& y);
  void write(const Problem& problem, const Vector& v, const Vector& y, Solution& solution);
  // The way back, where no joints were eliminated.
  void read(const Problem& problem, const Vector& z, const Vector& lambda, Vector& v, Vector& y);
  void write_certificate(const Problem& problem, const Vector& u, Solution& solution);

 private:
  enum class Form { joints, whitened, sparse };
  template <class Rows>
  bool collect(const Problem& problem, const Rows& rows, Solution& solution);
  bool meets_immobile(const Problem& problem, Index row, double mu, Solution& solution) const;
  void fill_dense();
  void fill_sparse(const Problem& problem, const SolveOptions& options, const Deadline& deadline);
  void write_multipliers(const Vector& y, int exponent, Vector& lambda);

  Form form_ = Form::whitened;
  ConeLaw law_;
  bool has_cones_ = false;
  long factors_ = 0;
  NullSpaceForm joints_;
  Whitened whitened_;
  UnitRows unit_rows_;
  WarmRows warm_rows_;
  DenseFace dense_face_;
  SparseFace sparse_face_;

  struct Row {
    Index source, unit;   // the problem's row, or -1; its unit row, or -1 for a zero row
    double factor, norm;  // this row is the unit row times `factor`, that the problem's over `norm`
    double h;             // without slips
    double of_source(double own) const { return own * factor / norm; }
  };
  std::vector<Index> unit_of_;  // of the problem's row: which unit row, or -1
  std::vector<Row> row_;
  std::vector<double> mu_;
  std::vector<char> equality_;
  Vector h_;
  int exponent_ = 0;
  double free_norm_ = 0, joint_norm_ = 0, start_ = 1;
  SparseRows sparse_rows_;
  std::vector<int> pattern_;
  Vector work_, force_, short_, mu_E_, lambda_;
  struct AllRows {  // of the problem, as WarmRows wants them
    std::vector<Index> row;
    std::vector<char> equality;
    Index rows() const { return std::ssize(row); }
    static double unit_multiplier(Index, double lambda) { return lambda; }
  } all_rows_;
  NullSpaceForm::Motion motion_, rest_;
};

}  // namespace zwang
