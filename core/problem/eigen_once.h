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
ZWANG_ONCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
ZWANG_ONCE void PartialPivLU<MatrixXd>::compute();
ZWANG_ONCE void FullPivLU<MatrixXd>::computeInPlace();
ZWANG_ONCE void HouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void ColPivHouseholderQR<MatrixXd>::computeInPlace();
ZWANG_ONCE void CompleteOrthogonalDecomposition<MatrixXd>::computeInPlace();
ZWANG_ONCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, int);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<SparseMatrix<double>>>::ordering(const SparseMatrix<double>&,
                                                                                      const SparseMatrix<double>*&,
                                                                                      SparseMatrix<double>&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<SparseMatrix<double>>>::analyzePattern_preordered(
    const SparseMatrix<double>&, bool);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLLT<SparseMatrix<double>>>::factorize_preordered<false>(
    const SparseMatrix<double>&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<SparseMatrix<double>>>::ordering(const SparseMatrix<double>&,
                                                                                       const SparseMatrix<double>*&,
                                                                                       SparseMatrix<double>&);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<SparseMatrix<double>>>::analyzePattern_preordered(
    const SparseMatrix<double>&, bool);
ZWANG_ONCE void SimplicialCholeskyBase<SimplicialLDLT<SparseMatrix<double>>>::factorize_preordered<true>(
    const SparseMatrix<double>&);
ZWANG_ONCE SparseMatrix<double, RowMajor>& SparseMatrix<double, RowMajor>::operator=(
    const SparseMatrixBase<SparseMatrix<double, ColMajor>>&);
ZWANG_ONCE SparseMatrix<double, ColMajor>& SparseMatrix<double, ColMajor>::operator=(
    const SparseMatrixBase<SparseMatrix<double, RowMajor>>&);
ZWANG_ONCE double& SparseMatrix<double, ColMajor>::insert(Index, Index);
ZWANG_ONCE double& SparseMatrix<double, ColMajor>::insertUncompressed(Index, Index);
}  // namespace Eigen

namespace Eigen::internal {
ZWANG_ONCE void minimum_degree_ordering(SparseMatrix<double>&, PermutationMatrix<Dynamic, Dynamic, int>&);
ZWANG_ONCE void assign_sparse_to_sparse(SparseMatrix<double, ColMajor>&, const SparseMatrix<double, ColMajor>&);
ZWANG_ONCE void assign_sparse_to_sparse(SparseMatrix<double, RowMajor>&, const SparseMatrix<double, RowMajor>&);
ZWANG_ONCE struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>,
                              gebp_traits<double, double>::mr, gebp_traits<double, double>::nr, false, false>;
ZWANG_ONCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>,
                                gebp_traits<double, double>::mr, gebp_traits<double, double>::LhsProgress,
                                gebp_traits<double, double>::LhsPacket4Packing, ColMajor>;
ZWANG_ONCE struct gemm_pack_lhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>,
                                gebp_traits<double, double>::mr, gebp_traits<double, double>::LhsProgress,
                                gebp_traits<double, double>::LhsPacket4Packing, RowMajor>;
ZWANG_ONCE struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, ColMajor>,
                                gebp_traits<double, double>::nr, ColMajor>;
ZWANG_ONCE struct gemm_pack_rhs<double, Index, const_blas_data_mapper<double, Index, RowMajor>,
                                gebp_traits<double, double>::nr, RowMajor>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, ColMajor>,
                                                ColMajor, false, double,
                                                const_blas_data_mapper<double, Index, ColMajor>, false>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, ColMajor>,
                                                ColMajor, false, double,
                                                const_blas_data_mapper<double, Index, RowMajor>, false>;
ZWANG_ONCE struct general_matrix_vector_product<Index, double, const_blas_data_mapper<double, Index, RowMajor>,
                                                RowMajor, false, double,
                                                const_blas_data_mapper<double, Index, ColMajor>, false>;
}  // namespace Eigen::internal

#undef ZWANG_ONCE
