# Models, their files, and COLMAP's program.
velamap_test(NAME reconstruct_model_test LABEL unit
  SOURCES
    colmap/colmap_runner_test.cc
    model/gauge_test.cc
    model/model_io_test.cc
    model/model_test.cc
    model/moved_views_test.cc
    colmap/observation_filter_test.cc
    model/reprojection_test.cc
    sheet_model.cc
)

velamap_test(NAME reconstruct_colmap_test LABEL colmap
  SOURCES
    colmap/bundle_adjustment_failure_test.cc
    colmap/bundle_adjustment_test.cc
    model/model_colmap_test.cc
    sheet_model.cc
)
