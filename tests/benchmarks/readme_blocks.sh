# shellcheck shell=bash
# The blocks of measured numbers that the benchmarks make, as those of workflows/studies/readme_blocks.sh.
# shellcheck disable=SC2016  # awk programs stand in single quotes

# What the awk programs below share: collect(row) takes the line into the row of the table that repeated
# runs have in common; order[1..num_rows] are the rows.
repeats_library='
  function collect(row,    name) {
    if (!(row in seen)) { seen[row]; order[++num_rows] = row }
    for (name in column) note(row SUBSEP name, $column[name])
  }
  function check(name) { if (!(name in column)) exit 3 }
  function seconds(row, name) { check(name); return span(least[row, name], most[row, name], 3) }
  function ratio(row, a, b, format) {
    check(a); check(b)
    return least[row, b] > 0 ? num(least[row, a] / least[row, b], format) : "-" }
  function clip_title() { return cell("kind") ", " cell("width_px") " px, " cell("num_frames") " frames" }'

block_import_speed() {
  table detection.csv "$repeats_library"'
    cell("kind") == "busy" && cell("width_px") == 3840 { collect(cell("num_frames")) }
    END {
      row = order[1]
      print "The import of " row " rendered frames in 4K takes " num(least[row, "velamap_cpu_s"], 3) \
        " CPU seconds on two cores. Decoding alone takes " num(least[row, "decoding_cpu_s"], 3) ","
      print "and a loop over OpenCV\047s VideoCapture and detectMarkers " \
        num(least[row, "opencv_cpu_s"], 3) " ([more](tests/benchmarks/README.md))."
    }'
}

block_detection() {
  echo "Made by $(made_by detection.csv); minimum to maximum over the runs, ratios of the minima:"
  echo
  echo "| clip | velamap, CPU s | markers | OpenCV's loop, CPU s | markers | decoding, CPU s | OpenCV / velamap | decoding / velamap |"
  echo "|---|---|---|---|---|---|---|---|"
  table detection.csv "$repeats_library"'
    { collect(clip_title()) }
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
  echo "Made by $(made_by adjustment.csv); minimum to maximum over the runs, ratios of the minima:"
  echo
  echo "| frames | markers | registration and adjustment, CPU s | COLMAP's adjustment, CPU s | velamap / COLMAP |"
  echo "|---|---|---|---|---|"
  table adjustment.csv "$repeats_library"'
    { collect(cell("num_frames") " | " cell("num_markers")) }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]
        printf "| %s | %s | %s | %s |\n", row, seconds(row, "velamap_cpu_s"), seconds(row, "colmap_cpu_s"),
          ratio(row, "velamap_cpu_s", "colmap_cpu_s", 2)
      }
    }'
}

block_main() {
  echo "Made by $(made_by main.csv); minimum to maximum over the runs, ratio of the minima:"
  echo
  echo "| clip | automatic_reconstructor, CPU s | decoding, CPU s | ratio | import | register | adjust | export | report |"
  echo "|---|---|---|---|---|---|---|---|---|"
  table main.csv "$repeats_library"'
    { collect(cell("width_px") " px, " cell("num_frames") " frames") }
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
  echo "Made by $(made_by growth.csv), which adds 1280 px;
minimum to maximum over the runs, ratio of the minima:"
  echo
  echo "| clip | import, CPU s | of twice the frames, CPU s | ratio |"
  echo "|---|---|---|---|"
  table growth.csv "$repeats_library"'
    { collect(cell("width_px") " px, " cell("num_frames") " frames") }
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
  echo "| markers | detection in one 4K frame, ms |"
  echo "|---|---|"
  table markers.csv '{ printf "| %s | %s |\n", cell("num_markers"), cell("detection_ms") }'
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
  echo "Made by $(made_by sweep.csv); minimum to maximum over the runs:"
  echo
  echo "| clip | central frames | single runs, CPU s | sweep with cold starts, CPU s | sweep, CPU s |"
  echo "|---|---|---|---|---|"
  table sweep.csv "$repeats_library"'
    { collect(cell("width_px") " px, " cell("num_frames") " frames | " cell("num_central_frames")) }
    END {
      for (i = 1; i <= num_rows; i++)
        printf "| %s | %s | %s | %s |\n", order[i], seconds(order[i], "single_runs_cpu_s"),
          seconds(order[i], "sweep_with_cold_starts_cpu_s"), seconds(order[i], "sweep_cpu_s")
    }'
}

