// @ts-check
// Lengths and angles as they are typed and shown.

/** Units of lengths [m]. */
export const LENGTHS = { mm: 1e-3, cm: 1e-2, m: 1, inch: 0.0254 };
/** Units of angles [rad]. */
export const ANGLES = { deg: Math.PI / 180, rad: 1 };

/** Reads a length [m]: a number in the sheet's unit, or with a unit of its own. */
export function lengthOf(text, unit) {
  return numberOf(text, unit, { ...LENGTHS, in: LENGTHS.inch });
}

/** Reads an angle [rad]: a number in the sheet's unit, or with a unit of its own. */
export function angleOf(text, unit) {
  return numberOf(text, unit, { ...ANGLES, "°": ANGLES.deg });
}

function numberOf(text, unit, factors) {
  const match = text.trim().replace(",", ".").match(/^([-+]?[0-9.]+(?:e[-+]?\d+)?)\s*([a-z°]*)$/i);
  return match ? Number(match[1]) * (match[2] ? (factors[match[2].toLowerCase()] ?? NaN) : unit.factor) : NaN;
}

/**
 * Writes a number of the file [SI] as it stands in place of a value there, which is TOML: in the unit of that.
 * An angle that was zero says nothing of its unit.
 */
export function inPlaceOf(value, number, unit) {
  const own = value.match(/\*\s*(\w+)"$/)?.[1] ?? (unit.name in ANGLES && !Number(value) ? unit.name : "");
  const factor = { ...LENGTHS, ...ANGLES }[own] ?? 1;
  const digits = String(Number((number / factor).toPrecision(15)));
  return own && digits !== "0" ? `"${digits}*${own}"` : digits;
}
