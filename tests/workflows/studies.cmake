# The studies of thesis chapter 4, the shortest of them: two reconstructions of a small rendered
# clip have to give a table whose figures are those of a good reconstruction.
find_program(BASH_PROGRAM bash)
if(BASH_PROGRAM)
  add_test(NAME studies.parameters
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/studies_test.sh
                   ${PROJECT_SOURCE_DIR}/workflows/studies)
  set_tests_properties(studies.parameters PROPERTIES
    LABELS colmap
    SKIP_RETURN_CODE 77
    TIMEOUT 200
    ENVIRONMENT "VELAMAP=$<TARGET_FILE:velamap>;RENDER_CLIP=$<TARGET_FILE:render_clip>")
endif()
