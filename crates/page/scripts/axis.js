// Round values along an axis.

/** Returns round values from `low` to `high`, about as many as `count`. */
export function ticks(low, high, count) {
  const rough = (high - low) / count;
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((factor) => factor * power).find((size) => size >= rough * (1 - 1e-9)) ?? 10 * power;
  return ticksBy(step, low, high);
}

/** Returns the round angles [deg] from `low` to `high`, about as many as `count`. */
export function angleTicks(low, high, count) {
  const rough = (high - low) / count;
  const step = [1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360].find((size) => size >= rough);
  return step && rough > 0.5 ? ticksBy(step, low, high) : ticks(low, high, count);
}

function ticksBy(step, low, high) {
  const values = [];
  const last = Math.floor(high / step + 1e-9);
  for (let k = Math.ceil(low / step - 1e-9); k <= last; k += 1) {
    values.push(Number((k * step).toPrecision(12)) + 0);
  }
  return values;
}
