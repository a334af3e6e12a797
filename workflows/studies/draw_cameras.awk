# Prints the conditions of random draws as CSV: draw, class, curve, then options of render_clip, empty
# where a draw does not set them.
# usage: awk -f random.awk -f draw_cameras.awk -v seed=1 -v num_draws=200 -v quick=0
# More draws leave the first ones as they are. Scenes and tone curves take turns, so that every class has
# as many draws; all else is random.

function log_between(low, high) { return low * exp(log(high / low) * uniform()) }
function set(name, format, value) { values[name] = sprintf(format, value) }

# Markers of 100 mm through the wide lens, whose focal length is 0.456 of the width.
function draw_sail(width, least_px, most_px,    distance, scale) {
  distance = 0.0456 * width / log_between(least_px, most_px)
  # The largest that the picture holds, of sizes on which stickers with all margins have room.
  scale = distance > 6 ? 1 : distance > 5.4 ? 0.9 : distance > 4.2 ? 0.7 : 0.5
  set("scene", "%s", "sail")
  set("width", "%d", quick ? 1280 : width)
  set("sail_scale", "%.2f", quick ? 0.5 : scale)
  set("distance", "%.2f", quick ? between(2.6, 3.2) : distance)
}
function draw_scene(class) {
  if (class == "sail_1080p") draw_sail(1920, 13, 26)
  if (class == "sail_4k") draw_sail(3840, 15, 42)
  if (class == "walls") {
    set("scene", "%s", "walls")
    set("width", "%d", 1920)
    set("distance", "%.2f", between(2.6, 4.5))
  }
  if (class == "board") {
    set("scene", "%s", "board")
    set("width", "%d", 1280)
    set("distance", "%.2f", log_between(0.45, 1.3))
    set("motion", "%s", substr("bcdfgh", 1 + int(6 * uniform()), 1))
  }
  set("margin_sides", "%.3f", log_between(0.05, class ~ /sail/ ? 0.15 : 0.3))
}
# A clip of about seven seconds in few frames.
function draw_clip(num_frames) {
  set("num_frames", "%d", num_frames)
  set("fps", "%.2f", num_frames / 6.7)
  set("seed", "%d", 1 + int(1e6 * uniform()))
}
function draw_print(    kind) {
  kind = uniform()
  set("ink_spread_mm", "%.3f", kind < 0.3 ? 0 : kind < 0.9 ? between(0, 0.1) : between(0.1, 0.3))
  set("ink_level", "%.3f", between(0.03, 0.1))
  set("paper_level", "%.2f", between(0.7, 0.9))
  set("background_level", "%.2f", between(0.1, 0.95))
}
function draw_camera(curve) {
  set("tone_curve", "%s", curve)
  if (curve == "gamma") set("gamma", "%.2f", between(1.8, 2.6))
  if (curve == "s_curve") set("s_curve", "%.3f", between(0.01, 0.07))
  if (uniform() < 0.6) {
    set("sharpening", "%.2f", between(0.1, 1.0))
    set("sharpening_radius_px", "%.2f", between(0.6, 1.8))
  }
  set("glare", "%.3f", between(0, 0.05))
  set("blur_px", "%.2f", between(0.4, 1.1))
  if (uniform() < 0.3) set("defocus_px", "%.2f", between(0.5, 1.5))
  if (uniform() < 0.3) {
    set("halo", "%.3f", between(0.02, 0.15))
    set("halo_px", "%.1f", between(1.5, 4))
  }
  set("motion_blur_px", "%.1f", uniform() < 0.5 ? 0 : between(0.5, 3))
  set("noise", "%.2f", between(0.2, 0.8))
  set("shot_noise", "%.1f", between(1, 5))
}
function draw_video() {
  set("codec", "%s", uniform() < 0.5 ? "h264" : "h265")
  set("range", "%s", uniform() < 0.7 ? "limited" : "full")
  set("crf", "%d", 14 + int(11 * uniform()))
}
BEGIN {
  num_classes = split("sail_1080p sail_4k walls board", classes, " ")
  num_curves = split("srgb s_curve gamma linear", curves, " ")
  split(quick ? "12 12 12 16" : "24 16 20 24", num_frames, " ")
  num_names = split("scene width sail_scale distance motion margin_sides num_frames fps seed " \
    "ink_spread_mm ink_level paper_level background_level tone_curve gamma s_curve sharpening " \
    "sharpening_radius_px glare blur_px defocus_px halo halo_px motion_blur_px noise shot_noise codec " \
    "range crf", names, " ")
  header = "draw,class,curve"
  for (i = 1; i <= num_names; i++) header = header "," names[i]
  print header
  begin_random(seed)
  for (draw = 0; draw < num_draws; draw++) {
    k = draw % num_classes + 1
    curve = curves[int(draw / num_classes) % num_curves + 1]
    split("", values)
    draw_scene(classes[k])
    draw_clip(num_frames[k])
    draw_print()
    draw_camera(curve)
    draw_video()
    line = draw "," classes[k] "," curve
    for (i = 1; i <= num_names; i++) line = line "," values[names[i]]
    print line
  }
}
