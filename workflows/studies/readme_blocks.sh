# shellcheck shell=bash
# Makes the blocks of numbers that the studies measure. block_NAME prints the text between
# <!-- numbers: NAME --> and <!-- end -->. Sourced by update_readmes.sh after readme_tables.sh.
# shellcheck disable=SC2016  # awk programs are in single quotes

# --- sample_project ---

block_sample_output() {
  echo '```'
  data sample_project.txt |
    grep -vE '^(==|look at:|in COLMAP:|distance_(after|sigma))'
  echo '```'
}

# sample OBJECT KEY FORMAT: prints a metric of a whole object.
sample() { value sample_project.csv value "$3" object="$1" table= key="$2"; }

# sample_span TABLE KEY FORMAT: prints the smallest and the largest value of the rows of the cube.
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

images_used() {
  data sample_project.csv | awk -F, -v object="$1" '$1 == object && $4 == "images_used" { printf "%s", $5 }'
}

block_sail() {
  cat <<ROWS
| figure | result | what is known |
|---|---|---|
| images used | $(images_used sail) | |
| markers reconstructed | $(sample sail num_markers d) of $(sample sail num_layout_markers d) | |
| mean reprojection error | $(sample sail reprojection_error_px_mean 2) px | |
| RMS distance from the truth | $(sample sail distance_mm_rms 2) mm; expected $(sample sail distance_sigma_mm 2) mm | exact |
| the same after an alignment with scale | $(sample sail distance_after_scaling_mm_rms 2) mm; expected $(sample sail distance_after_scaling_sigma_mm 2) mm | exact |
| scale error | $(sample sail scale_error_percent +2) % | |
ROWS
}

