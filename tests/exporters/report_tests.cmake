# The report without a browser (tests/workflows/report_browser.cmake has one).
velamap_test(NAME report_test LABEL unit
  SOURCES
    calibration/calibration_page_test.cc
    report/report_data_test.cc
    report/report_example.cc
    report/report_histogram_test.cc
    report/report_key_numbers_test.cc
    report/report_picture_test.cc
    report/report_sail_test.cc
    report/report_writer_test.cc
    report/verdict_test.cc
  LIBRARIES nlohmann_json::nlohmann_json
)
