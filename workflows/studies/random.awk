# Random numbers for the studies that draw their clips. `state` is the seed, which is never zero.

# Park and Miller's minimal standard generator: the same numbers in every awk.
function uniform() {
  state = (16807 * state) % 2147483647
  return state / 2147483647
}
function between(low, high) { return low + (high - low) * uniform() }
