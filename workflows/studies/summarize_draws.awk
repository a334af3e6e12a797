# Prints a CSV of the draws of camera_draws.csv by class and tone curve: for each, for all curves of a
# class and for all draws, how far the scale is off and how well its stated sigmas predict this.
# usage: awk -f summarize_draws.awk camera_draws.csv
BEGIN { FS = OFS = "," }
NR == 1 {
  for (i = 1; i <= NF; i++) column[$i] = i
  print "class,curve,num_draws,num_results,scale_error_percent_mean,scale_error_percent_rms," \
    "scale_error_percent_max,scale_sigma_percent_mean,error_over_sigma_rms,within_2_sigma_percent," \
    "distance_mm_rms,distance_after_scaling_mm_rms,side_bias_px_mean,side_bias_px_rms"
  next
}
function value(name) { return $column[name] }
function add(group,    error) {
  if (!(group in num_draws)) groups[++num_groups] = group
  num_draws[group]++
  if (value("side_bias_px") != "") {
    num_biases[group]++
    biases[group] += value("side_bias_px")
    squared_biases[group] += value("side_bias_px") ^ 2
  }
  # A shape without a stated sigma counts as none.
  if (value("error_over_sigma") == "") return
  error = value("scale_error_percent")
  num_results[group]++
  sum[group] += error
  squares[group] += error ^ 2
  if (error ^ 2 > largest[group] ^ 2) largest[group] = error
  sigmas[group] += value("scale_sigma_percent")
  ratios[group] += value("error_over_sigma") ^ 2
  within[group] += value("error_over_sigma") ^ 2 <= 4
  distances[group] += value("distance_mm_rms") ^ 2
  shapes[group] += value("distance_after_scaling_mm_rms") ^ 2
}
{ add(value("class") "," value("curve")); add(value("class") ",all"); add("all," value("curve")); add("all,all") }
END {
  for (i = 1; i <= num_groups; i++) {
    group = groups[i]
    n = num_results[group]
    printf "%s,%d,%d", group, num_draws[group], n
    if (n == 0) printf ",,,,,,,,"
    else
      printf ",%.4f,%.4f,%.4f,%.4f,%.3f,%.1f,%.3f,%.3f", sum[group] / n, sqrt(squares[group] / n),
        largest[group], sigmas[group] / n, sqrt(ratios[group] / n), 100 * within[group] / n,
        sqrt(distances[group] / n), sqrt(shapes[group] / n)
    n = num_biases[group]
    if (n == 0) print ",,"
    else printf ",%.4f,%.4f\n", biases[group] / n, sqrt(squared_biases[group] / n)
  }
}
