# shellcheck shell=bash
# The blocks of measured numbers in the READMEs, made from the stored results: block_NAME prints the
# text between <!-- numbers: NAME --> and <!-- end -->. Sourced by update_readmes.sh, whose stored()
# says where a result is kept.

# problem TEXT: blocks are made in subshells, from which only a file can tell of a problem.
problem() { echo "$*" >>"$temporary/problems"; }

# data RESULT: its rows without the line that names the command.
data() {
  if [[ ! -f "$(stored "$1")" ]]; then
    problem "$place: $(stored "$1") is missing; workflows/studies/update_readmes.sh $1 makes it"
    return
  fi
  sed 1d "$(stored "$1")"
}

# made_by RESULT: the command that made it, as code.
made_by() { printf '`%s`' "$(sed -n '1s/^# //p' "$(stored "$1")")"; }

# What the awk programs below share. num(x, format): x with as many significant digits as the format
# says, but no more than four decimals; "+2" shows the sign, "3%" gives percent of a fraction, "d" an
# integer; an unknown value is a dash. span(low, high, format): "0.1 to 0.3".
# shellcheck disable=SC2016
awk_library='
  function num(x, format,    digits, magnitude, exponent, decimals) {
    if (x == "") return "-"
    if (format == "d") return sprintf("%.0f", x)
    if (format ~ /%$/) x *= 100
    digits = format; gsub(/[+%]/, "", digits)
    magnitude = sprintf("%." (digits - 1) "e", x < 0 ? -x : x)
    exponent = magnitude; sub(/.*e/, "", exponent)
    decimals = digits - 1 - exponent
    if (decimals < 0) decimals = 0
    if (decimals > 4) decimals = 4
    return sprintf("%" (format ~ /^[+]/ ? "+" : "") "." decimals "f", x)
  }
  function span(low, high, format,    a, b) {
    a = num(low, format); b = num(high, format)
    return a == b ? a : a " to " b
  }
  function note(n, x) {  # least and most of x by name n
    if (x == "") return
    if (!(n in least) || x + 0 < least[n]) least[n] = x + 0
    if (!(n in most) || x + 0 > most[n]) most[n] = x + 0
  }
  FNR == 1 { for (i = 1; i <= NF; i++) column[$i] = i; next }'

# table RESULT AWK_PROGRAM: runs the program over the rows; $column["name"] is a cell of the row.
table() {
  # shellcheck disable=SC2016
  data "$1" | awk -F, "$awk_library"' function cell(name) {
    if (!(name in column)) { print "no column " name > "/dev/stderr"; exit 3 } return $column[name] }
    '"$2" || problem "$place: $1 has no such rows or columns"
}

# value RESULT COLUMN FORMAT KEY=VALUE...: cells of the rows in which these columns hold these values,
# with commas between them.
value() {
  # shellcheck disable=SC2016
  table "$1" '
    { for (k in wanted) if ($column[k] != wanted[k]) next
      row = row separator num(cell("'"$2"'"), "'"$3"'"); separator = ", " }
    BEGIN { n = split("'"${*:4}"'", pairs, " ")
            for (i = 1; i <= n; i++) { split(pairs[i], pair, "="); wanted[pair[1]] = pair[2] } }
    END { if (row == "") exit 3; printf "%s", row }'
}

# --- sample_project ---

block_sample_output() {
  echo '```'
  data sample_project.txt
  echo '```'
}

# sample OBJECT KEY FORMAT: a metric of a whole object.
sample() { value sample_project.csv value "$3" object="$1" table= key="$2"; }

# sample_span TABLE KEY FORMAT: least and most of the cube's rows.
sample_span() {
  table sample_project.csv '
    $1 == "cube" && $2 == "'"$1"'" && $4 == "'"$2"'" { note("x", $5) }
    END { printf "%s", span(least["x"], most["x"], "'"$3"'") }'
}

