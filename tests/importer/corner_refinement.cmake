velamap_test(
  NAME corner_refinement_test
  LABEL unit
  SOURCES
    refine/corner_refinement_test.cc
    refine/least_squares_test.cc
    detect/marker_alignment_test.cc
    refine/marker_grid.cc
    ../support/marker_renderer_test.cc)