# corner_table HEADING CONDITION EXPRESSION: the rows of corner_accuracy.csv for which the awk condition
# holds, with the awk expression in the second column.
corner_table() {
  echo "| side px | $1 | side bias px | std px | bound px | error / sigma | SUBPIX: side bias px | std px |"
  echo "|---|---|---|---|---|---|---|---|"
  table corner_accuracy.csv '
    function trial() {
      if (cell("noise") != 2) return "noise " cell("noise")
      if (cell("jpeg_quality") != "-") return "JPEG quality " cell("jpeg_quality")
      if (cell("bend_deg") != 0) return "bent by " cell("bend_deg") " degrees"
      if (cell("tilt_deg") != "0-50") return "tilt " cell("tilt_deg") " degrees"
      return ""
    }
    '"$2"' {
      printf "| %s | %s | %+.4f ± %.4f | %.4f | %.4f | %.2f | %+.3f | %.3f |\n", cell("side_px"), '"$3"',
        cell("side_bias_px"), cell("side_bias_sigma_px"), cell("std_px"), cell("bound_px"),
        cell("error_over_sigma"), cell("subpix_side_bias_px"), cell("subpix_std_px")
    }'
}

block_corner_accuracy() {
  corner_table "blur px" 'trial() == "" && cell("side_px") ~ /^(12|16|25|35|80|200)$/' 'sprintf("%.1f", cell("blur_px"))'
}

block_corner_trials() { corner_table "trial" 'trial() != ""' 'trial()'; }

block_own_solver() {
  echo "| main job | stage | own solver, CPU s | Ceres, CPU s | difference |"
  echo "|---|---|---|---|---|"
  table own_solver.csv '
    BEGIN {
      title["cube"] = "`sample_project/cube`, medians of 5 runs each"
      title["sail"] = "rendered sail, 4K, 400 frames at 60 Mbit/s, 2 runs each"
    }
    {
      row = cell("job") SUBSEP cell("stage")
      if (!(row in own)) order[++num_rows] = row
      own[row] += cell("own_solver_s"); ceres[row] += cell("ceres_s")
      note("own" row, cell("own_solver_s")); note("ceres" row, cell("ceres_s"))
    }
    END {
      for (i = 1; i <= num_rows; i++) {
        row = order[i]; split(row, name, SUBSEP)
        printf "| %s | %s | %s | %s | %s %% |\n", title[name[1]], name[2],
          span(least["own" row], most["own" row], 3), span(least["ceres" row], most["ceres" row], 3),
          num(100 * (ceres[row] / own[row] - 1), "+2")
      }
    }'
}

# Clips of a data set: what one takes, and what 10 to 100,000 of the last row's take. Over the network go
# the clip, and the workspace once in each direction.
block_dataset_scale() {
  echo "One clip, made by $(made_by dataset.csv):"
  echo
  echo "| clip | clip, MB | workspace, MB | import, CPU s | its memory, MB | reconstruction, CPU s | its memory, MB |"
  echo "|---|---|---|---|---|---|---|"
  table dataset.csv '
    {
      printf "| %s px, %s frames | %s | %s | %s | %s | %s | %s |\n", cell("width_px"), cell("num_frames"),
        num(cell("clip_mb"), 2), num(cell("workspace_mb"), 2), num(cell("import_cpu_s"), 2),
        cell("import_memory_mb"), num(cell("reconstruct_cpu_s"), 2), cell("reconstruct_memory_mb")
      seconds = cell("import_cpu_s") + cell("reconstruct_cpu_s")
      stored = cell("clip_mb") + cell("workspace_mb")
      moved = cell("clip_mb") + 2 * cell("workspace_mb")
    }
    END {
      print "\nMany of the last, where a core costs 0.05 EUR an hour:\n"
      print "| clips | CPU hours | clips and workspaces, GB | over the network, GB at most | EUR |"
      print "|---|---|---|---|---|"
      n = split("10 1000 100000", counts, " ")
      for (i = 1; i <= n; i++) {
        hours = counts[i] * seconds / 3600
        printf "| %d | %s | %s | %s | %s |\n", counts[i], num(hours, 2), num(counts[i] * stored / 1000, 2),
          num(counts[i] * moved / 1000, 2), num(0.05 * hours, 2)
      }
    }'
  echo
  echo "A sweep takes $(table sweep.csv '{ note("x", cell("sweep_cpu_s") / cell("num_central_frames")) }
    END { printf "%s", span(least["x"], most["x"], 2) }') CPU s for each central frame of the clip in 1080p."
}
