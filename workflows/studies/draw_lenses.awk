# Prints the conditions of random lenses as CSV: draw, lens (brown or fisheye), scene, width, focal length
# in widths, then fx, cx and cy (px, OpenCV's) and four distortion coefficients, then options of
# render_clip. Focal lengths are 0.5 to 1.6 widths, those of a fisheye to 0.8.
# usage: awk -f random.awk -f draw_lenses.awk -v seed=1 -v num_draws=24 -v quick=0

function normal() { return sqrt(-2 * log(uniform())) * cos(6.283185307 * uniform()) }

# Distortions by their effect at the corner of the picture, as a fraction of its distance from the axis.
function draw_brown(focal, width,    corner, at_corner, k2) {
  corner = 0.5737 / focal
  at_corner = focal < 0.8 ? between(-0.12, 0.05) : between(-0.08, 0.04)
  k2 = between(0, 0.3) * (at_corner < 0 ? -at_corner : at_corner) / corner ^ 4
  return sprintf("%.6f,%.6f,%.6f,%.6f", (at_corner - k2 * corner ^ 4) / corner ^ 2, k2, \
    3e-4 * normal(), 3e-4 * normal())
}
function draw_fisheye() { return sprintf("%.6f,%.6f,0,0", between(-0.03, 0.03), between(-0.01, 0.01)) }

# Distances that give the sizes of markers that a sailor's clip has.
function draw_scene(scene, focal, width,    distance, wide, scale) {
  if (scene == "sail") {
    distance = 0.1 * focal * width / between(15, 27)
    wide = 0.456 * distance / focal
    scale = wide > 6 ? 1 : wide > 5.4 ? 0.9 : wide > 4.2 ? 0.7 : 0.5
    return sprintf("--distance %.2f --sail_scale %.1f", distance, scale)
  }
  if (scene == "walls") return sprintf("--distance %.2f", between(2.6, 4.1) * focal / 0.456)
  return sprintf("--distance %.2f --motion %s", between(0.45, 0.95) * focal / 0.74, \
    substr("bcdfgh", 1 + int(6 * uniform()), 1))
}
BEGIN {
  split("sail walls board", scenes, " ")
  print "draw,lens,scene,width,focal_widths,focal_px,cx,cy,d1,d2,d3,d4,options"
  begin_random(seed)
  for (draw = 0; draw < num_draws; draw++) {
    scene = scenes[draw % 3 + 1]
    lens = draw % 4 == 3 ? "fisheye" : "brown"
    width = quick ? 1280 : scene == "board" ? 1280 : 1920
    focal = lens == "fisheye" ? between(0.5, 0.8) : between(0.5, 1.6)
    cx = width * (0.5 + 0.006 * normal())
    cy = width * (0.28125 + 0.006 * normal())
    distortion = lens == "fisheye" ? draw_fisheye() : draw_brown(focal, width)
    printf "%d,%s,%s,%d,%.4f,%.2f,%.2f,%.2f,%s,--seed %d %s\n", draw, lens, scene, width, focal, \
      focal * width, cx, cy, distortion, 1 + int(1e6 * uniform()), draw_scene(scene, focal, width)
  }
}
