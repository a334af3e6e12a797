# The pages in headless Chromium; skipped where there is none.
velamap_test(NAME report_browser_test LABEL browser SHARDS 1
  SOURCES
    ../exporters/report/report_example.cc
    interop/browser.cc
    interop/report_browser_test.cc
    run_velamap.cc
  LIBRARIES ${OpenCV_LIBS}
)
velamap_test(NAME comparison_browser_test LABEL browser SHARDS 1
  SOURCES
    ../exporters/compare/example_comparison.cc
    interop/browser.cc
    interop/comparison_browser_test.cc
    run_velamap.cc
  LIBRARIES velamap_comparison ${OpenCV_LIBS}
)
# Pictures of the pages stay here for whoever wants to look.
foreach(test report_browser_test comparison_browser_test)
  target_compile_definitions(${test} PRIVATE
    VELAMAP_PROGRAM="$<TARGET_FILE:velamap>"
    VELAMAP_INTEROP_DIR="${CMAKE_CURRENT_SOURCE_DIR}/interop"
    VELAMAP_PICTURE_DIR="${CMAKE_CURRENT_BINARY_DIR}/pictures")
endforeach()
