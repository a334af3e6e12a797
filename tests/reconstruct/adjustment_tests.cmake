# The marker-aware bundle adjustment.
velamap_test(NAME reconstruct_adjustment_test LABEL unit
  SOURCES
    model/adjustment_uncertainty_test.cc
    geometry/camera_conversion_test.cc
    geometry/covariance_update_test.cc
    adjust/calibration_score_test.cc
    geometry/intrinsics_prior_test.cc
    adjust/calibration_refinement_test.cc
    adjust/marker_adjustment_test.cc
    adjust/moving_marker_test.cc
    adjust/common_inset_test.cc
    adjust/rolling_shutter_test.cc
    problem/rolling_shutter_test.cc
    problem/marker_cost_functions_test.cc
    problem/marker_problem_test.cc
    sizes/few_markers_test.cc
    sizes/bend_evidence_test.cc
    sizes/bent_corners_test.cc
    sizes/curved_scene_test.cc
    sizes/marker_curvature_test.cc
    sizes/marker_sizes_test.cc
    sizes/part_sizes_test.cc
    sizes/runaway_markers_test.cc
    sizes/scale_bar_verdict_test.cc
    sizes/size_deviations_test.cc
    correlation/corner_correlation_test.cc
    correlation/error_correlation_test.cc
    problem/marker_uncertainty_test.cc
    problem/scale_bar_test.cc
    scene_model.cc
    solve/schur_complement_test.cc
    colmap/warm_start_test.cc
    sheet_model.cc
    model/weak_geometry_test.cc
  LIBRARIES Ceres::ceres
)