# cube_pairs: sets the angles of neighbouring faces and the distances of opposite ones.
cube_pairs() {
  table sample_project.csv '
    $1 == "cube" && $2 == "part_pairs" && $4 == "angle_deg" {
      if ($5 < 135) note("angle", $5); else note("tilt", 180 - $5)
      off = $5 < 135 ? ($5 > 90 ? $5 - 90 : 90 - $5) : 0
      note("off", off)
    }
    $1 == "cube" && $2 == "part_pairs" && $4 == "distance_mm" { note("distance", $5) }
    END {
      if ("'"$1"'" == "distances") printf "%s", span(least["distance"], most["distance"], 4)
      if ("'"$1"'" == "angles") printf "%s", span(least["angle"], most["angle"], 3)
      if ("'"$1"'" == "off") printf "%s", num(most["off"], 2)
      if ("'"$1"'" == "tilt") printf "%s", num(most["tilt"], 2)
    }'
}

# summary KEY: a line of the sample run's summary.
summary() { data sample_project.txt | sed -n "s/^$1: //p"; }

images_used() {
  data sample_project.csv | awk -F, -v object="$1" '$1 == object && $4 == "images_used" { printf "%s", $5 }'
}

block_cube() {
  cat <<ROWS
| figure | result | what is known |
|---|---|---|
| images used | $(images_used cube) | |
| markers reconstructed | $(sample cube num_markers d) of $(sample cube num_layout_markers d) | 297 are seen, most of the missing ones in one image only |
| mean reprojection error | $(sample cube reprojection_error_px_mean 2) px | |
| mean distance of a face's corners from their plane | $(sample_span parts corner_plane_error_mm_mean 2) mm | 0.03 mm |
| angle between neighbouring faces | $(cube_pairs angles) degrees | 90 within 0.6 |
| distance between opposite faces | $(cube_pairs distances) mm, parallel within $(cube_pairs tilt) degrees | 40.0 to 40.3 mm |
ROWS
}

block_stylus() {
  cat <<ROWS
| figure | result | what is known |
|---|---|---|
| images used | $(images_used stylus) | |
| markers reconstructed | $(sample stylus num_markers d) of $(sample stylus num_layout_markers d) | |
| mean reprojection error | $(sample stylus reprojection_error_px_mean 2) px | |
| RMS distance from the design | $(sample stylus distance_mm_rms 2) mm; $(sample stylus distance_after_scaling_mm_rms 2) mm after an alignment with scale | labels glued to 0.5 mm |
| scale error | $(sample stylus scale_error_percent +2) % | |
| mean error of the marker sides | $(sample stylus side_error_mm_mean 2) mm | |
ROWS
}

# --- accuracy.sh ---

# One line per data set of accuracy.sh: the rows of the cube's faces count as one.
# shellcheck disable=SC2016
accuracy_library='
  BEGIN {
    n = split("walls board sail_1080p sail_4k cube stylus board_video aprilgrid", clips, " ")
    title["walls"] = "rendered walls of 3 m, 1080p, 120 frames"
    title["board"] = "rendered board of 0.4 m, 720p, 120 frames"
    title["sail_1080p"] = "rendered sail of 3 x 6 m, 1080p, 400 frames"
    title["sail_4k"] = "rendered sail of 3 x 6 m, 4K, 400 frames"
    title["cube"] = "photographs of a 40 mm cube, each face"
    title["stylus"] = "photographs of a stylus"
    title["board_video"] = "video of a hand-held board"
    title["aprilgrid"] = "photographs of an AprilGrid"
  }
  { clip = $column["clip"]; sub(/_face[0-9]$/, "", clip); key = clip "," $column["way"]
    known[key]
    for (name in column) if (name != "clip" && name != "way") note(key "," name, $column[name]) }
  function of(clip, way, name, format,    k) {
    k = clip "," way "," name
    return (k in least) ? span(least[k], most[k], format) : "-"
  }'