block_cube() {
  cat <<ROWS
| figure | result | what is known |
|---|---|---|
| images used | $(images_used cube) | |
| markers reconstructed | $(sample cube num_markers d) of $(sample cube num_layout_markers d) | most of the missing ones are seen in one image only |
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

# The tables have one line per clip of accuracy.sh; the faces of the cube share a line.
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
  { clip = cell("clip"); sub(/_face[0-9]$/, "", clip); key = clip "," cell("way")
    known[key]
    for (name in column) if (name != "clip" && name != "way") note(key "," name, $column[name]) }
  function of(clip, way, name, format,    k) {
    if (!((clip "," way) in known) || (name != "ratio" && !(name in column))) exit 3
    k = clip "," way "," name
    return (k in least) ? span(least[k], most[k], format) : "-"
  }'

block_accuracy_summary() {
  cat <<ROWS
| data | velamap | the thesis's method |
|---|---|---|
| rendered 5 s clip of a 2.6 x 5.1 m sail, 1080p, action camera | $(sample sail distance_mm_rms 2) mm RMS, scale $(sample sail scale_error_percent +2) %, $(sample sail num_markers d) markers | |
| 24 photographs of a 40 mm cube, 2.4 mm markers | faces $(cube_pairs distances) mm apart (known: 40.0 to 40.3), at 90 ± $(cube_pairs off) degrees | |
ROWS
  table accuracy.csv "$accuracy_library"'
    function result(clip, way) {
      return of(clip, way, "distance_mm_rms", 2) " mm RMS, scale " of(clip, way, "scale_error_percent", "+2") \
        " %, " of(clip, way, "num_markers", "d") " markers"
    }
    END {
      title["aprilgrid"] = "10 photographs of an AprilGrid, 19 mm tags"
      title["board_video"] = "57 frames of a hand-held board, 40 mm markers"
      title["sail_4k"] = "rendered 4K clip of a 3 x 6 m sail, action camera"
      title["sail_1080p"] = "the same at 1080p"
      m = split("aprilgrid board_video sail_4k sail_1080p", shown, " ")
      for (i = 1; i <= m; i++)
        printf "| %s | %s | %s |\n", title[shown[i]], result(shown[i], "global_both"), result(shown[i], "thesis")
    }'
}

block_accuracy() {
  echo "| data | thesis | edge | global | both | to reach |"
  echo "|---|---|---|---|---|---|"
  table accuracy.csv "$accuracy_library"'
    function result(clip, way,    text) {
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
    cell("way") == "global_both" && cell("distance_after_scaling_sigma_mm") > 0 {
      note(key ",ratio", cell("distance_after_scaling_mm_rms") / cell("distance_after_scaling_sigma_mm")) }
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

block_blind_spot() {
  echo "| rendered data, SUBPIX corners | scale error | RMS with the scale fitted | mean area error | mean reprojection error |"
  echo "|---|---|---|---|---|"
  table accuracy.csv "$accuracy_library"'
    END {
      for (i = 1; i <= 4; i++) {
        clip = clips[i]; way = "thesis"
        printf "| %s | %s %% | %s mm | %s %% | %s px |\n", title[clip],
          of(clip, way, "scale_error_percent", "+2"), of(clip, way, "distance_after_scaling_mm_rms", 2),
          of(clip, way, "area_error_percent_mean", 2), of(clip, way, "reprojection_error_px_mean", 2)
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

block_found_cameras() {
  echo "| half of | focal length in the file | found in this half | reprojection error with the file's, with the other half's | error of the sides |"
  echo "|---|---|---|---|---|"
  table found_cameras.csv '
    { printf "| %s | %s px | %s ± %s px, %s | %s, %s px | %s, %s mm |\n", cell("object"),
        num(cell("file_focal_px"), "d"), num(cell("focal_px"), "d"), num(cell("focal_sigma_px"), 2),
        cell("model"),
        num(cell("error_file_px"), 2), num(cell("error_found_px"), 2),
        num(cell("side_error_file_mm"), 2), num(cell("side_error_found_mm"), 2) }'
  printf '\nFrom %s.\n' "$(made_by found_cameras.csv)"
}

block_unknown_cameras() {
  echo "| clip, lens | focal length, widths | camera found | its focal length | its error | shape without, with a calibration | ratio |"
  echo "|---|---|---|---|---|---|---|"
  table unknown_cameras.csv '
    { printf "| %s, %s | %s | %s | %s ± %s px | %s %% | %s, %s mm | %s |\n", cell("scene"), cell("lens"),
        num(cell("focal_widths"), 2), cell("model"), num(cell("focal_px"), "d"),
        num(cell("focal_sigma_px"), "as_is"), num(cell("focal_error_percent"), "+2"),
        num(cell("distance_after_scaling_mm"), 2),
        num(cell("distance_after_scaling_calibrated_mm"), 2), num(cell("ratio"), 3) }'
  printf '\nFrom %s.\n' "$(made_by unknown_cameras.csv)"
}

# --- the studies of thesis chapter 4 ---

# by PARAMETER COLUMN FORMAT: prints a column of parameters.csv for the rows that vary PARAMETER.
by() { value parameters.csv "$2" "$3" parameter="$1"; }

# under CONDITION COLUMN FORMAT: prints a value of conditions.csv. condition CONDITION and
# condition_truth CONDITION print the values that most rows show.
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
| reprojection error against the number of frames | rises slightly, max about 2 px | $(by n central_reprojection_error_px_mean 2) px on average | | \`parameters.sh\` |
| ratio against the number of frames | 56.9 % (11) to 40.1 % (101 frames) | $(by n reconstruction_ratio 3%) % | | \`parameters.sh\` |
| area error against s | poor for small s | $(by s area_error_mm2_mean 2) mm² for s $(by s value d) | RMS $(by s distance_mm_rms 2) mm | \`parameters.sh\` |
| ratio against s | falls | $(by s reconstruction_ratio 3%) % | | \`parameters.sh\` |
| area error against m | 5 chosen | $(by m area_error_mm2_mean 2) mm² for m $(by m value d), ratio $(by m reconstruction_ratio 3%) % | RMS $(by m distance_mm_rms 2) mm | \`parameters.sh\` |
| ratio against sigma of the mean | no influence | $(by sigma reconstruction_ratio 3%) % for sigma $(by sigma value as_is) m | | \`parameters.sh\` |
| area error against sigma | not disturbed from 0.6 m on | $(by sigma area_error_mm2_mean 2) mm² | RMS $(by sigma distance_mm_rms 2) mm | \`parameters.sh\` |
| ratio against beta | falls; 30 % chosen | $(by beta reconstruction_ratio 3%) % for beta $(by beta value as_is) | | \`parameters.sh\` |
| area error against beta | larger for small beta | $(by beta area_error_mm2_mean 2) mm² | RMS $(by beta distance_mm_rms 2) mm | \`parameters.sh\` |
| ratio against the threshold of RANSAC | fewer markers below 0.1 m | $(by ransac reconstruction_ratio 3%) % for $(by ransac value as_is) m | | \`parameters.sh\` |
| area error against the threshold of RANSAC | larger above 0.1 m | $(by ransac area_error_mm2_mean 2) mm² | RMS $(by ransac distance_mm_rms 2) mm | \`parameters.sh\` |
| areas of the markers | most near the printed one | $(table central_frames_histogram.csv 'cell("area_mm2") > 9900 && cell("area_mm2") < 10100 { sum += cell("share_of_all_percent") } END { printf "%s", num(sum, 2) }') % within 1 % of the printed area | | \`central_frames.sh\` |
| ratio by central frame | about 70 %, less when farther | $(table central_frames.csv '{ note("x", cell("reconstruction_ratio")) } END { printf "%s", span(least["x"], most["x"], "3%") }') % | | \`central_frames.sh\` |
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

# motion COLUMN: prints the motion of each line of markers. Lines without a marker are left out.
motion() {
  table conditions_motion_lines.csv '
    cell("line") != "hull" && cell("'"$1"'") != "" {
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

# --- shooting.sh ---

block_shooting_distance() {
  echo "| distance | side | markers found | error of a corner |"
  echo "|---|---|---|---|"
  table shooting.csv 'cell("series") == "distance" {
    printf "| %s m | %s px | %s %% | %s px |\n", cell("distance_m"), num(cell("side_px"), 3),
      num(cell("found_percent"), "d"), num(cell("corner_error_px"), 2) }'
}

block_shooting_motion() {
  echo "| side | path while the shutter is open | markers found | error of a corner |"
  echo "|---|---|---|---|"
  table shooting.csv '
    cell("series") == "motion" {
      if (cell("motion_px") == 0) side = cell("side_px")
      printf "| %s px | %s px, %s cells | %s %% | %s px |\n", num(side, 2), cell("motion_px"),
        num(6 * cell("motion_px") / side, 2), num(cell("found_percent"), "d"),
        num(cell("corner_error_px"), 2) }'
}

block_shooting_plan() {
  echo "| distance | side | sigma of a marker: planned, found | RMS to the truth: planned, found, true | after scaling: planned, found, true |"
  echo "|---|---|---|---|---|"
  table shooting.csv '
    cell("series") == "plan" {
      printf "| %s m | %s px | %s, %s mm | %s, %s, %s mm | %s, %s, %s mm |\n", cell("distance_m"),
        num(cell("side_px"), 2), num(cell("planned_marker_sigma_mm"), 2), num(cell("marker_sigma_mm"), 2),
        num(cell("planned_distance_sigma_mm"), 2), num(cell("distance_sigma_mm"), 2),
        num(cell("distance_mm"), 2), num(cell("planned_shape_sigma_mm"), 2),
        num(cell("shape_sigma_mm"), 2), num(cell("shape_mm"), 2) }'
}

# --- surface.sh ---

block_surface() {
  echo "| markers | error of a marker | error of the surface / of a marker: RMS, largest place | places up to 1.2 | error of the curvature: median, 95 %, largest | within 0.05 1/m |"
  echo "|---|---|---|---|---|---|"
  table surface.csv '
    {
      markers = cell("series") == "random" ? cell("num_draws") " random sails" : cell("series")
      printf "| %s | %s mm | %s, %s | %s %% | %s, %s, %s 1/m | %s %% |\n", markers,
        num(cell("marker_error_mm"), 2), num(cell("error_ratio_rms"), 2), num(cell("error_ratio_max"), 2),
        num(cell("places_below_1_2_percent"), 3), num(cell("curvature_error_median"), 2),
        num(cell("curvature_error_95_percent"), 2), num(cell("curvature_error_max"), 2),
        num(cell("curvature_within_0_05_percent"), 3) }'
}

# Shows a chord of the rendered sail along which an earlier surface, which bent at every marker, had
# an oscillating curvature.
block_surface_curvature() {
  table surface_curvature.csv '
    cell("height_m") == "3.935" {
      clip = cell("clip")
      if (!(clip in found)) names[++num_clips] = clip
      if (num_clips == 1) {
        places = places sprintf(" %d %% |", 100 * cell("along") + 0.5)
        rule = rule "---|"
        truth = truth " " num(cell("curvature"), 2) " |"
      }
      found[clip] = found[clip] " " num(cell("found_curvature"), 2) " |"
    }
    END {
      print "| along the chord |" places
      print "|---|" rule
      print "| truth, 1/m |" truth
      for (i = 1; i <= num_clips; i++) print "| " names[i] ", 1/m |" found[names[i]]
    }'
}

# --- freeform.sh ---

block_freeform() {
  echo "| body, noise | method | error: RMS, largest | error / sigma, RMS | no surface | CPU time |"
  echo "|---|---|---|---|---|---|"
  table freeform.csv '
    {
      sigmas = cell("error_in_sigmas") == "" ? "-" : num(cell("error_in_sigmas"), 2)
      printf "| %s, %s mm | %s | %s, %s mm | %s | %s %% | %s s |\n", cell("body"), num(cell("noise_mm"), 1),
        cell("method"), num(cell("rms_mm"), 2), num(cell("largest_mm"), 2), sigmas,
        num(cell("lacking_percent"), 2), num(cell("cpu_s"), 2) }'
}

# --- marker_design.sh ---

# Shows the statement of the thesis on each series (section 4.1) beside the shares at each distance.
block_marker_design() {
  table marker_design.csv '
    {
      design = cell("series") " " cell("value")
      if (!(design in found)) order[++num_designs] = design
      if (!(cell("distance_m") in seen)) { seen[cell("distance_m")]; distances[++num_distances] = cell("distance_m") }
      found[design] = found[design] sprintf(" %s %%, %s px |", num(cell("found_percent"), "d"), num(cell("side_px"), 2))
    }
    END {
      thesis["bits"] = "fewer bits are read from farther"
      thesis["border"] = "a border of one cell is best"
      thesis["length"] = "sides above 8 cm are read up to 7 m"
      unit["bits"] = "%s bits"; unit["border"] = "border of %s"; unit["length"] = "side of %s cm"
      head = "| marker | thesis |"; rule = "|---|---|"
      for (i = 1; i <= num_distances; i++) { head = head " " distances[i] " m |"; rule = rule "---|" }
      print head; print rule
      for (i = 1; i <= num_designs; i++) {
        split(order[i], word, " ")
        printf "| " unit[word[1]] " | %s |%s\n", word[2], thesis[word[1]], found[order[i]]
      }
    }'
}

# --- rolling_shutter.sh ---

block_rolling_shutter() {
  echo "| clip (5 s, 1080p) | shake | flapping | first to last row | found | RMS without | RMS with |"
  echo "|---|---|---|---|---|---|---|"
  table rolling_shutter.csv '
    {
      found = "none"
      if (cell("found_ms") != "") found = sprintf("%.2f ± %.2f ms", cell("found_ms"), cell("sigma_ms"))
      flapping = "-"
      if (cell("sail_motion_m") > 0) flapping = num(1000 * cell("sail_motion_m"), "d") " mm"
      printf "| %s | %s° | %s | %s ms | %s | %s mm | %s mm |\n", cell("scene"),
        num(cell("shake_deg"), 2), flapping, cell("shutter_ms"), found,
        num(cell("distance_without_mm"), 2), num(cell("distance_mm"), 2)
    }'
  printf '\nRMS distances from the truth after a similarity. From %s.\n' "$(made_by rolling_shutter.csv)"
}

# --- camera_draws.sh ---

block_camera_draws() {
  echo "| clips | draws | scale error: mean, RMS, largest | its stated sigma | error / sigma: RMS, within 2 | RMS | after scaling | bias of the sides: mean, RMS |"
  echo "|---|---|---|---|---|---|---|---|"
  table camera_draws_summary.csv '
    cell("class") == "all" || cell("curve") == "all" {
      group = cell("curve") != "all" ? "curve" : cell("class") != "all" ? "class" : "all"
      rows[group] = rows[group] sprintf("| %s | %d | %s, %s, %s %% | %s %% | %s, %.0f %% | %s mm | %s mm | %s, %s px |\n",
        group == "all" ? "all of them" : cell(group), cell("num_draws"),
        num(cell("scale_error_percent_mean"), "+2"), num(cell("scale_error_percent_rms"), 2),
        num(cell("scale_error_percent_max"), "+2"), num(cell("scale_sigma_percent_mean"), 2),
        num(cell("error_over_sigma_rms"), 2), cell("within_2_sigma_percent"),
        num(cell("distance_mm_rms"), 2), num(cell("distance_after_scaling_mm_rms"), 2),
        num(cell("side_bias_px_mean"), "+2"), num(cell("side_bias_px_rms"), 2))
    }
    END { printf "%s", rows["class"] rows["curve"] rows["all"] }'
  printf '\nFrom %s.\n' "$(made_by camera_draws_summary.csv)"
}

# --- board_motions.sh ---

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
