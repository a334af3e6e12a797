# Models, their files, and COLMAP's program.
velamap_test(NAME reconstruct_model_test LABEL unit
  SOURCES
    colmap_runner_test.cc
    gauge_test.cc
    model_io_test.cc
    model_test.cc
    observation_filter_test.cc
    reprojection_test.cc
    sheet_model.cc
    statistics_test.cc
)

velamap_test(NAME reconstruct_colmap_test LABEL colmap
  SOURCES
    bundle_adjustment_failure_test.cc
    bundle_adjustment_test.cc
    model_colmap_test.cc
    sheet_model.cc
)
