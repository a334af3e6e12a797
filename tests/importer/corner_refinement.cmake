velamap_test(
  NAME corner_refinement_test
  LABEL unit
  SOURCES
    refine/corner_refinement_test.cc
    refine/side_shift_test.cc
    bend/pattern_bend_test.cc
    pattern/wide_blur_test.cc
    refine/read_again_test.cc
    refine/edge_fit_test.cc
    refine/edge_sampling_test.cc
    formation/formation_estimation_test.cc
    formation/sample_bend_test.cc
    formation/formation_sampling_test.cc
    formation/formation_scenes.cc
    formation/printed_ink_test.cc
    formation/processed_pictures_test.cc
    lanes/float_lanes_test.cc
    lanes/normal_lanes_test.cc
    pattern/fit_equations_test.cc
    pattern/image_formation_test.cc
    lighting/lighting_test.cc
    pattern/lighting_fit_test.cc
    pattern/pattern_picture_test.cc
    detect/interpolate_test.cc
    detect/marker_alignment_test.cc
    refine/marker_grid.cc
    ../support/render/marker_renderer_test.cc
    ../support/render/picture_effects_test.cc
    ../support/study/photographed_grid.cc
  LIBRARIES velamap_clip_support)
