#include "reconstruct/registration/motion_field.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>

namespace velamap {
namespace {

constexpr int kNumLinearTerms = 2;

MotionField::Terms TermsAt(const Eigen::Vector2d& p) {
  return {p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y()};
}

Eigen::Matrix<double, 2, MotionField::kNumTerms> TermGradients(const Eigen::Vector2d& p) {
  Eigen::Matrix<double, 2, MotionField::kNumTerms> gradients;
  gradients << 1, 0, 2 * p.x(), p.y(), 0,  //
      0, 1, 0, p.x(), 2 * p.y();
  return gradients;
}

// Combinations of terms, by column, whose values at the markers (`terms`, by row) are orthonormal:
// linear ones first, so that an affine field is found exactly. `within`: sum over the markers of
// the products of the terms' changes over half a side.
Eigen::MatrixXd KnownCombinations(const Eigen::MatrixXd& terms, const Eigen::MatrixXd& within) {
  const Eigen::Index num_terms = terms.cols();
  Eigen::MatrixXd known(num_terms, 0);
  const auto add = [&](Eigen::Index first, Eigen::Index count) {
    Eigen::MatrixXd candidates =
        Eigen::MatrixXd::Identity(num_terms, num_terms).middleCols(first, count);
    candidates -= known * ((terms * known).transpose() * (terms * candidates));
    const Eigen::MatrixXd values = terms * candidates;
    Eigen::MatrixXd changes = candidates.transpose() * within * candidates;
    changes.diagonal().array() += 1e-9 * changes.trace();  // of markers on a line, some are zero
    const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        values.transpose() * values, changes);
    for (Eigen::Index i = 0; i < count; ++i) {
      const double ratio = eigen.eigenvalues()[i];
      if (!(ratio > 1.0)) continue;
      known.conservativeResize(Eigen::NoChange, known.cols() + 1);
      known.rightCols<1>() = candidates * eigen.eigenvectors().col(i) / std::sqrt(ratio);
    }
  };
  add(0, kNumLinearTerms);
  add(kNumLinearTerms, num_terms - kNumLinearTerms);
  return known;
}

}  // namespace

MotionField::MotionField(const std::vector<PlacedMotion>& motions, double side_px) {
  const auto num = static_cast<Eigen::Index>(motions.size());
  Eigen::VectorXd shares(num);  // of the sum of the weights
  for (Eigen::Index i = 0; i < num; ++i) shares[i] = motions[static_cast<std::size_t>(i)].weight;
  shares /= shares.sum();
  for (Eigen::Index i = 0; i < num; ++i) {
    const PlacedMotion& known = motions[static_cast<std::size_t>(i)];
    center_px_ += shares[i] * known.x_in_image_px;
    mean_ += shares[i] * known.motion;
  }
  double variance_px2 = 0.0;
  for (Eigen::Index i = 0; i < num; ++i) {
    const PlacedMotion& known = motions[static_cast<std::size_t>(i)];
    variance_px2 += shares[i] * (known.x_in_image_px - center_px_).squaredNorm();
  }
  unit_px_ = std::max(side_px, std::sqrt(variance_px2));
  Eigen::MatrixXd terms(num, kNumTerms), values(num, MotionVector::RowsAtCompileTime);
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(kNumTerms, kNumTerms);
  for (Eigen::Index i = 0; i < num; ++i) {
    const PlacedMotion& known = motions[static_cast<std::size_t>(i)];
    const Eigen::Vector2d place = PlaceOf(known.x_in_image_px);
    terms.row(i) = TermsAt(place);
    values.row(i) = (known.motion - mean_).transpose();
    const Eigen::MatrixXd change = 0.5 * side_px / unit_px_ * TermGradients(place);
    within += shares[i] * change.transpose() * change;
  }
  mean_terms_ = shares.transpose() * terms;
  terms.rowwise() -= mean_terms_;
  const Eigen::VectorXd root_shares = shares.cwiseSqrt();
  terms = root_shares.asDiagonal() * terms;
  values = root_shares.asDiagonal() * values;
  const Eigen::MatrixXd known = KnownCombinations(terms, within);
  coefficients_ = known * ((terms * known).transpose() * values);
}

Eigen::Vector2d MotionField::PlaceOf(const Eigen::Vector2d& x_in_image_px) const {
  return (x_in_image_px - center_px_) / unit_px_;
}

MotionVector MotionField::At(const Eigen::Vector2d& x_in_image_px) const {
  const Terms terms = TermsAt(PlaceOf(x_in_image_px)) - mean_terms_;
  return mean_ + (terms * coefficients_).transpose();
}

}  // namespace velamap
