# Moves shape B rigidly onto shape A by the markers of one part and prints, for every other marker
# that both have, where its centre is in A and how far it moved against that part (Figure 4.26).
# usage: awk -f align_part.awk -v part=hull A/shape.csv B/shape.csv
# Coordinates in m, moves in mm. Gauss-Newton on the rotation; the two cameras' frames are a few
# degrees apart, for which it converges in some steps.
BEGIN { FS = OFS = "," }
FNR == 1 { file++; next }
$2 == 0 && file == 1 { for (k = 0; k < 3; k++) a[$1, k] = $(3 + k) }
$2 == 0 && file == 2 { for (k = 0; k < 3; k++) b[$1, k] = $(3 + k); of_part[$1] = ($10 == part) }
function centre_on_part(points, middle,    id, k, n) {
  for (id in of_part)
    if (of_part[id] && (id, 0) in a) { n++; for (k = 0; k < 3; k++) middle[k] += points[id, k] }
  if (n < 3) { print "error: fewer than 3 common markers of part " part > "/dev/stderr"; exit 1 }
  for (k = 0; k < 3; k++) middle[k] /= n
  for (id in of_part) for (k = 0; k < 3; k++) points[id, k] -= middle[k]
}
# Rotates all of b about the axis w by its length.
function rotate_b(w,    angle, c, s, id, k, p, dot, x) {
  angle = sqrt(w[0] ^ 2 + w[1] ^ 2 + w[2] ^ 2)
  if (angle == 0) return
  c = cos(angle); s = sin(angle)
  for (id in of_part) {
    dot = 0
    for (k = 0; k < 3; k++) { p[k] = b[id, k]; dot += w[k] / angle * p[k] }
    for (k = 0; k < 3; k++) {
      x = (w[(k + 1) % 3] * p[(k + 2) % 3] - w[(k + 2) % 3] * p[(k + 1) % 3]) / angle
      b[id, k] = c * p[k] + s * x + (1 - c) * dot * w[k] / angle
    }
  }
}
function determinant(m, n, o) {
  return m[0] * (n[1] * o[2] - n[2] * o[1]) - m[1] * (n[0] * o[2] - n[2] * o[0]) \
    + m[2] * (n[0] * o[1] - n[1] * o[0])
}
END {
  for (id in of_part) if (!((id, 0) in a)) delete of_part[id]
  centre_on_part(a, middle_a)
  centre_on_part(b, middle_b)
  for (step = 0; step < 50; step++) {
    for (i = 0; i < 3; i++) { g[i] = 0; h0[i] = 0; h1[i] = 0; h2[i] = 0 }
    for (id in of_part) {
      if (!of_part[id]) continue
      x = b[id, 0]; y = b[id, 1]; z = b[id, 2]
      g[0] += y * a[id, 2] - z * a[id, 1]
      g[1] += z * a[id, 0] - x * a[id, 2]
      g[2] += x * a[id, 1] - y * a[id, 0]
      h0[0] += y * y + z * z; h1[1] += x * x + z * z; h2[2] += x * x + y * y
      h0[1] -= x * y; h0[2] -= x * z; h1[2] -= y * z
    }
    h1[0] = h0[1]; h2[0] = h0[2]; h2[1] = h1[2]
    d = determinant(h0, h1, h2)
    w[0] = determinant(g, h1, h2) / d
    w[1] = determinant(h0, g, h2) / d
    w[2] = determinant(h0, h1, g) / d
    rotate_b(w)
    if (w[0] ^ 2 + w[1] ^ 2 + w[2] ^ 2 < 1e-24) break
  }
  print "marker_id,of_part,x_m,y_m,z_m,dx_mm,dy_mm,dz_mm,move_mm"
  for (id in of_part) {
    sum = 0
    for (k = 0; k < 3; k++) { move[k] = 1000 * (b[id, k] - a[id, k]); sum += move[k] ^ 2 }
    print id, of_part[id], a[id, 0] + middle_a[0], a[id, 1] + middle_a[1], a[id, 2] + middle_a[2],
      move[0], move[1], move[2], sqrt(sum) | "sort -t, -n"
  }
}
