// A number as charts and sentences have it: so many significant digits.
export function digits(value, count = 3) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(count))) : "not known";
}
