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
using ByCols = SparseMatrix<double>;
using ByRows = SparseMatrix<double, RowMajor>;
ZWANG_ONCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE void PartialPivLU<MatrixXd>::compute();
ZWANG_ONCE void FullPivLU<MatrixXd>::computeInPlace();
ZWANG_ONCE void HouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
ZWANG_ONCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<ByCols>>::ordering(const ByCols&, const ByCols*&, ByCols&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<ByCols>>::analyzePattern_preordered(const ByCols&, bool);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<ByCols>>::factorize_preordered<false>(const ByCols&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<ByCols>>::ordering(const ByCols&, const ByCols*&, ByCols&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<ByCols>>::analyzePattern_preordered(const ByCols&, bool);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<ByCols>>::factorize_preordered<true>(const ByCols&);
ZWANG_ONCE ByRows& ByRows::operator=(const SparseMatrixBase<ByCols>&);
ZWANG_ONCE ByCols& ByCols::operator=(const SparseMatrixBase<ByRows>&);
ZWANG_ONCE double& SparseMatrix<double>::insert(Index, Index);
ZWANG_ONCE double& SparseMatrix<double>::insertUncompressed(Index, Index);
}  // namespace Eigen

namespace Eigen::internal {
using Sizes = gebp_traits<double, double>;
using Columns = const_blas_data_mapper<double, Index, ColMajor>;
using Rows = const_blas_data_mapper<double, Index, RowMajor>;
ZWANG_ONCE void minimum_degree_ordering(ByCols&, PermutationMatrix<Dynamic, Dynamic, int>&);
ZWANG_ONCE void assign_sparse_to_sparse(ByCols&, const ByCols&);
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
