#include "importer/refine/response_estimation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <Eigen/Cholesky>

namespace velamap {
namespace {

using Vector = Eigen::Matrix<double, 5, 1>;
using Matrix = Eigen::Matrix<double, 5, 5>;

// log gamma, S, sharpening, log radius, spread
CameraResponse ResponseOf(const Vector& p, bool is_inverted) {
  return {std::exp(p[0]), p[1], p[2], std::exp(p[3]), is_inverted};
}

const Vector kMean = (Vector() << std::log(1.6), 0.0, 0.1, std::log(1.0), 0.0).finished();
const Vector kSigma = (Vector() << 0.6, 0.05, 0.5, 0.3, 0.004).finished();
const Vector kStep = (Vector() << 0.02, 0.004, 0.02, 0.04, 0.0004).finished();

Vector Limited(Vector p) {
  p[0] = std::clamp(p[0], std::log(0.8), std::log(3.2));
  p[1] = std::clamp(p[1], -0.05, 0.13);
  p[2] = std::clamp(p[2], -0.3, 2.0);
  p[3] = std::clamp(p[3], std::log(0.5), std::log(2.5));
  p[4] = std::clamp(p[4], -0.02, 0.02);
  return p;
}

using Samples = std::vector<PatternSample>;
using AllResiduals = std::vector<std::vector<float>>;  // by sample; empty: the fit failed

AllResiduals RefitAll(const Vector& p, bool is_inverted, Samples* samples) {
  const CameraResponse response = ResponseOf(p, is_inverted);
  const ResponseModel model = MakeResponseModel(response, p[4]);
  AllResiduals all;
  for (PatternSample& sample : *samples) {
    all.push_back(sample.Refit(model) ? sample.Residuals(response) : std::vector<float>{});
  }
  return all;
}

Samples Copy(const Samples& samples) {
  Samples copy;
  for (const PatternSample& sample : samples) copy.push_back(sample.Clone());
  return copy;
}

double Noise(const AllResiduals& all) {
  std::vector<float> sizes;
  for (const auto& residuals : all) {
    for (const float r : residuals) sizes.push_back(std::abs(r));
  }
  if (sizes.size() < 100) return 0.0;
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return std::max(0.5, 1.4826 * static_cast<double>(*middle));
}

double Cost(const AllResiduals& all, const Samples& samples, const Vector& p, double noise,
            double scale) {
  double cost = noise * noise * (p - kMean).cwiseQuotient(kSigma).squaredNorm();
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].empty()) cost += samples[i].NumPixels() * scale * scale * std::log1p(36.0);
    for (const double r : all[i]) cost += scale * scale * std::log1p(r * r / (scale * scale));
  }
  return cost;
}

struct Course {
  bool is_inverted = false;
  Vector p;
  Samples samples;
  AllResiduals residuals;
  double noise = 0.0;
  Vector sigma = Vector::Zero();
  int num_iterations = 0;
};

void Descend(int max_iterations, Course* course) {
  double damping = 1e-3;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    ++course->num_iterations;
    course->noise = Noise(course->residuals);
    if (course->noise == 0) return;
    const double noise = course->noise, scale = 3 * noise;
    const double cost = Cost(course->residuals, course->samples, course->p, noise, scale);
    std::vector<AllResiduals> moved;
    for (int k = 0; k < 5; ++k) {
      Vector q = course->p;
      q[k] += kStep[k];
      Samples copy = Copy(course->samples);
      moved.push_back(RefitAll(q, course->is_inverted, &copy));
    }
    const Vector weight = (noise * kSigma.cwiseInverse()).cwiseAbs2();
    Matrix hessian = weight.asDiagonal();
    Vector gradient = weight.cwiseProduct(course->p - kMean);
    for (std::size_t i = 0; i < course->residuals.size(); ++i) {
      const std::vector<float>& current = course->residuals[i];
      bool is_whole = !current.empty();
      for (const auto& one : moved) is_whole = is_whole && one[i].size() == current.size();
      if (!is_whole) continue;
      for (std::size_t j = 0; j < current.size(); ++j) {
        const double r = current[j];
        Vector jacobian;
        for (int k = 0; k < 5; ++k) {
          jacobian[k] = (moved[static_cast<std::size_t>(k)][i][j] - r) / kStep[k];
        }
        const double robust = 1 / (1 + r * r / (scale * scale));
        hessian.noalias() += robust * jacobian * jacobian.transpose();
        gradient += robust * r * jacobian;
      }
    }
    course->sigma =
        noise * hessian.ldlt().solve(Matrix::Identity()).diagonal().cwiseMax(0).cwiseSqrt();
    double change = 0.0;
    for (int attempt = 0; attempt < 4 && change == 0; ++attempt) {
      Matrix damped = hessian;
      damped.diagonal() *= 1 + damping;
      const Vector q = Limited(course->p - damped.ldlt().solve(gradient));
      Samples candidate = Copy(course->samples);
      AllResiduals residuals = RefitAll(q, course->is_inverted, &candidate);
      const double candidate_cost = Cost(residuals, candidate, q, noise, scale);
      if (candidate_cost < cost) {
        change = (cost - candidate_cost) / cost;
        course->p = q;
        course->samples = std::move(candidate);
        course->residuals = std::move(residuals);
        damping *= 0.2;
      } else {
        damping = std::max(damping * 10, 0.1);
      }
    }
    if (change < 2e-4) return;
  }
}

}  // namespace

ResponseModel MakeResponseModel(const CameraResponse& response, double spread_sides) {
  ResponseModel model;
  model.tone = ToneCurve(response);
  model.unsharpening = UnsharpeningKernel(response);
  model.spread_sides = spread_sides;
  return model;
}

ResponseEstimate EstimateResponse(const std::vector<ResponseSample>& samples, bool is_inverted) {
  std::optional<Course> best;
  double best_noise = std::numeric_limits<double>::max();
  for (const double gamma : {1.0, 1.5, 2.2}) {
    Course course;
    course.is_inverted = is_inverted;
    course.p = kMean;
    course.p[0] = std::log(gamma);
    course.p[2] = 0.1;
    const ResponseModel model = MakeResponseModel(ResponseOf(course.p, is_inverted), 0.0);
    for (const ResponseSample& sample : samples) {
      auto made = PatternSample::Make(sample.gray, sample.corners_px, sample.cells, model);
      if (made) course.samples.push_back(std::move(*made));
    }
    course.residuals = RefitAll(course.p, is_inverted, &course.samples);
    const double noise = Noise(course.residuals);
    if (noise > 0 && noise < best_noise) {
      best_noise = noise;
      best = std::move(course);
    }
  }
  ResponseEstimate estimate;
  if (!best) return estimate;
  Descend(12, &*best);
  estimate.response = ResponseOf(best->p, is_inverted);
  estimate.spread_sides = best->p[4];
  estimate.sigma = best->sigma;
  estimate.rms = best->noise;
  estimate.num_iterations = best->num_iterations;
  estimate.num_samples = static_cast<int>(best->samples.size());
  return estimate;
}

}  // namespace velamap
