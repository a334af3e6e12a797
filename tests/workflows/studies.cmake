# studies.parameters runs the shortest study of thesis chapter 4: two reconstructions of a small rendered
# clip have to give a table whose figures are those of a good reconstruction. studies.camera_draws runs
# three draws of random cameras. studies.readmes holds the measured numbers in the READMEs to the stored
# results of the studies.
if(BASH_PROGRAM)
  add_test(NAME studies.parameters
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/studies_test.sh
                   ${PROJECT_SOURCE_DIR}/workflows/studies)
  add_test(NAME studies.camera_draws
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/camera_draws_test.sh
                   ${PROJECT_SOURCE_DIR}/workflows/studies)
  set_tests_properties(studies.parameters studies.camera_draws PROPERTIES
    LABELS colmap
    SKIP_RETURN_CODE 77
    TIMEOUT 200
    ENVIRONMENT "VELAMAP=$<TARGET_FILE:velamap>;RENDER_CLIP=$<TARGET_FILE:render_clip>;CLIP_CORNERS=$<TARGET_FILE:clip_corners>")
  add_test(NAME studies.readmes
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/readmes_test.sh ${PROJECT_SOURCE_DIR})
  set_tests_properties(studies.readmes PROPERTIES LABELS unit TIMEOUT 300)
  add_test(NAME workflows.script_help
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/script_help_test.sh ${PROJECT_SOURCE_DIR})
  set_tests_properties(workflows.script_help PROPERTIES LABELS unit TIMEOUT 60)
endif()
