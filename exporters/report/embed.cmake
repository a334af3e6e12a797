# Turns text files into a C++ source of string literals, which compile in no time.
#   cmake -DOUTPUT=assets.cc -DkReportPage=page.html -DkReportScript="a.js|b.js" ... -P embed.cmake
# Files of one variable are joined in order.

set(ASSETS kReportPage kReportStyle kReportScript kReportThree kReportChart kReportLicences)

file(WRITE ${OUTPUT}.tmp "#include \"exporters/report/report_assets.h\"\n\nnamespace velamap {\n")
foreach(asset IN LISTS ASSETS)
  file(APPEND ${OUTPUT}.tmp "\nconst std::string_view ${asset} =")
  string(REPLACE "|" ";" files "${${asset}}")
  foreach(file IN LISTS files)
    file(READ "${file}" text)
    string(FIND "${text}" ")velamap\"" delimiter)
    if("${text}" STREQUAL "" OR NOT delimiter EQUAL -1)
      message(FATAL_ERROR "${file}: empty, or holds the delimiter of the string literals")
    endif()
    # Scripts stand inside a script element, which this would end.
    string(FIND "${text}" "</script" end_of_script)
    if("${file}" MATCHES "\\.js$" AND NOT end_of_script EQUAL -1)
      message(FATAL_ERROR "${file}: holds </script and cannot stand inside a page")
    endif()
    file(APPEND ${OUTPUT}.tmp "\n    R\"velamap(${text}\n)velamap\"")
  endforeach()
  file(APPEND ${OUTPUT}.tmp ";\n")
endforeach()
file(APPEND ${OUTPUT}.tmp "\n}  // namespace velamap\n")
file(RENAME ${OUTPUT}.tmp ${OUTPUT})
