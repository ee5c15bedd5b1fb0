// Numbers as they are shown: five significant digits, as any program reads them.

export function formatNumber(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(digits - 1) : value.toPrecision(digits);
}

// The fewest digits that say the same to about 9 digits, for files.
export const writeNumber = (value) => (Number.isFinite(value) ? String(Number(value.toPrecision(9))) : "nan");
