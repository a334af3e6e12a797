velamap_test(
  NAME corner_refinement_test
  LABEL unit
  SOURCES
    corner_refinement_test.cc
    least_squares_test.cc
    marker_alignment_test.cc
    marker_grid.cc
    marker_renderer_test.cc)
