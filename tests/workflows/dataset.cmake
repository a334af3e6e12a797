# dataset.table runs workflows/dataset over a few inputs cut from sample_project, dataset.slurm the same
# workflow on a Slurm of one node, and workflows.run_batch the script for a few clips.
if(BASH_PROGRAM)
  foreach(test table slurm)
    add_test(NAME dataset.${test}
             COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/dataset/${test}_test.sh
                     ${PROJECT_SOURCE_DIR})
  endforeach()
  add_test(NAME workflows.run_batch
           COMMAND ${BASH_PROGRAM} ${CMAKE_CURRENT_SOURCE_DIR}/run_batch_test.sh ${PROJECT_SOURCE_DIR})
  set_tests_properties(dataset.table dataset.slurm workflows.run_batch PROPERTIES
    LABELS colmap COST 50 SKIP_RETURN_CODE 77 TIMEOUT 600 ENVIRONMENT "VELAMAP=$<TARGET_FILE:velamap>")
endif()
