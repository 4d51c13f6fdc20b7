// Lengths and angles as they are typed.

export const DEGREE = Math.PI / 180;

/** Reads a length [m]: a number in the sheet's unit, or with a unit of its own. */
export function lengthOf(text, unit) {
  const match = text.trim().replace(",", ".").match(/^([-+]?[0-9.]+(?:e[-+]?\d+)?)\s*(mm|cm|m|in|inch)?$/i);
  const factors = { mm: 1e-3, cm: 1e-2, m: 1, in: 0.0254, inch: 0.0254 };
  return match ? Number(match[1]) * (match[2] ? factors[match[2].toLowerCase()] : unit.factor) : NaN;
}

/** Reads an angle in degrees. */
export function angleOf(text) {
  const match = text.trim().replace(",", ".").match(/^([-+]?[0-9.]+)\s*(°|deg)?$/i);
  return match ? Number(match[1]) * DEGREE : NaN;
}
