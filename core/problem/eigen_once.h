// Factorizations and kernels of Eigen that many files need and eigen_once.cpp compiles: part of the precompiled
// headers. Members that Eigen defines inside its classes are compiled where they are used all the same; these are the
// others. eigen_once.cpp reads this a second time, so there is no #pragma once.

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#ifndef ZWANG_ONCE
#define ZWANG_ONCE extern template
#endif

namespace Eigen {
using SparseLLT = SimplicialCholeskyBase<SimplicialLLT<SparseMatrix<double>>>;
using SparseLDLT = SimplicialCholeskyBase<SimplicialLDLT<SparseMatrix<double>>>;
using ByColumns = SparseMatrix<double, ColMajor>;
using ByRows = SparseMatrix<double, RowMajor>;
ZWANG_ONCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE void PartialPivLU<MatrixXd>::compute();
ZWANG_ONCE void FullPivLU<MatrixXd>::computeInPlace();
ZWANG_ONCE void HouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
ZWANG_ONCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
ZWANG_ONCE void SparseLLT::ordering(const ByColumns&, const ByColumns*&, ByColumns&);
ZWANG_ONCE void SparseLLT::analyzePattern_preordered(const ByColumns&, bool);
ZWANG_ONCE void SparseLLT::factorize_preordered<false>(const ByColumns&);
ZWANG_ONCE void SparseLDLT::ordering(const ByColumns&, const ByColumns*&, ByColumns&);
ZWANG_ONCE void SparseLDLT::analyzePattern_preordered(const ByColumns&, bool);
ZWANG_ONCE void SparseLDLT::factorize_preordered<true>(const ByColumns&);
ZWANG_ONCE ByRows& ByRows::operator=(const SparseMatrixBase<ByColumns>&);
ZWANG_ONCE ByColumns& ByColumns::operator=(const SparseMatrixBase<ByRows>&);
ZWANG_ONCE double& ByColumns::insert(Index, Index);
ZWANG_ONCE double& ByColumns::insertUncompressed(Index, Index);
}  // namespace Eigen

namespace Eigen::internal {
using Sizes = gebp_traits<double, double>;
using Columns = const_blas_data_mapper<double, Index, ColMajor>;
using Rows = const_blas_data_mapper<double, Index, RowMajor>;
ZWANG_ONCE void minimum_degree_ordering(ByColumns&, PermutationMatrix<Dynamic, Dynamic, int>&);
ZWANG_ONCE void assign_sparse_to_sparse(ByColumns&, const ByColumns&);
ZWANG_ONCE void assign_sparse_to_sparse(ByRows&, const ByRows&);
ZWANG_ONCE struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>, Sizes::mr, Sizes::nr,
                              false, false>;
ZWANG_ONCE struct gemm_pack_lhs<double, Index, Columns, Sizes::mr, Sizes::LhsProgress, Sizes::LhsPacket4Packing,
                                ColMajor>;
ZWANG_ONCE struct gemm_pack_lhs<double, Index, Rows, Sizes::mr, Sizes::LhsProgress, Sizes::LhsPacket4Packing, RowMajor>;
ZWANG_ONCE struct gemm_pack_rhs<double, Index, Columns, Sizes::nr, ColMajor>;
ZWANG_ONCE struct gemm_pack_rhs<double, Index, Rows, Sizes::nr, RowMajor>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, Columns, ColMajor, false, double, Columns, false>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, Columns, ColMajor, false, double, Rows, false>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, Rows, RowMajor, false, double, Columns, false>;
}  // namespace Eigen::internal

#undef ZWANG_ONCE