block_accuracy_summary() {
  cat <<ROWS
| data | command | velamap | the thesis's method |
|---|---|---|---|
| 24 photographs of a 40 mm cube with 2.4 mm markers | \`workflows/sample.sh\` | opposite faces $(cube_pairs distances) mm apart (known: 40.0 to 40.3), neighbours at 90 degrees within $(cube_pairs off) | |
ROWS
  table accuracy.csv "$accuracy_library"'
    function result(clip, way) {
      return of(clip, way, "distance_mm_rms", 2) " mm RMS, scale " of(clip, way, "scale_error_percent", "+2") \
        " %, " of(clip, way, "num_markers", "d") " markers"
    }
    END {
      title["stylus"] = "16 photographs of a stylus with 8 markers of 12.6 mm"
      title["board_video"] = "57 frames of a hand-held board, 10 markers of 40 mm"
      title["sail_4k"] = "rendered 4K clip of a 3 x 6 m sail, 122 markers of 100 mm, exact truth"
      title["sail_1080p"] = "the same at 1080p, markers of 16 px"
      m = split("stylus board_video sail_4k sail_1080p", shown, " ")
      for (i = 1; i <= m; i++)
        printf "| %s | `workflows/studies/accuracy.sh` | %s | %s |\n", title[shown[i]],
          result(shown[i], "global_both"), result(shown[i], "thesis")
    }'
}

block_accuracy() {
  echo "| data | thesis | edge | global | both | to reach |"
  echo "|---|---|---|---|---|---|"
  table accuracy.csv "$accuracy_library"'
    function result(clip, way,    text) {
      if (!((clip "," way) in known)) return "-"
      text = of(clip, way, "scale_error_percent", "+2") " % / " of(clip, way, "distance_mm_rms", 2) " / " \
        of(clip, way, "distance_after_scaling_mm_rms", 2)
      if (clip ~ /^sail/) text = text ", " of(clip, way, "num_markers", "d") " markers"
      return text
    }
    END {
      goal["walls"] = "0.05 % / 0.6"; goal["board"] = "0.03 % / 0.04"; goal["sail_1080p"] = "0.3 % / 5"
      goal["sail_4k"] = "0.1 % / 2"; goal["cube"] = "0.5 %"; goal["aprilgrid"] = "0.1 %"
      for (i = 1; i <= n; i++)
        printf "| %s | %s | %s | %s | %s | %s |\n", title[clips[i]], result(clips[i], "thesis"),
          result(clips[i], "edge"), result(clips[i], "global"), result(clips[i], "global_both"),
          clips[i] in goal ? goal[clips[i]] : "-"
    }'
}

block_sigmas() {
  echo "| data | scale error, its sigma | shape: RMS, predicted | RMS / predicted | correlation factor | corners left out; above 4 sigma left in |"
  echo "|---|---|---|---|---|---|"
  table accuracy.csv "$accuracy_library"'
    $column["way"] == "global_both" && $column["distance_after_scaling_sigma_mm"] > 0 {
      note(key ",ratio", $column["distance_after_scaling_mm_rms"] / $column["distance_after_scaling_sigma_mm"]) }
    END {
      way = "global_both"
      for (i = 1; i <= n; i++) {
        clip = clips[i]
        printf "| %s | %s, %s %% | %s, %s mm | %s | %s | %s %%; %s %% |\n", title[clip],
          of(clip, way, "scale_error_percent", "+2"), of(clip, way, "scale_sigma_percent", 2),
          of(clip, way, "distance_after_scaling_mm_rms", 2),
          of(clip, way, "distance_after_scaling_sigma_mm", 2), of(clip, way, "ratio", 2),
          of(clip, way, "correlation_factor", 3), of(clip, way, "outliers_percent", 2),
          of(clip, way, "corners_above_4_sigma_percent", 1)
      }
    }'
}

block_repeatability() {
  echo "| object | difference of the two shapes, mm | predicted, mm | difference / predicted |"
  echo "|---|---|---|---|"
  table repeatability.csv '
    { printf "| %s | %s | %s | %s |\n", cell("object"), num(cell("difference_mm"), 2),
        num(cell("predicted_mm"), 2), num(cell("ratio"), 2) }'
}

# --- the studies of thesis chapter 4 ---

# by PARAMETER COLUMN FORMAT: the values of parameters.sh as one of n, s, m varies.
by() { value parameters.csv "$2" "$3" parameter="$1"; }

# under CONDITION COLUMN FORMAT, and the four figures that most rows show.
under() { value conditions.csv "$2" "$3" condition="$1"; }
condition() {
  echo "ratio $(under "$1" reconstruction_ratio 3%) %, area error $(under "$1" area_error_mm2_mean 2) /" \
    "$(under "$1" area_error_mm2_max d) mm², central reprojection error" \
    "$(under "$1" central_reprojection_error_px_mean 2) px"
}
condition_truth() {
  echo "RMS $(under "$1" distance_mm_rms 2) mm, scale $(under "$1" scale_error_percent +2) %"
}

block_thesis_sail() {
  local base=(parameter=n n=20 s=10 m=5)
  cat <<ROWS
| what | thesis | ours | truth of ours | command |
|---|---|---|---|---|
| area error, n 20, s 10, m 5, mean / max | about 250 / 1000 mm² | $(value parameters.csv area_error_mm2_mean 2 "${base[@]}") / $(value parameters.csv area_error_mm2_max d "${base[@]}") mm² | scale $(value parameters.csv scale_error_percent +2 "${base[@]}") %, RMS $(value parameters.csv distance_mm_rms 2 "${base[@]}") mm, shape $(value parameters.csv distance_after_scaling_mm_rms 2 "${base[@]}") mm | \`parameters.sh\` |
| area error against the number of frames | falls to 41 frames, then level | $(by n area_error_mm2_mean 2) mm² for $(by n value d) frames | RMS $(by n distance_mm_rms 2) mm, shape $(by n distance_after_scaling_mm_rms 2) mm | \`parameters.sh\` |
| reprojection error against the number of frames | rises slightly, max about 2 px | $(by n central_reprojection_error_px_mean 2) px in the mean | | \`parameters.sh\` |
| ratio against the number of frames | 56.9 % (11) to 40.1 % (101 frames) | $(by n reconstruction_ratio 3%) % | | \`parameters.sh\` |
| area error against s | poor for small s | $(by s area_error_mm2_mean 2) mm² for s $(by s value d) | RMS $(by s distance_mm_rms 2) mm | \`parameters.sh\` |
| ratio against s | falls | $(by s reconstruction_ratio 3%) % | | \`parameters.sh\` |
| area error against m | 5 chosen | $(by m area_error_mm2_mean 2) mm² for m $(by m value d), ratio $(by m reconstruction_ratio 3%) % | RMS $(by m distance_mm_rms 2) mm | \`parameters.sh\` |
| areas of the markers | most near the printed one | $(table central_frames_histogram.csv '$column["area_mm2"] > 9900 && $column["area_mm2"] < 10100 { sum += $column["share_of_all_percent"] } END { printf "%s", num(sum, 2) }') % within 1 % of the printed area | | \`central_frames.sh\` |
| ratio by central frame | about 70 %, less when farther | $(table central_frames.csv '{ note("x", $column["reconstruction_ratio"]) } END { printf "%s", span(least["x"], most["x"], "3%") }') % | | \`central_frames.sh\` |
| rigid sail, near | | $(condition near) | $(condition_truth near) | \`conditions.sh\` |
| change of wind, 200 mm halfway | larger errors, ratio 85 % | $(condition wind_against_before) | RMS $(under wind_against_before distance_mm_rms 2) mm to the shape before, $(under wind_against_after distance_mm_rms 2) mm to that after | \`conditions.sh\` |
| weak reflection | fewer markers, as good | $(condition weak_reflection) | $(condition_truth weak_reflection) | \`conditions.sh\` |
| strong reflection | fewer markers, as good | $(condition strong_reflection) | $(condition_truth strong_reflection) | \`conditions.sh\` |
| bad angle, 60 degrees | few markers, right | $(condition bad_angle) | $(condition_truth bad_angle) over the $(under bad_angle num_markers d) markers | \`conditions.sh\` |
| too far, 12 m | ratio 0 or below 10 % | $(if [[ "$(under far num_markers d)" == - ]]; then echo "no result"; else condition far; fi) | | \`conditions.sh\` |
| flapping of 30 mm | | $(condition flapping) | $(condition_truth flapping) to the mean shape | \`conditions.sh\` |
| motion against the hull in 0.5 s, lines from foot to top | mainly at the top | $(motion flapping_long_mm) mm; on the rigid sail, which does not move, $(motion rigid_long_mm) mm | | \`conditions.sh\` |
| the same with a short search, n 5, s 2 | | $(motion flapping_short_mm) mm; on the rigid sail $(motion rigid_short_mm) mm | no point moves by more than 60 mm | \`conditions.sh\` |
ROWS
}

# motion COLUMN: by line, those without a marker left out.
motion() {
  table conditions_motion_lines.csv '
    $column["line"] != "hull" && cell("'"$1"'") != "" {
      printf "%s%s", separator, num(cell("'"$1"'"), 2); separator = ", " }'
}

block_rigid_objects() {
  echo "| object | thesis | plane error | distance error | scale | RMS | markers |"
  echo "|---|---|---|---|---|---|---|"
  table rigid_objects.csv '
    BEGIN {
      n = split("glass_3m glass_5m glass_7m glass_5m_narrow glass_7m_narrow walls", objects, " ")
      title["glass_3m"] = "glass, 3 m, wide lens"; title["glass_5m"] = "glass, 5 m, wide lens"
      title["glass_7m"] = "glass, 7 m, wide lens"; title["glass_5m_narrow"] = "glass, 5 m, 68 degrees"
      title["glass_7m_narrow"] = "glass, 7 m, 68 degrees"; title["walls"] = "walls"
    }
    cell("step") == "adjusted" {
      for (name in column) of[cell("object"), name] = $column[name]
    }
    END {
      for (i = 1; i <= n; i++) {
        o = objects[i]
        printf "| %s | %s | ", title[o], o == "walls" ? "plane < 0.5 mm, angle < 0.5 degrees off" : "plane < 0.5 mm, distance < 1 mm"
        if (of[o, "num_markers"] == "") { print "no result | | | | |"; continue }
        printf "%s / %s mm | %s / %s mm | %s %% | %s mm%s | %s |\n",
          num(of[o, "plane_error_mm_mean"], 2), num(of[o, "plane_error_mm_max"], 2),
          num(of[o, "distance_error_mm_mean"], 2), num(of[o, "distance_error_mm_max"], 2),
          num(of[o, "scale_error_percent"], "+2"), num(of[o, "rms_to_truth_mm"], 2),
          of[o, "angle_deg"] != "" ? "; angle " num(of[o, "angle_deg"], 6) " degrees" : "",
          num(of[o, "num_markers"], "d")
      }
    }'
}

block_board_motions() {
  echo "| motion | distance, mm | plane, mm | normal, degrees | tangent, degrees | scale, % | RMS to the truth, mm |"
  echo "|---|---|---|---|---|---|---|"
  table board_motions.csv '
    {
      order[++num_rows] = cell("motion")
      for (name in column) of[cell("motion"), cell("step"), name] = $column[name]
    }
    function both(motion, name, format) {
      return num(of[motion, "detection", name], format) ", " num(of[motion, "adjusted", name], format)
    }
    END {
      for (i = 1; i <= num_rows; i += 2) {
        m = order[i]
        printf "| %s | %s | %s | %s | %s | %s | %s |\n", m, both(m, "distance_error_mm", 2),
          both(m, "plane_error_mm", 2), both(m, "normal_error_deg", 2), both(m, "tangent_error_deg", 2),
          both(m, "scale_error_percent", "+2"), both(m, "rms_to_truth_mm", 2)
      }
    }'
}

# --- tests/benchmarks ---

# What the programs below share: rows of repeated runs by the columns that name them, in order.
# shellcheck disable=SC2016
repeats_library='
  function repeat_of(name) { if (!(name in seen)) { seen[name]; order[++num_rows] = name } return name }
  function seconds(row, name) { return span(least[row, name], most[row, name], 3) }
  function ratio(row, a, b, format) {
    return least[row, b] > 0 ? num(least[row, a] / least[row, b], format) : "-" }
  function clip_title() { return cell("kind") ", " cell("width_px") " px, " cell("num_frames") " frames" }'

block_import_speed() {
  echo "| clip | velamap: CPU s, markers | OpenCV's loop: CPU s, markers | decoding alone: CPU s |"
  echo "|---|---|---|---|"
  table detection.csv "$repeats_library"'
    { row = repeat_of(clip_title()); for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]
        printf "| %s | %s, %d | %s, %d | %s |\n", row, num(least[row, "velamap_cpu_s"], 3),
          least[row, "velamap_markers"], num(least[row, "opencv_cpu_s"], 3), least[row, "opencv_markers"],
          num(least[row, "decoding_cpu_s"], 3)
      }
    }'
}

block_detection() {
  echo "Made by $(made_by detection.csv); least and most of the runs, ratios of the least:"
  echo
  echo "| clip | velamap, CPU s | markers | OpenCV's loop, CPU s | markers | decoding, CPU s | OpenCV / velamap | decoding / velamap |"
  echo "|---|---|---|---|---|---|---|---|"
  table detection.csv "$repeats_library"'
    { row = repeat_of(clip_title()); for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]
        printf "| %s | %s | %d | %s | %d | %s | %s | %s |\n", row, seconds(row, "velamap_cpu_s"),
          least[row, "velamap_markers"], seconds(row, "opencv_cpu_s"), least[row, "opencv_markers"],
          seconds(row, "decoding_cpu_s"), ratio(row, "opencv_cpu_s", "velamap_cpu_s", 2),
          ratio(row, "decoding_cpu_s", "velamap_cpu_s", 2)
      }
    }'
}

block_adjustment() {
  echo "Made by $(made_by adjustment.csv); least and most of the runs, ratios of the least:"
  echo
  echo "| frames | markers | registration and adjustment, CPU s | COLMAP's adjustment, CPU s | velamap / COLMAP |"
  echo "|---|---|---|---|---|"
  table adjustment.csv "$repeats_library"'
    { row = repeat_of(cell("num_frames") " | " cell("num_markers"))
      for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]
        printf "| %s | %s | %s | %s |\n", row, seconds(row, "velamap_cpu_s"), seconds(row, "colmap_cpu_s"),
          ratio(row, "velamap_cpu_s", "colmap_cpu_s", 2)
      }
    }'
}

block_main() {
  echo "Made by $(made_by main.csv); least and most of the runs, the ratio of the least:"
  echo
  echo "| clip | automatic_reconstructor, CPU s | decoding, CPU s | ratio | import | register | adjust | export | report |"
  echo "|---|---|---|---|---|---|---|---|---|"
  table main.csv "$repeats_library"'
    { row = repeat_of(cell("width_px") " px, " cell("num_frames") " frames")
      for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]
        printf "| %s | %s | %s | %s |", row, seconds(row, "automatic_reconstructor_cpu_s"),
          seconds(row, "decoding_cpu_s"), ratio(row, "automatic_reconstructor_cpu_s", "decoding_cpu_s", 3)
        m = split("import register adjust export report", stages, " ")
        for (k = 1; k <= m; k++) printf " %s |", num(least[row, stages[k] "_cpu_s"], 2)
        print ""
      }
    }'
}

block_memory() {
  echo "Made by $(made_by memory.csv):"
  echo
  echo "| clip | peak memory, MB |"
  echo "|---|---|"
  table memory.csv '
    { printf "| %s px, %s frames | %s |\n", cell("width_px"), cell("num_frames"), cell("peak_memory_mb") }'
}

block_growth() {
  echo "Made by $(made_by growth.csv); least and most of the runs, the ratio of the least:"
  echo
  echo "| clip | CPU s | CPU s with twice the frames | ratio |"
  echo "|---|---|---|---|"
  table growth.csv "$repeats_library"'
    { row = repeat_of(cell("width_px") " px, " cell("num_frames") " frames")
      for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++)
        printf "| %s | %s | %s | %s |\n", order[i], seconds(order[i], "cpu_s"),
          seconds(order[i], "cpu_s_of_twice_the_frames"),
          ratio(order[i], "cpu_s_of_twice_the_frames", "cpu_s", 3)
    }'
}

block_markers() {
  echo "Made by $(made_by markers.csv):"
  echo
  echo "| markers | detection in one 4K frame, ms | registration and adjustment of 41 frames, ms |"
  echo "|---|---|---|"
  table markers.csv '
    { printf "| %s | %s | %s |\n", cell("num_markers"), cell("detection_ms"),
        cell("registration_and_adjustment_ms") }'
}

block_tracking() {
  echo "Made by $(made_by tracking.csv):"
  echo
  echo "| clip | search | markers | found again | same corners to 0.01 px | search, ms a frame |"
  echo "|---|---|---|---|---|---|"
  table tracking.csv "$repeats_library"'
    function percent(x) { return x == "" ? "" : sprintf("%.2f %%", x) }
    { search = cell("search"); sub(/prior_shape/, "tracked, with prior shape", search)
      printf "| %s | %s | %s | %s | %s | %s |\n", search == "exhaustive" ? clip_title() : "", search,
        cell("markers"), percent(cell("found_again_percent")), percent(cell("same_corners_percent")),
        cell("search_ms") }'
}

block_sweep() {
  echo "Made by $(made_by sweep.csv); least and most of the runs:"
  echo
  echo "| clip | central frames | single runs, CPU s | sweep with cold starts, CPU s | sweep, CPU s |"
  echo "|---|---|---|---|---|"
  table sweep.csv "$repeats_library"'
    { row = repeat_of(cell("width_px") " px, " cell("num_frames") " frames | " cell("num_central_frames"))
      for (name in column) note(row SUBSEP name, $column[name]) }
    END {
      for (i = 1; i <= num_rows; i++)
        printf "| %s | %s | %s | %s |\n", order[i], seconds(order[i], "single_runs_cpu_s"),
          seconds(order[i], "sweep_with_cold_starts_cpu_s"), seconds(order[i], "sweep_cpu_s")
    }'
}

# corner_table CONDITION: the rows of corner_accuracy.csv for which the awk condition holds.
corner_table() {
  echo "| side px | $1 | side bias px | std px | bound px | error / sigma | SUBPIX: side bias px | std px |"
  echo "|---|---|---|---|---|---|---|---|"
  table corner_accuracy.csv '
    function trial() {
      if ($column["noise"] != 2) return "noise " $column["noise"]
      if ($column["jpeg_quality"] != "-") return "JPEG quality " $column["jpeg_quality"]
      if ($column["bend_deg"] != 0) return "bent by " $column["bend_deg"] " degrees"
      if ($column["tilt_deg"] != "0-50") return "tilt " $column["tilt_deg"] " degrees"
      return ""
    }
    '"$2"' {
      printf "| %s | %s | %+.4f ± %.4f | %.4f | %.4f | %.2f | %+.3f | %.3f |\n", cell("side_px"), '"$3"',
        cell("side_bias_px"), cell("side_bias_sigma_px"), cell("std_px"), cell("bound_px"),
        cell("error_over_sigma"), cell("subpix_side_bias_px"), cell("subpix_std_px")
    }'
}

block_corner_accuracy() {
  # shellcheck disable=SC2016
  corner_table "blur px" 'trial() == "" && $column["side_px"] ~ /^(12|16|25|35|80|200)$/' 'sprintf("%.1f", cell("blur_px"))'
}

block_corner_trials() { corner_table "trial" 'trial() != ""' 'trial()'; }
