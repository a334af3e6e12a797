# The marker-aware bundle adjustment.
velamap_test(NAME reconstruct_adjustment_test LABEL unit
  SOURCES
    adjustment_uncertainty_test.cc
    covariance_update_test.cc
    gram_matrix_test.cc
    marker_adjustment_test.cc
    marker_cost_functions_test.cc
    marker_uncertainty_test.cc
    scene_model.cc
    schur_solver_test.cc
    warm_start_test.cc
    sheet_model.cc
    weak_geometry_test.cc
  LIBRARIES Ceres::ceres
)
