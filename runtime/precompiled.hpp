#pragma once
// Headers that most files read, and Eigen's decompositions and products of dynamic matrices: compiled once
// (precompiled.cpp) and not in each file that uses them. Read by the build alone (LUNID_PRECOMPILE): no file includes
// it.
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#ifndef LUNID_INSTANCE
#define LUNID_INSTANCE extern template
#endif

#if !EIGEN_VERSION_AT_LEAST(3, 4, 90)  // later ones have other arguments
namespace Eigen {
LUNID_INSTANCE class ColPivHouseholderQR<MatrixXd>;
LUNID_INSTANCE void ColPivHouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
LUNID_INSTANCE class HouseholderQR<MatrixXd>;
LUNID_INSTANCE void HouseholderQR<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
LUNID_INSTANCE class CompleteOrthogonalDecomposition<MatrixXd>;
LUNID_INSTANCE void CompleteOrthogonalDecomposition<MatrixXd>::_solve_impl(const VectorXd&, VectorXd&) const;
LUNID_INSTANCE class LDLT<MatrixXd>;
LUNID_INSTANCE void LDLT<MatrixXd>::_solve_impl_transposed<true>(const VectorXd&, VectorXd&) const;
LUNID_INSTANCE class LLT<MatrixXd>;
LUNID_INSTANCE class PartialPivLU<MatrixXd>;
LUNID_INSTANCE class FullPivLU<MatrixXd>;
LUNID_INSTANCE class SelfAdjointEigenSolver<MatrixXd>;
LUNID_INSTANCE class EigenSolver<MatrixXd>;
LUNID_INSTANCE EigenSolver<MatrixXd>& EigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
LUNID_INSTANCE RealSchur<MatrixXd>& RealSchur<MatrixXd>::compute(const EigenBase<MatrixXd>&, bool);
LUNID_INSTANCE SelfAdjointEigenSolver<MatrixXd>& SelfAdjointEigenSolver<MatrixXd>::compute(const EigenBase<MatrixXd>&,
                                                                                           int);
LUNID_INSTANCE LDLT<MatrixXd>& LDLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
LUNID_INSTANCE LLT<MatrixXd>& LLT<MatrixXd>::compute(const EigenBase<MatrixXd>&);
LUNID_INSTANCE void HouseholderSequence<MatrixXd, VectorXd>::evalTo(MatrixXd&, VectorXd&) const;
LUNID_INSTANCE void HouseholderSequence<MatrixXd, VectorXd>::applyThisOnTheLeft(MatrixXd&, VectorXd&, bool) const;
LUNID_INSTANCE void HouseholderSequence<MatrixXd, VectorXd>::applyThisOnTheLeft(VectorXd&, Matrix<double, 1, 1, 1>&,
                                                                                bool) const;
LUNID_INSTANCE class JacobiSVD<MatrixXd>;
namespace internal {
using Traits = gebp_traits<double, double>;
using Columns = const_blas_data_mapper<double, Index, ColMajor>;
using Rows = const_blas_data_mapper<double, Index, RowMajor>;
LUNID_INSTANCE struct gebp_kernel<double, double, Index, blas_data_mapper<double, Index, ColMajor>, Traits::mr,
                                  Traits::nr>;
LUNID_INSTANCE struct gemm_pack_rhs<double, Index, Columns, Traits::nr, ColMajor>;
LUNID_INSTANCE struct gemm_pack_rhs<double, Index, Rows, Traits::nr, RowMajor>;
LUNID_INSTANCE struct general_matrix_vector_product<Index, double, Rows, RowMajor, false, double, Columns, false>;
LUNID_INSTANCE struct general_matrix_vector_product<Index, double, Columns, ColMajor, false, double, Rows, false>;
}  // namespace internal
}  // namespace Eigen
#endif
