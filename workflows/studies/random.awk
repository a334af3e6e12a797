# Random numbers for the studies that draw their clips. `state` is the seed, which is never zero.

# Park and Miller's minimal standard generator: the same numbers in every awk.
function uniform() {
  state = (16807 * state) % 2147483647
  return state / 2147483647
}
# Begins the numbers of a seed. The first ones of neighbouring seeds are alike, so they are left out.
function begin_random(seed,    i) {
  state = 1 + (48271 * seed) % 2147483645
  for (i = 0; i < 20; i++) uniform()
}
function between(low, high) { return low + (high - low) * uniform() }
